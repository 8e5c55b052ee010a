/// The planner of photographs: the fewest photos from which photogrammetry reconstructs a known
/// target, and what will be missing.
///
/// Photos are chosen on one set of surface samples; every figure is of another set.
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
#include "survey/photo/patterns.h"
#include "survey/photo/photo_choice.h"
#include "survey/photo/stereo_quality.h"
#include "survey/photo/view_graph.h"

namespace skycap::survey::photo {

/// Whether the photogrammetry program is given the photos' poses (RTK, PPK), or has to find them.
enum class PosesGiven { known, unknown };

struct PhotoPlanOptions {
  geometry::PhotoCameraConfig camera;
  double gsd = 0.0;  ///< ground sampling distance on a surface that faces the camera [m]
  /// Partners, incidence and parallax; view distance and nearest focus follow from camera and gsd.
  StereoRule rule;
  PosesGiven poses = PosesGiven::known;
  std::vector<Pattern> patterns{Pattern::facade, Pattern::dome, Pattern::oblique};
  double forward_overlap = 0.8;  ///< of patterns
  double side_overlap = 0.7;     ///< of patterns
  double target_share = 1.0;     ///< of the attainable surface; the choice stops there
  std::size_t max_photos = 2000;
  std::optional<Pattern> flown_pattern;  ///< flies a pattern as it is instead of a choice
  std::size_t repair_rounds = 900;       ///< of the search after the greedy choice

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

/// Values of one run of the planner.
struct PhotoPlanRun {
  std::uint64_t seed = 1;
  unsigned threads = 1;  ///< zero: all processors; does not change the plan
  std::stop_token stop{};
  std::function<void(const std::string& what)> report{};  ///< told what is being done; may be null
};

/// The target and its surroundings. Mission frame, z up.
struct PhotoSite {
  geometry::Mesh target;
  geometry::Mesh surroundings;  ///< obstructs lines of sight as well; may be empty
  GroundHeight ground;          ///< null: no ground
  double foot = 0.0;            ///< z of the target's foot [m]
  double min_height = 0.0;      ///< z of the lowest photos of patterns [m]
  PhotoSpace space;
};

/// Figures of a set of photos over samples of exposed surface.
struct PhotoFigures {
  std::size_t photos = 0;
  std::size_t samples = 0;                   ///< exposed
  std::size_t attainable = 0;                ///< satisfied when all candidates are taken
  std::size_t satisfied = 0;                 ///< at least min_partners stereo partners
  std::size_t good = 0;                      ///< k >= 3 or h >= 1
  std::size_t weak = 0;                      ///< else k = 2 or h >= 0.2
  std::size_t missing = 0;                   ///< else
  std::array<std::size_t, 9> by_partners{};  ///< samples with k = -2, -1, 0, ... 5, and 6 or more
  double completeness = 0.0;  ///< expected fraction of exposed surface with one depth or more
  double threefold = 0.0;     ///< expected fraction with three depths or more

  double share(std::size_t count) const {
    return samples > 0 ? static_cast<double>(count) / static_cast<double>(samples) : 0.0;
  }
  double attainable_share(std::size_t count) const {
    return attainable > 0 ? static_cast<double>(count) / static_cast<double>(attainable) : 0.0;
  }
};

/// A pattern beside the plan.
struct PatternResult {
  Pattern pattern = Pattern::nadir;
  std::vector<geometry::View> views;
  std::size_t dropped = 0;  ///< photos that the space does not allow
  PhotoFigures figures;
  std::vector<geometry::View> pruned_views;  ///< what destroy-and-repair leaves of them
  PhotoFigures pruned;
};

/// Why a piece of exposed surface is not satisfied by a plan.
enum class MissingReason {
  occluded,      ///< too few directions see it
  min_standoff,  ///< positions that see it are too close to obstacles or outside of the airspace
  incidence,     ///< positions that see it do so at too large an angle of incidence
  gimbal,        ///< the gimbal cannot look there
  height,        ///< positions that see it are below the minimum height
  not_taken,     ///< attainable, but discarded: a limit, or too little gain for another photo
};
inline constexpr std::size_t missing_reasons = 6;
/// "occluded", "min_standoff" and so on, as the enumerators are called.
const char* to_string(MissingReason reason);

struct CurvePoint {
  std::size_t photos = 0;
  double completeness = 0.0;  ///< expected, of exposed surface
  double satisfied = 0.0;     ///< fraction of exposed surface
};

struct PhotoPlanResult {
  double view_distance = 0.0;           ///< d [m]
  std::vector<geometry::View> views;    ///< best first: every beginning is a good plan
  std::vector<std::uint32_t> observed;  ///< samples of the evaluation set, of each photo
  std::vector<double> gsd;              ///< where each photo's axis meets a surface [m]; 0: none
  std::size_t candidates = 0;
  std::size_t greedy_photos = 0;    ///< before destroy-and-repair
  std::size_t repaired_photos = 0;  ///< after it
  std::size_t connecting = 0;       ///< photos added for the view graph
  double surface_area = 0.0;        ///< of the target [m^2]
  double exposed_area = 0.0;        ///< [m^2]
  PhotoFigures figures;
  std::array<double, missing_reasons> missing_area{};  ///< by MissingReason [m^2]
  std::vector<CurvePoint> curve;
  CoverBound bound;  ///< of photos without those that connect
  ViewGraph graph;
  /// Pairs of views that share at least a fifth of the smaller sample set, for matching.
  std::vector<PhotoPair> matching_pairs;
  std::vector<PatternResult> patterns;
  std::vector<std::string> warnings;  ///< sentences for the user
};

/// Plans photos. Throws Error{bad_config} if the view distance is below the stand-off or the
/// nearest focus, or if unknown poses cannot be connected; Error{bad_geometry} if less than 10% of
/// the target is exposed, or no candidate observes anything. After a stop the best plan so far is
/// returned.
PhotoPlanResult plan_photos(const PhotoPlanOptions& options, const PhotoSite& site,
                            const PhotoPlanRun& run);

}  // namespace skycap::survey::photo
