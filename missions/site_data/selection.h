/// What of a file is meant: which objects, at which level of detail.
#pragma once

#include <cstddef>
#include <vector>

#include "missions/site_data/formats/file_contents.h"
#include "missions/site_data/prior.h"

namespace skycap::missions::site_data {

/// One thing of a Prior and the objects of the file that it is made of: a building with its parts.
struct SelectedObject {
  std::size_t object = 0;            ///< that gives name, kind and attributes
  std::vector<std::size_t> members;  ///< itself and what is part of it; only those with surfaces
};

/// In the order of the file. Without ids and attributes, each object that is part of no other is
/// one; with them, the outermost ones that match. Throws Error{bad_config} if an id or the
/// attributes match nothing: the message names some that are there.
std::vector<SelectedObject> select_objects(const Source& source, const FileContents& contents);

/// The polygons of an object at the level that is asked for; else its highest. Polygons of no level
/// are always among them.
std::vector<FilePolygon> select_polygons(const FileObject& object, std::optional<double> lod);

/// Throws Error{bad_config} naming the first key of the source that the file has no use for, and
/// what it is for: whoever gave it meant something by it.
void refuse_unused(const Source& source, const FileContents& contents);

}  // namespace skycap::missions::site_data
