#include "missions/support/number_text.h"

#include <array>
#include <charconv>

#include <fmt/format.h>

namespace skycap::missions::support {

std::string exact_text(double number) {
  std::array<char, 32> text{};
  const auto result = std::to_chars(text.data(), text.data() + text.size(), number);
  return {text.data(), result.ptr};
}

std::string short_text(double number) { return fmt::format("{:.4g}", number); }

std::string counted(std::size_t count, std::string_view word) {
  return fmt::format("{} {}{}", count, word, count == 1 ? "" : "s");
}

}  // namespace skycap::missions::support
