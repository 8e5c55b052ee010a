#include "flight/interpreter/item_order.h"

#include <algorithm>
#include <cmath>

namespace skycap::flight {
namespace {

constexpr double max_repeats = 20.0;    // Higher values are assumed to be mistakes.
constexpr std::size_t max_growth = 10;  // Maximum growth of a mission by its jumps.

/// Returns the target index of a jump, or the size of `items` without a target.
std::size_t find_jump_target(const MissionItem& jump, const std::vector<MissionItem>& items) {
  const auto target = std::ranges::find_if(items, [&](const MissionItem& item) {
    return static_cast<double>(item.number) == jump.params[0];
  });
  return static_cast<std::size_t>(target - items.begin());
}

std::string what_is_wrong(const MissionItem& jump, const std::vector<MissionItem>& items) {
  const double repeats = jump.params[1];
  if (find_jump_target(jump, items) == items.size()) return "jumps to an item that does not exist";
  if (!(repeats >= 0.0 && repeats <= max_repeats) || repeats != std::floor(repeats)) {
    return "jumps " + fixed(repeats, 1) + " times; the count must be an integer from 0 to 20";
  }
  return "";
}

}  // namespace

ItemOrder compute_order(const std::vector<MissionItem>& items) {
  ItemOrder order;
  std::vector<double> jumped(items.size(), 0.0);
  for (std::size_t i = 0; i < items.size();) {
    const MissionItem& item = items[i];
    if (item.command != command::jump) {
      order.indices.push_back(i++);
      continue;
    }
    if (const std::string what = what_is_wrong(item, items); !what.empty()) {
      order.problems.push_back(item_label(item) + " " + what);
      return order;
    }
    if (order.indices.size() > max_growth * items.size()) {
      order.problems.push_back(item_label(item) + " makes the mission more than ten times as long");
      return order;
    }
    i = jumped[i]++ < item.params[1] ? find_jump_target(item, items) : i + 1;
  }
  return order;
}

}  // namespace skycap::flight
