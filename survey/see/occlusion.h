/// Whether measured points stand between a frontier and a view: the point-based occlusion test of
/// SEE++ (§III-A).
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/points/point_grid.h"
#include "survey/see/readings.h"

namespace skycap::survey::see {

struct OcclusionConfig {
  double radius = 0.017;         ///< of the ball that is marched, and its step; r
  double search_distance = 1.0;  ///< psi
  MarchEnd end = MarchEnd::search_distance;
};

/// A ball marched along sight lines through the measured points. Cheap to construct; the grid must
/// outlive it and have cells no smaller than the ball's radius.
class OcclusionTest {
 public:
  OcclusionTest(const geometry::PointGrid& grid, const OcclusionConfig& config)
      : grid_(grid), config_(config) {}

  /// zeta: the first multiple of the step at which the ball from `frontier` along the unit vector
  /// `direction` holds no point. At most min(psi, limit), which is returned where none is clear.
  double clear_offset(const Eigen::Vector3d& frontier, const Eigen::Vector3d& direction,
                      double limit) const;

  /// Whether some point is in one of the balls between `offset` (zeta) from `frontier` and the end
  /// of the march towards `sensor`.
  bool is_occluded(const Eigen::Vector3d& frontier, double offset,
                   const Eigen::Vector3d& sensor) const;

 private:
  const geometry::PointGrid& grid_;
  OcclusionConfig config_;
};

/// The unit vectors from `from` to the points that are within `radius` of `place`, but for those
/// that are at `from` itself.
std::vector<Eigen::Vector3d> directions_to_near(const geometry::PointGrid& points,
                                                const Eigen::Vector3f& place, double radius,
                                                const Eigen::Vector3d& from);

}  // namespace skycap::survey::see
