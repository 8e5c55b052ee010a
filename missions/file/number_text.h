/// Numbers as text.
#pragma once

#include <string>

namespace skycap::missions::file {

/// The shortest decimal text that reads back as the same number.
std::string exact_text(double number);

/// Four significant digits, for people.
std::string short_text(double number);

}  // namespace skycap::missions::file
