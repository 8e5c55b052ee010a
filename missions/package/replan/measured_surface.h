/// Surface that a survey measured, for predicting the coverage of flights without ground truth.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/point_cloud.h"
#include "sim/scene/scene.h"
#include "survey/surfel/view_gain.h"

namespace skycap::missions::package {

/// Measured points as a surface that views see and that occludes itself: each point is a small
/// square in the plane of its neighbours.
class MeasuredSurface {
 public:
  /// `normals` contains the unit normal of each point of the cloud, which must have points.
  /// `spacing` is the point spacing of the mission [m].
  MeasuredSurface(double spacing, const geometry::PointCloud& cloud,
                  std::span<const Eigen::Vector3f> normals, unsigned threads);

  /// Returns at most `max_count` of the points with equal weights as targets of views.
  std::vector<survey::surfel::GainField::Target> targets(std::size_t max_count) const;

  /// Returns 1 for each target that a camera at `position` can see, otherwise 0. Surface close to a
  /// target does not occlude it.
  std::vector<std::uint8_t> in_sight(const Eigen::Vector3d& position,
                                     std::span<const Eigen::Vector3f> targets) const;

 private:
  double spacing_;
  std::vector<Eigen::Vector3f> samples_, normals_;  ///< Sampled points and their normals.
  sim::Scene scene_;
};

}  // namespace skycap::missions::package
