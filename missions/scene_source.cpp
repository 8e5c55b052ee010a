#include "missions/scene_source.h"

#include <cmath>
#include <numbers>

#include "geometry/error.h"
#include "geometry/mesh_io.h"
#include "missions/model_store.h"
#include "sim/models/models.h"

namespace skycap::missions {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

geometry::Mesh named_model(const SceneConfig& scene, const std::filesystem::path& folder) {
  constexpr std::string_view builtin = "builtin:", stored = "model:";
  const std::string& model = scene.model;
  if (model.starts_with(builtin)) {
    sim::ModelOptions options;
    options.detail = scene.detail;
    if (scene.ground) options.has_ground = false;  // the one that is not judged takes its place
    return sim::builtin_model(model.substr(builtin.size()), options);
  }
  if (model.starts_with(stored)) {
    return geometry::read_mesh(find_model(model.substr(stored.size())));
  }
  return geometry::read_mesh(folder / model);
}

Vector3d middle_of_base(const geometry::Mesh& mesh) {
  const Eigen::AlignedBox3d box = geometry::bounding_box(mesh);
  return {box.center().x(), box.center().y(), box.min().z()};
}

}  // namespace

geometry::Mesh load_model(const SceneConfig& scene, const std::filesystem::path& folder) {
  geometry::Mesh mesh = named_model(scene, folder);
  try {
    geometry::validate(mesh);
  } catch (const Error& error) {
    throw Error(error.kind(), scene.model + ": " + error.what());
  }
  return mesh;
}

void place_model(const SceneConfig& scene, geometry::Mesh& model) {
  const Vector3d& angles = scene.rotation;
  const double upright = scene.up_axis == UpAxis::y ? 0.5 * std::numbers::pi : 0.0;
  const Eigen::Affine3d turn(
      AngleAxisd(angles.z(), Vector3d::UnitZ()) * AngleAxisd(angles.y(), Vector3d::UnitY()) *
      AngleAxisd(angles.x(), Vector3d::UnitX()) * AngleAxisd(upright, Vector3d::UnitX()));
  geometry::transform(model, turn);

  double scale = scene.scale.value_or(1.0);
  if (scene.longest_side) {
    scale = *scene.longest_side / geometry::bounding_box(model).sizes().maxCoeff();
  }
  if (!std::isfinite(scale)) {
    throw Error(ErrorKind::bad_geometry, scene.model + ": is too small to be scaled");
  }
  geometry::transform(model, Eigen::Affine3d(Eigen::Scaling(scale)));
  const Vector3d shift = scene.position - middle_of_base(model);
  geometry::transform(model, Eigen::Affine3d(Eigen::Translation3d(shift)));
}

geometry::Mesh ground_under(const geometry::Mesh& placed_model) {
  const Eigen::AlignedBox3d box = geometry::bounding_box(placed_model);
  const Vector3d middle = middle_of_base(placed_model);
  const double half = 5.0 * box.sizes().maxCoeff();
  return {{middle + Vector3d(-half, -half, 0), middle + Vector3d(half, -half, 0),
           middle + Vector3d(half, half, 0), middle + Vector3d(-half, half, 0)},
          {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace skycap::missions
