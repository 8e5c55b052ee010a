/// A frontier and the view proposed for it: the pairs that SEE chooses among.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include <Eigen/Core>

#include "geometry/place/pose.h"
#include "geometry/points/surface_frame.h"

namespace skycap::survey::see {

/// A frontier point, its surroundings when it became one, and where to look at it from.
struct Frontier {
  Eigen::Vector3d position;
  Eigen::Vector3d observed_from;   ///< the sensor's position when the point was measured
  Eigen::Vector3d observed_along;  ///< unit: the optical axis of that sensor
  geometry::SurfaceFrame frame;
  geometry::View view;
  double clear_offset = 0.0;                  ///< zeta; see OcclusionTest
  std::optional<std::size_t> offset_of_scan;  ///< the number of scans when it was computed
  bool was_put_off = false;                   ///< its view is from where it was seen
};

/// By index of the point, so that every loop over them has the same order.
using FrontierMap = std::map<std::uint32_t, Frontier>;

/// Where views may be.
struct ViewPlacement {
  double distance = 2.0;               ///< d, from the frontier
  std::optional<double> least_height;  ///< z of the sensor
};

/// The view of `frontier` from `placement.distance` away along the unit vector `direction`. If that
/// is too low, the view slides up on the sphere around the frontier, keeping its azimuth; if no
/// place on the sphere is high enough, it is the highest one.
geometry::View place_view(const Eigen::Vector3d& frontier, const Eigen::Vector3d& direction,
                          const ViewPlacement& placement);

/// The view of `frontier` along the line on which it was seen, which was free then: from
/// `placement.distance` away, or as much farther as it takes to be high enough, but no farther than
/// it was seen from.
geometry::View look_again(const Frontier& frontier, const ViewPlacement& placement);

}  // namespace skycap::survey::see
