/// Parser of coordinate text in GML.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::missions::site_data {

/// Separators from the attributes of a `coordinates` element. Empty members have the defaults
/// point, comma and space.
struct GmlSeparators {
  std::string decimal, coordinate_separator, of_tuples;  ///< Attributes decimal, cs and ts.
};

/// Appends the numbers in `text`, separated by white space, commas or the given separators. Throws
/// Error{bad_file} for text that is not a finite number.
void append_gml_numbers(const std::filesystem::path& file, std::string_view text,
                        const GmlSeparators& separators, std::vector<double>& numbers);

}  // namespace skycap::missions::site_data
