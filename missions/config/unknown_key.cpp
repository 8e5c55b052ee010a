#include "missions/config/unknown_key.h"

#include <algorithm>
#include <numeric>
#include <string_view>
#include <utility>
#include <vector>

namespace skycap::missions::config {
namespace {

/// Returns the Levenshtein distance: the number of characters to insert, delete or replace.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0U);
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

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
    const std::size_t slip = edit_distance(last_part(path), last_part(key.path));
    std::size_t distance = edit_distance(path, key.path);
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
