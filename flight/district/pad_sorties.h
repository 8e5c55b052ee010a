/// The stations of a district in one order across its targets, and the pad that each is flown from,
/// before any leg is proven.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/motion.h"
#include "flight/route/route.h"

namespace skycap::flight {

struct PadSorties {
  std::vector<std::uint32_t> order;         ///< of the stations; those out of reach are not in it
  std::vector<std::uint32_t> pads;          ///< of each of `order`
  std::vector<std::uint32_t> out_of_reach;  ///< for a full battery, there and back from any pad
  double length = 0.0;                      ///< of the order, in straight lines [m]
};

/// As if every leg were straight: a short tour of all stations (plan_tour()), cut into the sorties
/// that take the least time, each from the best of several pads (split_into_sorties()). Of more
/// than a thousand stations those of neighbouring `targets`, one number a station and ascending,
/// are ordered together. `pads` are where vehicles stand, and `climb` is how far straight up they
/// begin.
PadSorties sorties_from_pads(std::span<const Station> stations,
                             std::span<const std::uint32_t> targets,
                             std::span<const Eigen::Vector3d> pads, double climb,
                             const Motion& motion);

}  // namespace skycap::flight
