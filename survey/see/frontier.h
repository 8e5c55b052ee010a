/// Frontiers and their proposed views, from which SEE selects the next view.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include <Eigen/Core>

#include "geometry/points/surface_frame.h"
#include "geometry/pose/pose.h"

namespace skycap::survey::see {

/// Frontier point with its local geometry and its proposed view.
struct Frontier {
  Eigen::Vector3d position;
  Eigen::Vector3d observed_from;   ///< sensor position when the point was measured
  Eigen::Vector3d observed_along;  ///< unit vector: optical axis of that sensor
  geometry::SurfaceFrame frame;
  geometry::View view;
  double clear_offset = 0.0;  ///< zeta: start of the occlusion test; see OcclusionTest [m]
  std::optional<std::size_t>
      offset_scan_count;  ///< number of scans when `clear_offset` was computed
  bool was_deferred =
      false;  ///< deferred before; the view is on the line from which the point was measured
};

/// Frontiers by point index. The order is deterministic for all loops.
using FrontierMap = std::map<std::uint32_t, Frontier>;

/// Constraints on view positions.
struct ViewPlacement {
  double distance = 2.0;             ///< d: distance from the frontier [m]
  std::optional<double> min_height;  ///< minimum z of the sensor [m]
};

/// Returns the view of `frontier` from the distance `placement.distance` in the direction of the
/// unit vector `direction`. A view below the minimum height is moved up on the sphere around the
/// frontier, with constant azimuth. If the whole sphere is too low, its highest point is used.
geometry::View place_view(const Eigen::Vector3d& frontier, const Eigen::Vector3d& direction,
                          const ViewPlacement& placement);

/// Returns the view of `frontier` on the line from which it was measured, which was free at that
/// time. The distance is `placement.distance`, increased as needed for the minimum height. It never
/// exceeds the distance of the measurement.
geometry::View reobserve_view(const Frontier& frontier, const ViewPlacement& placement);

}  // namespace skycap::survey::see
