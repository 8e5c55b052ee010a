/// Parts of texts that other programs wrote: without blanks and marks that carry no meaning.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace skycap::geometry {

/// The text without the UTF-8 byte-order mark at its beginning, if it has one.
std::string_view without_mark(std::string_view text);

/// The text without blanks, tabs and line ends at its beginning and end.
std::string_view trimmed(std::string_view text);

/// The parts between blanks, tabs and line ends, of which there may be several in a row.
std::vector<std::string> words_of(std::string_view text);

}  // namespace skycap::geometry
