/// Simplification of a densely sampled track to waypoints, with a proven bound on the deviation.
///
/// Method: the algorithm of Douglas and Peucker (1973) in three dimensions, with the distance to
/// the segment, not to the infinite line. A segment is divided at the sample with the largest ratio
/// of deviation to tolerance until no ratio exceeds 1. Headings and gimbal pitches are treated in
/// the same manner: between two waypoints they may deviate from an even rotation by a maximum
/// angle.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "flight/export/flight_plan.h"

namespace skycap::flight {

/// Sample of a track. Angles that are unknown are `unspecified`.
struct TrackSample {
  double time = 0.0;  ///< In ascending order [s].
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double yaw_deg = unspecified;
  double pitch_deg = unspecified;
  bool is_kept = false;  ///< The sample must remain a waypoint, as for a capture.
};

struct SimplificationOptions {
  double tolerance = 0.5;      ///< Maximum distance of a sample from the simplified track [m].
  double max_turn_deg = 15.0;  ///< Maximum deviation of heading and pitch from an even rotation.

  /// Throws Error{bad_config} unless both are positive and finite.
  void validate() const;
};

struct SimplifiedTrack {
  /// Indices of the samples that remain, in ascending order. Empty only without samples.
  std::vector<std::size_t> kept;
  /// Maximum distance of a sample from the segment between the two waypoints around it [m]. At most
  /// the tolerance.
  double deviation = 0.0;
};

/// Simplifies a track. Samples with `is_kept` remain. Other waypoints that nearly coincide with
/// their predecessor, in position and direction, are omitted; the bound includes the effect. Throws
/// the errors of SimplificationOptions::validate().
SimplifiedTrack simplify_track(const std::vector<TrackSample>& samples,
                               const SimplificationOptions& options);

}  // namespace skycap::flight
