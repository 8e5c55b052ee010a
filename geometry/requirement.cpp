#include "geometry/requirement.h"

#include <array>
#include <charconv>

#include "geometry/error.h"

namespace skycap {

void require(bool holds, const std::string& field, double value, const std::string& rule) {
  if (holds) return;
  std::array<char, 32> text{};
  std::to_chars(text.begin(), text.end() - 1, value, std::chars_format::general, 6);
  throw Error(ErrorKind::bad_config, field + " is " + text.data() + "; it must be " + rule);
}

}  // namespace skycap
