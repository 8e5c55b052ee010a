/// Selection of objects and levels of detail of a file.
#pragma once

#include <cstddef>
#include <vector>

#include "missions/site_data/formats/file_contents.h"
#include "missions/site_data/prior.h"

namespace skycap::missions::site_data {

/// Object of a Prior and the file objects that it consists of, such as a building with its parts.
struct SelectedObject {
  std::size_t object = 0;            ///< Object that defines name, kind and attributes.
  std::vector<std::size_t> members;  ///< The object and its parts, limited to those with surfaces.
};

/// Returns the selected objects in file order. Without ids and attributes, these are all objects
/// without a parent; otherwise the outermost matching objects. Throws Error{bad_config} with
/// examples of existing values if an id or the attributes match no object.
std::vector<SelectedObject> select_objects(const Source& source, const FileContents& contents);

/// Returns the polygons of an object at the requested level of detail, by default at its highest.
/// Polygons without a level are always included.
std::vector<FilePolygon> select_polygons(const FileObject& object, std::optional<double> lod);

/// Throws Error{bad_config} naming the first key of the source that does not apply to the file, and
/// the purpose of the key.
void reject_unused(const Source& source, const FileContents& contents);

}  // namespace skycap::missions::site_data
