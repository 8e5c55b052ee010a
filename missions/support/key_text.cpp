#include "missions/support/key_text.h"

#include <algorithm>
#include <array>

namespace skycap::missions::support {
namespace {

constexpr std::array<std::string_view, 10> verbs{"is",        "has",      "must",   "requires",
                                                 "conflicts", "contains", "cannot", "applies",
                                                 "follows",   "leaves"};

}  // namespace

std::string about_key(std::string_view key, std::string_view what) {
  const bool has_verb = std::ranges::find(verbs, what.substr(0, what.find(' '))) != verbs.end();
  return std::string(key) + (has_verb ? " " : ": ") + std::string(what);
}

}  // namespace skycap::missions::support
