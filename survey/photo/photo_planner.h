/// Planner of photos: selects a minimum set of photos for the photogrammetric reconstruction of a
/// known target, and predicts the missing surface.
///
/// Photos are selected with one set of surface samples. All figures are computed with another set,
/// so that they are not biased by the selection.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "geometry/pose/photo_camera.h"
#include "geometry/pose/pose.h"
#include "geometry/surfaces/mesh.h"
#include "survey/photo/candidates.h"
#include "survey/photo/cover_bound.h"
#include "survey/photo/patterns.h"
#include "survey/photo/photo_choice.h"
#include "survey/photo/stereo_quality.h"
#include "survey/photo/view_graph.h"

namespace skycap::survey::photo {

/// Source of the photo poses in the photogrammetry program: given (RTK, PPK), or estimated by the
/// program.
enum class PosesGiven { known, unknown };

struct PhotoPlanOptions {
  geometry::PhotoCameraConfig camera;
  double gsd = 0.0;  ///< Ground sampling distance on a surface that faces the camera [m].
  /// Rule for partners, incidence and parallax. View distance and nearest focus are computed from
  /// camera and GSD.
  StereoRule rule;
  PosesGiven poses = PosesGiven::known;
  std::vector<Pattern> patterns{Pattern::facade, Pattern::dome, Pattern::oblique};
  double forward_overlap = 0.8;  ///< Forward overlap of patterns.
  double side_overlap = 0.7;     ///< Side overlap of patterns.
  double target_share = 1.0;  ///< Fraction of the attainable surface at which the selection stops.
  std::size_t max_photos = 2000;
  std::optional<Pattern> flown_pattern;  ///< Pattern that replaces the selection.
  std::size_t repair_rounds = 900;       ///< Rounds of the search after the greedy selection.

  /// Throws Error{bad_config} with the name of the first field outside its interval.
  void validate() const;
};

/// Parameters of one run of the planner.
struct PhotoPlanRun {
  std::uint64_t seed = 1;
  unsigned threads = 1;  ///< Zero: all processors. Does not affect the plan.
  std::stop_token stop{};
  std::function<void(const std::string& what)>
      report{};  ///< Receives progress messages. May be null.
};

/// Target with its surroundings. Mission frame, z up.
struct PhotoSite {
  geometry::Mesh target;
  geometry::Mesh surroundings;  ///< Other surfaces that obstruct lines of sight. May be empty.
  GroundHeight ground;          ///< Null: no ground.
  double foot = 0.0;            ///< z at the base of the target [m].
  double min_height = 0.0;      ///< z of the lowest photos of patterns [m].
  PhotoSpace space;
};

/// Figures of a set of photos, computed with samples of the exposed surface.
struct PhotoFigures {
  std::size_t photos = 0;
  std::size_t samples = 0;     ///< Samples of the exposed surface.
  std::size_t attainable = 0;  ///< Samples that are satisfied if all candidates are taken.
  std::size_t satisfied = 0;   ///< Samples with at least min_partners stereo partners.
  std::size_t good = 0;        ///< Samples with k >= 3 or h >= 1.
  std::size_t weak = 0;        ///< Other samples with k = 2 or h >= 0.2.
  std::size_t missing = 0;     ///< All other samples.
  std::array<std::size_t, 9> by_partners{};  ///< Samples with k = -2, -1, 0, ... 5, and 6 or more.
  double completeness = 0.0;  ///< Expected fraction of exposed surface with one depth or more.
  double threefold = 0.0;     ///< Expected fraction with three depths or more.

  double share(std::size_t count) const {
    return samples > 0 ? static_cast<double>(count) / static_cast<double>(samples) : 0.0;
  }
  double attainable_share(std::size_t count) const {
    return attainable > 0 ? static_cast<double>(count) / static_cast<double>(attainable) : 0.0;
  }
};

/// Result of a pattern that is compared with the plan.
struct PatternResult {
  Pattern pattern = Pattern::nadir;
  std::vector<geometry::View> views;
  std::size_t dropped = 0;  ///< Number of photos excluded by the space.
  PhotoFigures figures;
  std::vector<geometry::View> pruned_views;  ///< Remaining photos after destroy-and-repair.
  PhotoFigures pruned;
};

/// Reason for which a piece of exposed surface is not satisfied by a plan.
enum class MissingReason {
  occluded,      ///< Visible from too few directions.
  min_standoff,  ///< Visible only from positions too close to obstacles or outside the airspace.
  incidence,     ///< Visible only at excessive angles of incidence.
  gimbal,        ///< Visible only outside the gimbal's range.
  height,        ///< Visible only from below the minimum height.
  not_taken,     ///< Attainable, but excluded by a limit or by too little gain.
};
inline constexpr std::size_t missing_reasons = 6;
/// Returns the name for files: "occluded", "stand_off", "incidence", "gimbal", "height" or
/// "not_taken".
const char* to_string(MissingReason reason);

struct CurvePoint {
  std::size_t photos = 0;
  double completeness = 0.0;  ///< Expected completeness of the exposed surface.
  double satisfied = 0.0;     ///< Satisfied fraction of the exposed surface.
};

struct PhotoPlanResult {
  double view_distance = 0.0;  ///< View distance d [m].
  std::vector<geometry::View>
      views;  ///< Photos, most useful first. Truncated lists are good plans.
  std::vector<std::uint32_t> observed;  ///< Number of evaluation samples that each photo observes.
  std::vector<double> gsd;  ///< GSD where each optical axis meets a surface [m]. 0: none.
  std::size_t candidates = 0;
  std::size_t greedy_photos = 0;    ///< Photos before destroy-and-repair.
  std::size_t repaired_photos = 0;  ///< Photos after destroy-and-repair.
  std::size_t connecting = 0;       ///< Photos added to connect the view graph.
  double surface_area = 0.0;        ///< Surface area of the target [m^2].
  double exposed_area = 0.0;        ///< Exposed surface area [m^2].
  PhotoFigures figures;
  std::array<double, missing_reasons> missing_area{};  ///< Missing area by MissingReason [m^2].
  std::vector<CurvePoint> curve;
  CoverBound bound;  ///< Lower bound of the photos, without connecting photos.
  ViewGraph graph;
  /// Pairs of views for the matcher, see min_matchable_to_match.
  std::vector<PhotoPair> matching_pairs;
  std::vector<PatternResult> patterns;
  std::vector<std::string> warnings;  ///< Warnings for the user.
};

/// Plans photos. Throws Error{bad_config} if the view distance is below the stand-off or the
/// nearest focus, or if photos with unknown poses cannot be connected. Throws Error{bad_geometry}
/// if less than 10% of the target is exposed, or if no candidate observes a sample. After a stop
/// request, returns the best plan found.
PhotoPlanResult plan_photos(const PhotoPlanOptions& options, const PhotoSite& site,
                            const PhotoPlanRun& run);

/// Returns the figures of each set of photos, such as those of a flight, with the samples by which
/// plan_photos() evaluates. `attainable` is 0. Throws the errors of plan_photos().
std::vector<PhotoFigures> evaluate_photos(const PhotoPlanOptions& options, const PhotoSite& site,
                                          const PhotoPlanRun& run,
                                          const std::vector<std::vector<geometry::View>>& sets);

}  // namespace skycap::survey::photo
