/// Surface that a survey measured, for predicting the coverage of flights without ground truth.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/point_cloud.h"
#include "missions/evaluation/simulation_options.h"
#include "missions/session/view_in_flight.h"
#include "sim/scene/scene.h"
#include "survey/surfel/view_gain.h"

namespace skycap::missions::package {

/// Measured points as a surface for a simulated sensor: each point is a small square in the plane
/// of its neighbours.
class MeasuredSurface {
 public:
  /// `normals` contains the unit normal of each point of the cloud, which must have points. `seed`
  /// determines the errors of the simulated flight.
  MeasuredSurface(const evaluation::SimulationOptions& options, const geometry::PointCloud& cloud,
                  std::span<const Eigen::Vector3f> normals, std::uint64_t seed, unsigned threads);

  /// Returns the fraction of the points that the views measure again from an empty cloud, within
  /// the coverage distance and with the mission's spacing. After a stop request, the result is
  /// incomplete.
  double predicted_reflight(const std::vector<session::ViewInFlight>& views,
                            const std::stop_token& stop = {}) const;

  /// Returns at most `max_count` of the points with equal weights as targets of views.
  std::vector<survey::surfel::GainField::Target> targets(std::size_t max_count) const;

  /// Returns 1 for each target that a camera at `position` can see, otherwise 0. Surface close to a
  /// target does not occlude it.
  std::vector<std::uint8_t> in_sight(const Eigen::Vector3d& position,
                                     std::span<const Eigen::Vector3f> targets) const;

 private:
  evaluation::SimulationOptions options_;
  std::vector<Eigen::Vector3f> samples_, normals_;  ///< Sampled points and their normals.
  sim::Scene scene_;
  std::uint64_t seed_;
  unsigned threads_;
};

}  // namespace skycap::missions::package
