/// Point-based occlusion test of SEE++ (§III-A): tests whether measured points block the line of
/// sight between a frontier and a view.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/points/point_grid.h"
#include "survey/see/method_variants.h"

namespace skycap::survey::see {

struct OcclusionConfig {
  double radius = 0.017;         ///< r: radius of the marched ball and step size [m]
  double search_distance = 1.0;  ///< psi: length of the march [m]
  MarchEnd end = MarchEnd::search_distance;
};

/// Marches a ball along lines of sight through the measured points. Cheap to construct. The grid
/// must outlive the test, and its cells must not be smaller than the radius.
class OcclusionTest {
 public:
  OcclusionTest(const geometry::PointGrid& grid, const OcclusionConfig& config)
      : grid_(grid), config_(config) {}

  /// Returns zeta: the first multiple of the step at which the ball from `frontier` along the unit
  /// vector `direction` contains no point. Returns min(psi, limit) if no ball is clear up to that
  /// distance.
  double clear_offset(const Eigen::Vector3d& frontier, const Eigen::Vector3d& direction,
                      double limit) const;

  /// Returns whether any ball contains a point. The march starts at the distance `offset` (zeta)
  /// from `frontier` and leads towards `sensor`.
  bool is_occluded(const Eigen::Vector3d& frontier, double offset,
                   const Eigen::Vector3d& sensor) const;

 private:
  const geometry::PointGrid& grid_;
  OcclusionConfig config_;
};

/// Returns the unit vectors from `from` to all points within `radius` of `position`, except for
/// points at `from`.
std::vector<Eigen::Vector3d> directions_to_near(const geometry::PointGrid& points,
                                                const Eigen::Vector3f& position, double radius,
                                                const Eigen::Vector3d& from);

}  // namespace skycap::survey::see
