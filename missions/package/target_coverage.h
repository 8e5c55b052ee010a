/// Coverage of what a mission was to survey, object by object, by the targets among its prior data:
/// the one figure that needs no truth, and so the same for simulated and for real surveys.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "missions/scene/scene_options.h"

namespace skycap::missions::package {

/// A share of the surface that the prior data has.
struct CoveredPart {
  std::string name;      ///< of the object; or wall, roof, opening, other
  double area = 0.0;     ///< [m^2]
  double covered = 0.0;  ///< share with a measurement within the radius
};

struct TargetCoverage {
  CoveredPart object;
  std::vector<CoveredPart> kinds;  ///< where its file tells walls from roofs
  /// Of a measurement from the prior's surface: the registration distance, and what that surface
  /// may be off.
  double radius = 0.0;
};

/// Of each object of the targets that has a surface to be seen, in the order of the mission.
std::vector<TargetCoverage> target_coverage(const scene::SceneOptions& scene,
                                            double registration_distance,
                                            std::span<const Eigen::Vector3f> measured);

/// A line for each; empty without any.
std::string target_text(const std::vector<TargetCoverage>& targets);

}  // namespace skycap::missions::package
