/// Suggestions for misspelt names of keys, commands and options.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace skycap::missions::support {

/// Returns the number of characters to insert, delete, replace or swap with their neighbour
/// (optimal string alignment distance).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// Returns the name that is most similar to `word`. It may differ in one character, or in a quarter
/// of the characters of `word`. Returns an empty string if no name is that similar.
std::string find_similar(std::string_view word, std::span<const std::string> names);

}  // namespace skycap::missions::support
