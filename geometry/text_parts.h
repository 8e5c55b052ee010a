/// Splitting and trimming of text from external sources.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace skycap::geometry {

/// Returns the text without a leading UTF-8 byte-order mark.
std::string_view without_mark(std::string_view text);

/// Returns the text without leading and trailing spaces, tabs and line ends.
std::string_view trimmed(std::string_view text);

/// Splits the text at sequences of spaces, tabs and line ends.
std::vector<std::string> split_words(std::string_view text);

/// Returns at most 40 bytes of the text for messages, with control characters as spaces.
std::string excerpt(std::string_view text);

}  // namespace skycap::geometry
