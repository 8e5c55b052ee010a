/// Settings in the section `scene` of a mission file: the surface that simulated sensors measure.
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

/// Up axis of the model's own frame.
enum class UpAxis { z, y };

/// Model to survey and its pose. The model is rotated upright, rotated, scaled, and then moved so
/// that the centre of the base of its bounding box is at `position`.
struct SceneOptions {
  std::string model;  ///< builtin:NAME, model:NAME, or the path of a mesh.
  /// Level of detail of a built-in model.
  sim::LevelOfDetail detail = sim::LevelOfDetail::standard;
  std::uint64_t seed = 1;  ///< Seed of a randomly generated built-in model.
  UpAxis up_axis = UpAxis::z;
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< Rotation about x, then y, then z [rad].
  std::optional<double> longest_side;  ///< Longest side of the bounding box after rotation [m].
  std::optional<double> scale;         ///< Scale factor; conflicts with longest_side.
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  /// Additional copies of the model: x and y offset from its position [m], and rotation about its
  /// vertical axis [rad].
  std::vector<Eigen::Vector3d> copies;
  bool ground = false;       ///< Add a ground plane or the terrain under the model.
  bool neighbours = false;   ///< Add neighbouring objects from the prior data.
  double reflectance = 0.4;  ///< Default diffuse reflectance at the laser's wavelength.
  /// File with reflectances, glass and mirrors by material name.
  std::optional<std::string> materials;

  /// Prior data of the mission; may be null.
  std::shared_ptr<const site_data::SitePriors> priors;
  /// Role of the prior data that replaces `model`: truth or target.
  std::optional<site_data::Role> truth;

  /// Returns true if sensors measure prior data.
  bool is_truth_prior() const { return truth.has_value(); }
};

/// Returns the prior data that sensors measure as one mesh; empty without such data.
geometry::Mesh prior_truth(const SceneOptions& scene);

/// Returns the surfaces of obstacles, except those that are also targets or ground truth. Files
/// with a target typically also contain its surroundings and are read once per role.
std::vector<const geometry::Mesh*> find_neighbours(const site_data::SitePriors& site);

/// Returns the neighbouring obstacles from the prior data as one mesh, except targets and ground
/// truth. Empty unless `neighbours` is set.
geometry::Mesh prior_neighbours(const SceneOptions& scene);

}  // namespace skycap::missions::scene
