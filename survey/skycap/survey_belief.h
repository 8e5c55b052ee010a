/// What Skycap's own planner believes of the surface: where it is, how well it is covered, and why
/// the rest of it is missing.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace skycap::survey::skycap {

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
  /// Standard deviation of a measurement head-on, as learnt; at the view distance, if it grows with
  /// range, and the share of its variance there that does (Noise::growing).
  double noise = 0.0, growing_noise = 0.0;
  std::vector<BelievedPatch> patches;
};

/// Fills in the area and the missing shares, by the patches.
inline void add_up(SurveyBelief& belief) {
  for (const BelievedPatch& patch : belief.patches) belief.area += patch.area;
  for (const BelievedPatch& patch : belief.patches) {
    const double missing = patch.area * (1.0 - patch.covered_share) / belief.area;
    switch (patch.reason) {
      case MissingReason::none:  // the rest that even well covered surface lacks
      case MissingReason::seen_too_thinly:
        belief.seen_too_thinly += missing;
        break;
      case MissingReason::never_seen:
        belief.never_seen += missing;
        break;
      case MissingReason::unreachable:
        belief.unreachable += missing;
        break;
    }
  }
}

}  // namespace skycap::survey::skycap
