/// Evaluation of any sampled flight around a structure, independent of the planner: duration,
/// surface seen by three rules, views per point, nearest distance and kinematic limits.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "survey/inspection/sight_rules.h"
#include "survey/inspection/smooth_route.h"
#include "survey/inspection/structure_cloud.h"

namespace skycap::survey::inspection {

struct EvaluationOptions {
  InspectionCamera camera;
  MotionLimits limits;
  double min_pitch = -1.5707963267948966;  ///< [rad]
  double max_pitch = 1.5707963267948966;   ///< [rad]
  double view_interval = 0.5;  ///< Time between samples that count as views of a point [s].
  float tolerance = 1.5F;      ///< Rule B: disc radii by which a point may be behind a disc.
  int cube_resolution = 160;   ///< Rule B: pixels along a face of the depth cube.
  unsigned threads = 1;        ///< Zero: all processors. Does not affect the result.
};

/// Largest value of a quantity and the share of samples above its limit. Differences of rounded
/// positions may exceed a limit: values count from 0.1% (speed and angles), 1% (second derivatives)
/// and 4% (jerk) above it.
struct LimitUse {
  double max = 0.0;       ///< Largest Euclidean norm.
  double max_axis = 0.0;  ///< Largest absolute value of an axis.
  double limit = 0.0;
  double share_above = 0.0;
  bool is_kept() const { return share_above == 0.0; }
};

/// Views of a point by rule C, over all points [views].
struct ViewsPerPoint {
  double mean = 0.0;
  double median = 0.0;
  double percentile_10 = 0.0;
};

struct FlightEvaluation {
  double duration = 0.0;                 ///< [s]
  double length = 0.0;                   ///< [m]
  double max_dt_error = 0.0;             ///< Largest deviation from the mean sample interval [s].
  std::size_t points = 0;                ///< Points of the structure.
  PerRule<std::size_t> seen{};           ///< Points seen at least once by each rule.
  std::vector<std::uint8_t> rules_seen;  ///< Per point: bits 0 to 2 for rules A to C.
  ViewsPerPoint views;
  double median_view_distance =
      0.0;                       ///< Median of the smallest view distance of points by rule C [m].
  double nearest = 0.0;          ///< Smallest distance from a point of the structure [m].
  double nearest_surface = 0.0;  ///< Smallest distance from a disc of the structure [m].
  double nearest_time = 0.0;     ///< Time of `nearest` [s].
  double min_height = 0.0;       ///< Lowest z [m].
  LimitUse speed, acceleration, jerk, yaw_rate, yaw_acceleration, pitch_rate;
  double min_pitch = 0.0, max_pitch = 0.0;     ///< [rad]
  double max_ascent = 0.0, max_descent = 0.0;  ///< Largest vertical speeds [m/s].
  bool keeps_vertical_speed = true;
  bool keeps_pitch = true;

  double share(std::size_t rule) const {
    return static_cast<double>(seen[rule]) / static_cast<double>(points);
  }
  /// Returns true if no sample exceeds a limit of motion or pitch.
  bool keeps_limits() const;
};

/// Evaluates a flight. Derivatives are differences of the samples. Between samples, the flight is
/// taken to be straight, which changes distances by at most a dt^2 / 8. Rules A and B are applied
/// at every sample. Throws Error{bad_geometry} with fewer than four samples or times that are not
/// equally spaced to a millisecond.
FlightEvaluation evaluate_flight(std::span<const FlightSample> flight, const StructureCloud& cloud,
                                 const EvaluationOptions& options);

/// Smallest distances of a flight from the points and from the discs of a structure.
struct NearestDistance {
  double points = 0.0;   ///< [m]
  double surface = 0.0;  ///< Lower bound of the distance from the discs [m].
  double time = 0.0;     ///< Time of `points` [s].
};
NearestDistance nearest_distance(std::span<const FlightSample> flight, const StructureCloud& cloud);

}  // namespace skycap::survey::inspection
