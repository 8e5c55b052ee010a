/// What simulated sensors measure, as a mission's section `scene` says.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"
#include "missions/site_data/source.h"
#include "sim/models/models.h"

namespace skycap::missions::site_data {
struct SitePriors;
}

namespace skycap::missions::scene {

/// Which axis of the model's own frame points up.
enum class UpAxis { z, y };

/// What is surveyed, and how it is put into the world. In this order the model is turned upright,
/// rotated, scaled, and moved so that the middle of the base of its bounding box is at `position`.
struct SceneOptions {
  std::string model;  ///< builtin:NAME, model:NAME, or the path of a mesh
  sim::LevelOfDetail detail = sim::LevelOfDetail::standard;  ///< of a builtin model
  std::uint64_t seed = 1;                                    ///< of a builtin model that is drawn
  UpAxis up_axis = UpAxis::z;
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< [rad], about x, then y, then z
  std::optional<double> longest_side;                  ///< of the bounding box, after rotation
  std::optional<double> scale;                         ///< factor; only one of the two is given
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  /// The model again: x and y from its position [m], and a turn about its own upright [rad].
  std::vector<Eigen::Vector3d> copies;
  bool ground = false;       ///< whether the sensor also sees a plane under the model
  bool neighbours = false;   ///< and what stands beside it by prior data
  double reflectance = 0.4;  ///< diffuse, at the laser's wavelength, where no other is given
  std::optional<std::string> materials;  ///< a file of reflectances, glass and mirrors, by name

  /// The mission's prior data; null: none.
  std::shared_ptr<const site_data::SitePriors> priors;
  /// The role in the prior data of what is measured in place of `model`: truth or target.
  std::optional<site_data::Role> truth;

  /// Whether what the sensor measures is prior data.
  bool is_truth_prior() const { return truth.has_value(); }
};

/// What of the prior data is measured, as one mesh. Empty if none of it is.
geometry::Mesh prior_truth(const SceneOptions& scene);

/// The surfaces of things in the way but for those that are targets or the truth as well. Files
/// that hold a target mostly hold what stands around it, and are read once for each role.
std::vector<const geometry::Mesh*> neighbours_of(const site_data::SitePriors& site);

/// What stands beside the truth by prior data in the way, as one mesh: all that has a surface but
/// for what is a target or the truth, too. Empty unless the sensor is to see it.
geometry::Mesh prior_neighbours(const SceneOptions& scene);

}  // namespace skycap::missions::scene
