/// Skycap's own planner: few views, from measurements alone.
///
/// It keeps what was measured (dose_map.h), what is known of space (space_memory.h) and guesses
/// where the surface goes on (unseen_surface.h). A view is worth the area that it is expected to
/// cover newly; the next one is the first stop of a short tour through views that complement each
/// other (chooser.h). Nothing needs tuning to a scene: every length derives from the sensor, the
/// coverage radius and the first scan. docs/skycap_planner.md has the formulas and what each idea
/// is worth.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/place/camera.h"
#include "survey/planner.h"
#include "survey/view_limits.h"

namespace skycap::survey::skycap {

/// When to stop, in the user's words. The survey ends as soon as one of them holds.
struct StopRule {
  /// Enough is covered: the share of the surface, seen and guessed, that the planner believes
  /// covered; in (0, 1].
  double wanted_coverage = 1.0;
  /// Another view is not worth it: the best one promises less than this share of the known area, or
  /// of seven times what one scan covered at most, if that is less.
  double least_gain = 0.005;
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
  ViewLimits limits;
  StopRule stop;
  SkycapIdeas ideas;
  int continuation_steps = 3;  ///< how far guesses reach: 1.6 h, 3.2 h, 6.4 h ... ; 1 to 5
  /// Whether a ray without a return shows empty space, to drop guesses. Never for where to fly.
  bool misses_are_empty = true;
  unsigned threads = 1;  ///< zero: all processors; the plan does not depend on it

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

enum class SkycapStop {
  running,
  wanted_coverage,
  little_gain,  ///< no view promises enough, or the last four brought almost nothing
  most_length,
  most_time,
  nothing_in_reach,  ///< no admissible view sees anything that is missing
};

enum class MissingReason {
  none,             ///< covered, as far as the planner can tell
  seen_too_thinly,  ///< too few measurements for the noise
  never_seen,       ///< only guessed to be there
  unreachable,      ///< no view that the limits allow sees it
};

/// A piece of surface as the planner believes it to be.
struct BelievedPatch {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;
  float area;           ///< of a guessed patch: times the probability that it is there
  float covered_share;  ///< expected
  MissingReason reason;
};

struct SurveyBelief {
  double area = 0.0;      ///< seen and guessed [m^2]
  double coverage = 0.0;  ///< expected covered share of it
  double seen_too_thinly = 0.0, never_seen = 0.0, unreachable = 0.0;  ///< missing shares of it
  double next_gain = 0.0;  ///< share of the known area that the best next view would newly cover
  double noise = 0.0;      ///< standard deviation of a measurement head-on, as learnt
  std::vector<BelievedPatch> patches;
};

class SkycapPlanner final : public Planner {
 public:
  /// Throws what config.validate() throws.
  SkycapPlanner(const SkycapConfig& config, const geometry::Camera& camera);
  ~SkycapPlanner() override;

  /// `scan` may be organised (of the camera) or not: a sweep that shoots everywhere into the view
  /// of the camera, about as densely as its pixels lie, and maybe elsewhere too. Views are chosen
  /// by what the camera would see.
  std::optional<geometry::View> next_view(const geometry::Scan& scan) override;
  std::optional<geometry::View> next_view_instead() override;
  const geometry::PointCloud& cloud() const override;
  geometry::PointCloud release_cloud() override;
  const PlanningStep& last_step() const override;

  /// Why the last call proposed nothing.
  SkycapStop stop() const;
  /// Expected covered share of the surface, seen and guessed.
  double predicted_coverage() const;
  /// All that the planner believes of the surface. O(surfels).
  SurveyBelief belief() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace skycap::survey::skycap
