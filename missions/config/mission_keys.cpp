#include "missions/config/mission_keys.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include "missions/config/key_sections.h"

namespace skycap::missions::config {

std::span<const Key> mission_keys() {
  static const std::vector<Key> keys = [] {
    std::vector<Key> all;
    for (const KeySection& section : key_sections) {
      std::ranges::move(section.keys(), std::back_inserter(all));
    }
    return all;
  }();
  return keys;
}

const Key* find_key(std::string_view path) {
  const auto keys = mission_keys();
  const auto key = std::ranges::find(keys, path, &Key::path);
  return key == keys.end() ? nullptr : &*key;
}

}  // namespace skycap::missions::config
