/// Formats numbers.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace skycap::missions::support {

/// Returns the shortest decimal string that is parsed as the same number.
std::string exact_text(double number);

/// Returns a number with four significant digits, for messages.
std::string short_text(double number);

/// Returns a count with its noun: "1 point", "2 points".
std::string counted(std::size_t count, std::string_view word);

}  // namespace skycap::missions::support
