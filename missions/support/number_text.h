/// Numbers as text.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace skycap::missions::support {

/// The shortest decimal text that reads back as the same number.
std::string exact_text(double number);

/// Four significant digits, for people.
std::string short_text(double number);

/// "1 point", "2 points".
std::string counted(std::size_t count, std::string_view word);

}  // namespace skycap::missions::support
