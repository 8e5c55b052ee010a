#include "missions/support/reconstruction.h"

#include <cmath>
#include <string>

#include "geometry/error.h"
#include "missions/support/module.h"

namespace skycap::missions::support {

void ReconstructionConfig::validate() const {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw Error(ErrorKind::bad_config, what);
  };
  require(depth >= 0 && depth <= 12,
          "reconstruction.depth is " + std::to_string(depth) + "; it must be from 0 to 12");
  require(spacing >= 0.0 && std::isfinite(spacing),
          "reconstruction.spacing is " + std::to_string(spacing) + "; it must be zero or more");
  require(
      neighbours >= 4 && neighbours <= 1000,
      "reconstruction.neighbours is " + std::to_string(neighbours) + "; it must be from 4 to 1000");
  require(min_density >= 0.0 && min_density < 1.0, "reconstruction.min_density is " +
                                                       std::to_string(min_density) +
                                                       "; it must be at least 0 and below 1");
}

Reconstruction reconstruct(std::span<const Eigen::Vector3f> points,
                           std::span<const Eigen::Vector3f> normals,
                           const ReconstructionConfig& config) {
  config.validate();
  using Reconstruct = void(std::span<const Eigen::Vector3f>, std::span<const Eigen::Vector3f>,
                           const ReconstructionConfig&, Reconstruction&);
  const auto reconstruct_with_pcl =
      module_function<Reconstruct>("libskycap_reconstruction.so", "skycap_reconstruct");
  Reconstruction result;
  reconstruct_with_pcl(points, normals, config, result);
  return result;
}

}  // namespace skycap::missions::support
