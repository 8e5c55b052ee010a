/// Coverage of each target object in the prior data. It requires no ground truth and is therefore
/// comparable between simulated and real surveys.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "missions/scene/scene_options.h"

namespace skycap::missions::package {

/// Coverage of a part of the prior surface.
struct CoveredPart {
  std::string name;      ///< Id of the object, or wall, roof, opening, other.
  double area = 0.0;     ///< [m^2]
  double covered = 0.0;  ///< Fraction with a measured point within the radius.
};

struct TargetCoverage {
  CoveredPart object;
  std::vector<CoveredPart> kinds;  ///< Parts by surface kind, if the prior data distinguishes them.
  /// Maximum distance of a measured point from the prior surface: the sum of the coverage distance
  /// and the uncertainty of the prior [m].
  double radius = 0.0;
};

/// Takes in measurements in any pieces.
class TargetMeter {
 public:
  /// Measures each target object with visible surface, in the order of the mission.
  /// Keeps references to the scene's prior data.
  TargetMeter(const scene::SceneOptions& scene, double registration_distance);
  TargetMeter(TargetMeter&&) noexcept;
  ~TargetMeter();

  void add(std::span<const Eigen::Vector3f> measured);
  std::vector<TargetCoverage> coverage() const;

 private:
  struct Target;
  std::vector<Target> targets_;
};

/// The same of a cloud that is at hand.
std::vector<TargetCoverage> target_coverage(const scene::SceneOptions& scene,
                                            double registration_distance,
                                            std::span<const Eigen::Vector3f> measured);

/// A line for each, which begins with the label; empty without any.
std::string target_text(const std::vector<TargetCoverage>& targets,
                        const std::string& label = "target");

}  // namespace skycap::missions::package
