/// Settings of Skycap's own planner (skycap_planner.h).
#pragma once

#include <memory>
#include <optional>

#include <Eigen/Geometry>

#include "survey/surfel/prior_surface.h"
#include "survey/view_limits.h"

namespace skycap::survey::surfel {

/// Stop criteria in terms of the user. The survey ends when the first of them is met.
struct StopRule {
  /// Target coverage: covered fraction of the measured and predicted surface, as estimated by the
  /// planner; in (0, 1].
  double target_coverage = 1.0;
  /// Minimum gain of the best view, as a fraction of the known area. If seven times the maximum
  /// area that one scan covered is smaller, it replaces the known area.
  double min_gain = 0.003;
  std::optional<double> max_length;  ///< total length of the straight lines between the views [m]
  std::optional<double> max_time;    ///< flight time [s], from `speed` and `time_per_view`
  double speed = 5.0;                ///< between views [m/s]
  double time_per_view = 5.0;        ///< stop, rotation and measurement [s]
};

/// Ablation switches of the planner.
struct AblationSwitches {
  bool coverage_model =
      true;  ///< weight observations by noise; otherwise one observation covers completely
  bool surface_prediction = true;  ///< predict how the surface continues
  bool free_space = true;          ///< discard predictions where the sensor saw through
  bool learned_rates = true;       ///< weight predictions by the success of earlier ones
  bool targeted_views =
      true;  ///< generate candidates for uncovered surface, in addition to the global directions
  bool refinement = true;  ///< move the best candidates
  bool batch = true;       ///< plan several views ahead
};

struct SurfelConfig {
  double coverage_radius =
      0.005;  ///< r_d: maximum distance of a measurement that covers a position [m]
  std::optional<double>
      spacing;  ///< epsilon: minimum distance of kept points [m]; default: r_d / 2
  /// d: view distance [m]; default: the distance at which the pixel spacing on a wall is r_d / 2.
  std::optional<double> view_distance;
  std::optional<double> view_price;  ///< fixed cost of a view, in metres of path; default: 3 d
  std::optional<double>
      resolution;  ///< h: surfel spacing [m]; default: from the pixels and the first scan
  /// Maximum angle between ray and normal with a return [rad], in (0, pi/2]. Observations at more
  /// than 78 degrees are never counted on.
  double max_incidence = 1.5707963267948966;
  /// Bounding box of the scene. Surface outside is ignored, and space outside is assumed free.
  /// Default: the bounding box of all measurements so far.
  std::optional<Eigen::AlignedBox3d> scene_box;
  /// Prior surface; may be null.
  std::shared_ptr<const PriorSurface> prior{};
  ViewLimits limits;
  StopRule stop;
  AblationSwitches ablation;
  int continuation_steps = 3;  ///< range of predictions: 1.6 h, 3.2 h, 6.4 h ...; 1 to 5 steps
  /// Whether a ray without a return proves free space for discarding predictions. Never used for
  /// path planning.
  bool misses_are_empty = true;
  unsigned threads = 1;  ///< zero: all processors; does not affect the plan
  /// Pose error of a scan: standard deviation of the position along each axis [m] and of a small
  /// rotation about each axis [rad].
  double position_error = 0.0, angle_error = 0.0;
  /// Distance between en-route frames on straight paths to views [m]; zero: no en-route frames.
  double frame_spacing = 0.0;
  /// Whether stopping rules include the path to a view, for sensors whose single scans show little.
  bool counts_en_route = false;
  /// Whether the sensor measures only vertical lines, to the left of a level nose. The camera then
  /// represents the area swept within a frame spacing, and only paths measure.
  bool sees_lines = false;

  /// Throws Error{bad_config} that names the first field outside its interval.
  void validate() const;
};

}  // namespace skycap::survey::surfel
