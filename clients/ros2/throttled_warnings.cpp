#include "clients/ros2/throttled_warnings.h"

#include <string_view>

namespace skycap::ros2 {

std::string printable_text(const char* text) {
  constexpr std::size_t longest = 200;
  std::string printable(std::string_view(text == nullptr ? "" : text).substr(0, longest));
  for (char& letter : printable) {
    if (letter < ' ' || letter > '~') letter = '?';
  }
  return printable;
}

bool ThrottledWarnings::add(const std::string& kind, const std::string& line, double now) {
  constexpr double interval = 5.0;
  ++count_;
  last_ = line;
  const auto [entry, is_first] = kinds_.try_emplace(kind);
  Kind& state = entry->second;
  if (!is_first && now - state.reported_at < interval) {
    ++state.suppressed;
    return false;
  }
  report_(state.suppressed == 0 ? line
                                : line + " (and " + std::to_string(state.suppressed) + " more)");
  state = {.reported_at = now};
  return true;
}

}  // namespace skycap::ros2
