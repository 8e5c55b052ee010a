/// Estimate of the surface by Skycap's own planner: position, coverage, and the reason for missing
/// coverage.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace skycap::survey::surfel {

enum class MissingReason {
  none,             ///< covered according to the estimate
  seen_too_thinly,  ///< undersampled: too few measurements for the noise
  never_seen,       ///< unobserved: predicted only
  unreachable,      ///< no view within the limits sees it
};

/// Patch of the estimated surface.
struct EstimatedPatch {
  Eigen::Vector3f position;
  Eigen::Vector3f normal;
  float area;           ///< area [m^2]; for a predicted patch multiplied by its probability
  float covered_share;  ///< expected covered fraction
  MissingReason reason;
};

struct SurveyEstimate {
  double area = 0.0;      ///< measured and predicted area [m^2]
  double coverage = 0.0;  ///< expected covered fraction of the area
  double seen_too_thinly = 0.0, never_seen = 0.0,
         unreachable = 0.0;  ///< missing fractions of the area
  double next_gain = 0.0;  ///< expected gain of the next best view, as a fraction of the known area
  /// Estimated standard deviation of a measurement at normal incidence [m]. For noise that grows
  /// with range: its value at the view distance, and the growing fraction of its variance
  /// (Noise::growing).
  double noise = 0.0, growing_noise = 0.0;
  std::vector<EstimatedPatch> patches;
};

/// Computes the area and the missing fractions from the patches.
inline void add_up(SurveyEstimate& estimate) {
  for (const EstimatedPatch& patch : estimate.patches) estimate.area += patch.area;
  for (const EstimatedPatch& patch : estimate.patches) {
    const double missing = patch.area * (1.0 - patch.covered_share) / estimate.area;
    switch (patch.reason) {
      case MissingReason::none:  // the residual that even well-covered surface lacks
      case MissingReason::seen_too_thinly:
        estimate.seen_too_thinly += missing;
        break;
      case MissingReason::never_seen:
        estimate.never_seen += missing;
        break;
      case MissingReason::unreachable:
        estimate.unreachable += missing;
        break;
    }
  }
}

}  // namespace skycap::survey::surfel
