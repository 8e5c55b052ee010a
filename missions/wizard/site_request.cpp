#include "missions/wizard/site_request.h"

#include <array>
#include <charconv>
#include <cmath>

namespace skycap::missions::wizard {

std::optional<Click> click_in(const std::string& text) {
  std::array<double, 2> numbers{};
  const char* cursor = text.data();
  const char* const end = text.data() + text.size();
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    while (cursor != end && (*cursor == ' ' || (i == 1 && *cursor == ','))) ++cursor;
    const auto [next, error] = std::from_chars(cursor, end, numbers[i]);
    if (error != std::errc()) break;
    cursor = next;
    if (i == 1 && next == end && std::abs(numbers[0]) <= 90.0 && std::abs(numbers[1]) <= 180.0) {
      return Click{numbers[0], numbers[1]};
    }
  }
  return std::nullopt;
}

}  // namespace skycap::missions::wizard
