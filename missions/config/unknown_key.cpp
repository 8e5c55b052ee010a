#include "missions/config/unknown_key.h"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

#include "missions/support/similar_name.h"

namespace skycap::missions::config {
namespace {

std::string_view last_part(std::string_view path) { return path.substr(path.rfind('.') + 1); }

}  // namespace

std::string unknown_key_message(const std::string& path, std::span<const Key> keys) {
  const Key* nearest = nullptr;
  std::size_t nearest_distance = 0;
  // Longer keys are not misspellings, and their distances are slow to compute.
  constexpr std::size_t longest = 100;
  for (const Key& key : keys) {
    if (path.size() > longest) break;
    // A key may be misspelt, or be in the wrong section with at most a slight misspelling.
    const std::size_t slip = support::edit_distance(last_part(path), last_part(key.path));
    std::size_t distance = support::edit_distance(path, key.path);
    if (4 * slip <= last_part(path).size()) distance = std::min(distance, slip + 1);
    if (!nearest || distance < nearest_distance) nearest = &key, nearest_distance = distance;
  }
  if (nearest && nearest_distance <= std::max<std::size_t>(2, path.size() / 4)) {
    return "is unknown; did you mean " + nearest->path + "?";
  }
  const std::string section = path.substr(0, path.rfind('.') + 1);
  std::vector<std::string> children;
  for (const Key& key : keys) {
    if (!key.path.starts_with(section)) continue;
    std::string child = key.path.substr(0, key.path.find('.', section.size()));
    if (std::ranges::find(children, child) == children.end()) children.push_back(std::move(child));
  }
  std::string known;
  for (const std::string& child : children) known += (known.empty() ? "" : ", ") + child;
  return "is unknown; expected one of: " + known;
}

}  // namespace skycap::missions::config
