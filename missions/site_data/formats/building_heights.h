/// Heights of buildings from the attributes of maps: OpenStreetMap's tags, which others use, too
/// (wiki.openstreetmap.org/wiki/Simple_3D_Buildings), Overture's and Microsoft's names, and what
/// Shapefiles make of them.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {

/// A length in metres from text as mappers write it: "12.5", "12,5 m", "40 ft", "7'4\"", and of
/// lists and ranges ("12;13", "10-12") the greatest. Nothing if it is none of these.
std::optional<double> metres_of(std::string_view text);

/// A number of storeys: "4", "2;5" (the greatest), "3+1" (the sum).
std::optional<double> storeys_of(std::string_view text);

/// Sets height and min_height of each outline from its attributes, where the file's reader has not.
/// `height_attribute` names the one that is the height; empty: those that are known. A height that
/// is there but cannot be understood goes to FileObject::height_problem. Adds notes on what was
/// counted, guessed or left out.
void read_building_heights(FileContents& contents, const std::string& height_attribute);

/// Names of an object's attributes, for a message: "name, levels, ..."; "none" if it has none.
std::string attribute_names(const FileObject& object);

}  // namespace skycap::missions::site_data
