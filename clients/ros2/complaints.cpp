#include "clients/ros2/complaints.h"

#include <string_view>

namespace skycap::ros2 {

std::string text_of(const char* text) {
  constexpr std::size_t longest = 200;
  std::string printable(std::string_view(text == nullptr ? "" : text).substr(0, longest));
  for (char& letter : printable) {
    if (letter < ' ' || letter > '~') letter = '?';
  }
  return printable;
}

bool Complaints::add(const std::string& kind, const std::string& line, double now) {
  constexpr double interval = 5.0;
  ++count_;
  last_ = line;
  const auto [place, is_first] = kinds_.try_emplace(kind);
  Kind& state = place->second;
  if (!is_first && now - state.said_at < interval) {
    ++state.unsaid;
    return false;
  }
  say_(state.unsaid == 0 ? line : line + " (and " + std::to_string(state.unsaid) + " more)");
  state = {.said_at = now};
  return true;
}

}  // namespace skycap::ros2
