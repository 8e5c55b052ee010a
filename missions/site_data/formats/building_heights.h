/// Building heights from map attributes. Supported names are OpenStreetMap's tags
/// (wiki.openstreetmap.org/wiki/Simple_3D_Buildings), those of Overture and Microsoft, and their
/// abbreviations in Shapefiles.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "missions/site_data/formats/file_contents.h"

namespace skycap::missions::site_data {

/// Parses a length in metres: "12.5", "12,5 m", "40 ft", "7'4\"". Lists and ranges ("12;13",
/// "10-12") give their maximum. Other text gives an empty value.
std::optional<double> parse_metres(std::string_view text);

/// Parses a number of storeys: "4", "2;5" (maximum), "3+1" (sum).
std::optional<double> parse_storeys(std::string_view text);

/// Sets height and min_height of each outline from its attributes unless the file's reader has set
/// them. `height_attribute` is the name of the height attribute; empty selects the known names.
/// Unreadable heights are stored in FileObject::height_problem. Adds notes with the numbers of
/// read, estimated and missing heights.
void read_building_heights(FileContents& contents, const std::string& height_attribute);

/// Returns the names of an object's attributes for messages: "name, levels, ...", or "none".
std::string attribute_names(const FileObject& object);

}  // namespace skycap::missions::site_data
