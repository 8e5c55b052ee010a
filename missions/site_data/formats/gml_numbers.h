/// Coordinates as text in GML.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::missions::site_data {

/// What an element `coordinates` says of its text; empty: as by default, a point, a comma and a
/// blank.
struct GmlSeparators {
  std::string decimal, of_coordinates, of_places;  ///< attributes decimal, cs, ts
};

/// Appends the numbers of a text, apart by white space, commas or other separators. Throws
/// Error{bad_file} for what is no finite number.
void append_gml_numbers(const std::filesystem::path& file, std::string_view text,
                        const GmlSeparators& separators, std::vector<double>& numbers);

}  // namespace skycap::missions::site_data
