#pragma once

#include <charconv>
#include <cstdio>
#include <string>

namespace skycap::missions::file {

/// The shortest decimal text that reads back as the same number.
inline std::string exact_text(double number) {
  char text[32];
  const auto result = std::to_chars(text, text + sizeof text, number);
  return {text, result.ptr};
}

/// Four significant digits, for people.
inline std::string short_text(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", number);
  return text;
}

}  // namespace skycap::missions::file
