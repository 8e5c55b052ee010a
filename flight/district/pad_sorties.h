/// Order of a district's waypoints across its targets, with a pad for each, before any leg is
/// verified.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/motion.h"
#include "flight/route/route.h"

namespace skycap::flight {

struct PadSorties {
  std::vector<std::uint32_t> order;  ///< Indices of the reachable waypoints in flight order.
  std::vector<std::uint32_t> pads;   ///< Pad of each entry of `order`.
  /// Waypoints beyond the range of a full battery from every pad.
  std::vector<std::uint32_t> unreachable;
  double length = 0.0;  ///< Length of the straight lines in this order [m].
};

/// Computes order and pads under the assumption of straight legs. A short tour of all waypoints
/// (plan_tour()) is split into the fastest sorties, each from its best pad (split_into_sorties()).
/// Above 1000 waypoints, the order is computed separately for groups of neighbouring targets.
///
/// `targets` has one ascending number per waypoint. `pads` are ground positions, and `climb` is the
/// vertical climb above them before the first leg [m].
PadSorties sorties_from_pads(std::span<const CapturePoint> capture_points,
                             std::span<const std::uint32_t> targets,
                             std::span<const Eigen::Vector3d> pads, double climb,
                             const Motion& motion);

}  // namespace skycap::flight
