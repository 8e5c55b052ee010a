/// Order in which an autopilot executes mission items.
#pragma once

#include <cstddef>
#include <vector>

#include "flight/export/mission_items.h"
#include "flight/export/text.h"

namespace skycap::flight {

struct ItemOrder {
  std::vector<std::size_t> indices;  ///< Item indices, with jumps unrolled and omitted.
  Problems problems;                 ///< Jumps that cannot be executed, per item.
};

/// Executes every DO_JUMP (177) to its target item as often as specified, then continues.
ItemOrder compute_order(const std::vector<MissionItem>& items);

}  // namespace skycap::flight
