/// What a mission may set about Skycap's own planner (skycap_planner.h).
#pragma once

#include <memory>
#include <optional>

#include <Eigen/Geometry>

#include "survey/skycap/prior_surface.h"
#include "survey/view_limits.h"

namespace skycap::survey::skycap {

/// When to stop, in the user's words. The survey ends as soon as one of them holds.
struct StopRule {
  /// Enough is covered: the share of the surface, seen and guessed, that the planner believes
  /// covered; in (0, 1].
  double wanted_coverage = 1.0;
  /// Another view is not worth it: the best one promises less than this share of the known area, or
  /// of seven times what one scan covered at most, if that is less.
  double least_gain = 0.003;
  std::optional<double> most_length;  ///< of the straight lines between the views
  std::optional<double> most_time;    ///< of the flight [s], by `speed` and `time_per_view`
  double speed = 5.0;                 ///< between views [m/s]
  double time_per_view = 5.0;         ///< to stop, turn and measure [s]
};

/// The planner's main ideas, to find out what each is worth.
struct SkycapIdeas {
  bool dose = true;            ///< weigh looks by the noise; otherwise one look covers
  bool unseen_surface = true;  ///< guess where the surface goes on
  bool free_space = true;      ///< drop guesses where the sensor saw through
  bool learned_rates = true;   ///< grade the guesses by what became of the earlier ones
  bool targeted_views = true;  ///< candidates for what is missing, besides the global directions
  bool refinement = true;      ///< move the best candidates
  bool batch = true;           ///< plan several views ahead
};

struct SkycapConfig {
  double coverage_radius = 0.005;  ///< r_d: covered is what has a measurement this near
  std::optional<double> spacing;   ///< epsilon, least distance of kept points; r_d / 2
  /// d, at which views are taken; where the pixels are r_d / 2 apart on a wall.
  std::optional<double> view_distance;
  std::optional<double> view_price;  ///< what a view costs, in metres of way; 3 d
  std::optional<double> resolution;  ///< h of the surfels; from the pixels and the first scan
  /// Angle between ray and normal beyond which the sensor gets no return [rad], in (0, pi/2]. Looks
  /// at more than 78 degrees are not counted on, whatever it is.
  double max_incidence = 1.5707963267948966;
  /// Where the scene is. What lies outside is no surface of interest, and its space is free.
  /// Not given: all that was measured so far.
  std::optional<Eigen::AlignedBox3d> scene_box;
  /// What is thought to be there; null: nothing.
  std::shared_ptr<const PriorSurface> prior{};
  ViewLimits limits;
  StopRule stop;
  SkycapIdeas ideas;
  int continuation_steps = 3;  ///< how far guesses reach: 1.6 h, 3.2 h, 6.4 h ... ; 1 to 5
  /// Whether a ray without a return shows empty space, to drop guesses. Never for where to fly.
  bool misses_are_empty = true;
  unsigned threads = 1;  ///< zero: all processors; the plan does not depend on it
  /// How far a scan's pose is known to be off: standard deviations of its place along each axis [m]
  /// and of small angles about each [rad].
  double place_error = 0.0, angle_error = 0.0;
  /// Between frames that are taken on straight ways to views [m]; zero: none are.
  double frame_spacing = 0.0;
  /// Whether a single scan shows so little that stop rules count a view with the way to it.
  bool counts_ways = false;
  /// Whether the sensor sees upright lines only, which are to the left of a level nose: then the
  /// camera stands for what is swept in a frame's spacing, and only ways measure.
  bool sees_lines = false;

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

}  // namespace skycap::survey::skycap
