/// In which order an autopilot comes to the items of a mission.
#pragma once

#include <cstddef>
#include <vector>

#include "flight/export/mission_items.h"
#include "flight/export/text.h"

namespace skycap::flight {

struct ItemOrder {
  std::vector<std::size_t> indices;  ///< of items, jumps unrolled and left out
  Problems problems;                 ///< jumps that cannot be followed, by item
};

/// Follows every DO_JUMP (177): to the item of that number, as often as it says, then on.
ItemOrder order_of(const std::vector<MissionItem>& items);

}  // namespace skycap::flight
