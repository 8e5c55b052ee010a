#include "missions/support/similar_name.h"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace skycap::missions::support {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Rows for the first i - 1, i and i + 1 characters of `a`.
  std::vector<std::size_t> previous(b.size() + 1), row(b.size() + 1), next(b.size() + 1);
  std::iota(row.begin(), row.end(), 0U);
  for (std::size_t i = 0; i < a.size(); ++i) {
    next[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      next[j + 1] = std::min({row[j] + (a[i] == b[j] ? 0U : 1U), row[j + 1] + 1, next[j] + 1});
      if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j]) {
        next[j + 1] = std::min(next[j + 1], previous[j - 1] + 1);
      }
    }
    std::swap(previous, row);
    std::swap(row, next);
  }
  return row.back();
}

std::string find_similar(std::string_view word, std::span<const std::string> names) {
  constexpr std::size_t longest = 100;  // longer words are not misspellings
  if (word.size() > longest) return "";
  std::string nearest;
  std::size_t limit = std::max<std::size_t>(1, word.size() / 4) + 1;
  for (const std::string& name : names) {
    const std::size_t distance = edit_distance(word, name);
    if (distance < limit) nearest = name, limit = distance;
  }
  return nearest;
}

}  // namespace skycap::missions::support
