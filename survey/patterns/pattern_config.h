/// Settings of surveys that fly a standard pattern (pattern_planner.h).
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include "survey/patterns/patterns.h"
#include "survey/view_limits.h"

namespace skycap::survey::patterns {

/// Settings of a pattern in a mission file.
struct PatternSettings {
  double forward_overlap = 0.3;          ///< Overlap of consecutive views, as a fraction.
  double side_overlap = 0.3;             ///< Overlap of neighbouring rows, as a fraction.
  std::optional<double> pitch;           ///< See PatternOptions::pitch [rad].
  std::vector<Eigen::Vector2d> polygon;  ///< Outline of the target; empty: from other data.
  std::vector<Eigen::Vector2d> line;     ///< Line along the target; empty: from other data.
  double width = 0.0;                    ///< Width of the structure along `line` [m].
  std::optional<double> base;  ///< z of the base of polygon and line [m]; empty: the ground.
  std::optional<double> top;   ///< z of the top of polygon and line [m].
};

struct PatternConfig {
  Pattern pattern = Pattern::nadir;
  PatternSettings settings;
  double spacing = 0.00261711877;                ///< Minimum distance of stored points [m].
  std::optional<Eigen::AlignedBox3d> scene_box;  ///< Measurements outside are ignored.
  ViewLimits limits;
  double view_distance = 1.0;  ///< d [m]
  double max_distance = 1.0;   ///< Maximum distance from which the sensor measures [m].
  Eigen::Vector2d footprint =
      Eigen::Vector2d::Ones();  ///< Width and height of the image at the view distance [m].
  double ground = 0.0;          ///< z of the ground, below which no target is expected [m].
  bool is_swept = false;        ///< See PatternOptions::is_swept.
  /// Distance flown between two en-route measurements [m]; empty: measurements at stops only.
  std::optional<double> frame_spacing;
  /// Target of the mission; empty: granted by the simulated scene.
  std::optional<PatternTarget> target;

  /// Throws Error{bad_config} that names the first field outside its interval.
  void validate() const;
};

/// Views of a pattern, before any of them is flown.
struct PlannedPattern {
  std::vector<geometry::View> views;    ///< Views of which a choice is within the limits, in order.
  std::vector<geometry::View> dropped;  ///< Views of which no choice is within the limits.
};

/// Returns the views of the pattern. With en-route measurements, views that the sensor passes
/// between others are omitted. Throws Error{bad_config} without a target, for patterns of more
/// than 20,000 views, and if no view is within the limits.
PlannedPattern plan_pattern(const PatternConfig& config);

/// Returns the choices for a view that are within the limits of height, pitch and airspace: the
/// view itself, and the views moved away from what it faces by a quarter and a half of the view
/// distance, within the sensor's range. Views below the minimum height are raised to it, by at most
/// half the view distance.
std::vector<geometry::View> find_choices(const PatternConfig& config, const geometry::View& view);

}  // namespace skycap::survey::patterns
