#include "missions/scene/scene_source.h"

#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/mesh_io.h"
#include "geometry/io/record_log.h"
#include "geometry/pose/world.h"
#include "missions/scene/model_store.h"
#include "missions/scene/scene_tiles.h"
#include "missions/site_data/prior.h"
#include "missions/site_data/site_priors.h"
#include "missions/support/number_text.h"
#include "missions/support/yaml_tree.h"
#include "sim/models/models.h"

namespace skycap::missions::scene {
namespace {

using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr std::string_view builtin = "builtin:", stored = "model:";

/// Returns the file of a model that is not built in.
std::filesystem::path model_file(const SceneOptions& scene, const std::filesystem::path& folder) {
  return scene.model.starts_with(stored) ? find_model(scene.model.substr(stored.size()))
                                         : folder / scene.model;
}

sim::ModelOptions make_model_options(const SceneOptions& scene) {
  sim::ModelOptions options;
  options.detail = scene.detail;
  options.seed = scene.seed;
  // The built-in ground is replaced by one that is excluded from the evaluation.
  if (scene.ground) options.has_ground = false;
  return options;
}

geometry::Mesh named_model(const SceneOptions& scene, const std::filesystem::path& folder) {
  const std::string& model = scene.model;
  if (model.starts_with(builtin)) {
    return sim::builtin_model(model.substr(builtin.size()), make_model_options(scene));
  }
  const std::filesystem::path file = model_file(scene, folder);
  return model.starts_with(stored) || geometry::is_mesh_file(file) ? geometry::read_mesh(file)
                                                                   : site_data::read_surfaces(file);
}

Vector3d compute_base_centre(const Eigen::AlignedBox3d& box) {
  return {box.center().x(), box.center().y(), box.min().z()};
}

// Limit of one mesh, which takes about 2 GiB with its ray casting tree.
constexpr double max_triangles = 1e7;

geometry::Mesh joined_tiles(const SceneOptions& scene, const std::filesystem::path& folder) {
  geometry::Mesh all;
  for (const TileKind& tile : find_tiles(scene, folder)) {
    const geometry::Mesh mesh = load_model(tile.scene, folder);
    const auto triangles =
        static_cast<double>(all.triangles.size()) +
        static_cast<double>(tile.shifts.size()) * static_cast<double>(mesh.triangles.size());
    if (triangles > max_triangles) {
      throw Error(
          ErrorKind::bad_config,
          "scene.model: the tiles have more than " + support::short_text(max_triangles) +
              " triangles; use fewer tiles for this command (skycap scan accepts any number)");
    }
    for (const Vector3d& shift : tile.shifts) {
      geometry::Mesh copy = mesh;
      geometry::transform(copy, Eigen::Affine3d(Eigen::Translation3d(shift)));
      geometry::append(all, copy);
    }
  }
  return all;
}

std::vector<sim::Surface> joined_surfaces(const SceneOptions& scene,
                                          const std::filesystem::path& folder) {
  std::vector<sim::Surface> all;
  for (const TileKind& tile : find_tiles(scene, folder)) {
    const std::vector<sim::Surface> one = load_surfaces(tile.scene, folder);
    for (std::size_t i = 0; i < tile.shifts.size(); ++i) {
      all.insert(all.end(), one.begin(), one.end());
    }
  }
  return all;
}

Eigen::Affine3d make_rotation(const SceneOptions& scene) {
  const Vector3d& angles = scene.rotation;
  const double upright = scene.up_axis == UpAxis::y ? 0.5 * std::numbers::pi : 0.0;
  return Eigen::Affine3d(
      AngleAxisd(angles.z(), Vector3d::UnitZ()) * AngleAxisd(angles.y(), Vector3d::UnitY()) *
      AngleAxisd(angles.x(), Vector3d::UnitX()) * AngleAxisd(upright, Vector3d::UnitX()));
}

/// Optical properties of a material.
struct Material {
  double reflectance;
  sim::Surface surface = sim::Surface::matt;
};

std::map<std::string, Material> read_materials(const std::filesystem::path& file,
                                               double reflectance) {
  const support::YamlNode root = support::parse_yaml(geometry::read_file(file), file.string());
  const auto fail = [&](int line, const std::string& what) {
    throw Error(ErrorKind::bad_config, file.string() + ":" + std::to_string(line) + ": " + what);
  };
  if (root.kind != support::YamlNode::Kind::map)
    fail(root.line, "must consist of 'NAME: VALUE' lines");
  std::map<std::string, Material> materials;
  for (const support::YamlEntry& entry : root.entries) {
    double value = -1.0;
    const std::string& text = entry.value.text;
    if (text == "glass" || text == "mirror") {
      materials[entry.key] = {reflectance,
                              text == "glass" ? sim::Surface::glass : sim::Surface::mirror};
      continue;
    }
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() ||
        !(value >= 0.0 && value <= 1.0)) {
      fail(entry.line, "material " + entry.key + " is '" + text +
                           "'; it must be glass, mirror or a number from 0 to 1");
    }
    materials[entry.key] = {value};
  }
  return materials;
}

/// Returns the model in its own frame with the reflectances of its materials.
ReflectingScene make_reflecting_scene(const SceneOptions& scene,
                                      const std::filesystem::path& folder) {
  if (scene.model.starts_with(builtin)) {
    throw Error(ErrorKind::bad_config, "scene.materials requires a model from a file; " +
                                           scene.model + " has no materials");
  }
  const std::filesystem::path file = model_file(scene, folder);
  const std::filesystem::path list = folder / *scene.materials;
  const std::map<std::string, Material> materials = read_materials(list, scene.reflectance);
  ReflectingScene result;
  std::string known;
  std::set<std::string> unused;
  for (const auto& [name, material] : materials) unused.insert(name);
  for (const geometry::MaterialMesh& part : geometry::read_mesh_by_material(file)) {
    known += (known.empty() ? "" : ", ") + (part.material.empty() ? "(none)" : part.material);
    unused.erase(part.material);
    const auto given = materials.find(part.material);
    const Material material =
        given == materials.end() ? Material{scene.reflectance} : given->second;
    geometry::append(result.model, part.mesh);
    const std::size_t triangles = result.model.triangles.size();
    result.reflectances.resize(triangles, static_cast<float>(material.reflectance));
    result.surfaces.resize(triangles, material.surface);
  }
  if (!unused.empty()) {
    throw Error(ErrorKind::bad_config, list.string() + ": the model has no material " +
                                           *unused.begin() + "; its materials are " + known);
  }
  return result;
}

}  // namespace

geometry::Mesh load_model(const SceneOptions& scene, const std::filesystem::path& folder) {
  if (is_tiled(scene)) return joined_tiles(scene, folder);
  geometry::Mesh mesh =
      scene.materials ? make_reflecting_scene(scene, folder).model : named_model(scene, folder);
  try {
    geometry::validate(mesh);
  } catch (const Error& error) {
    throw Error(error.kind(), scene.model + ": " + error.what());
  }
  return mesh;
}

std::vector<sim::Surface> load_surfaces(const SceneOptions& scene,
                                        const std::filesystem::path& folder) {
  if (is_tiled(scene)) return joined_surfaces(scene, folder);
  if (scene.materials) return make_reflecting_scene(scene, folder).surfaces;
  if (!scene.model.starts_with(builtin)) return {};
  return sim::builtin_surfaces(scene.model.substr(builtin.size()), make_model_options(scene));
}

std::vector<std::filesystem::path> collect_files(const SceneOptions& scene,
                                                 const std::optional<std::string>& lidar,
                                                 const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (lidar && lidar->ends_with(".yaml")) files.push_back(folder / *lidar);
  if (scene.materials) files.push_back(folder / *scene.materials);
  if (!scene.is_truth_prior() && !scene.model.starts_with(builtin)) {
    files.push_back(model_file(scene, folder));
  }
  if (!scene.is_truth_prior() && is_tiled(scene)) {
    for (const TileKind& tile : find_tiles(scene, folder)) {
      if (!tile.scene.model.starts_with(builtin)) files.push_back(model_file(tile.scene, folder));
    }
  }
  return files;
}

Eigen::Affine3d turn_and_scale(const SceneOptions& scene) {
  return Eigen::Affine3d(Eigen::Scaling(scene.scale.value_or(1.0))) * make_rotation(scene);
}

void place_model(const SceneOptions& scene, geometry::Mesh& model) {
  geometry::transform(model, make_rotation(scene));
  double scale = scene.scale.value_or(1.0);
  if (scene.longest_side) {
    scale = *scene.longest_side / geometry::bounding_box(model).sizes().maxCoeff();
  }
  if (!std::isfinite(scale)) {
    throw Error(ErrorKind::bad_geometry, scene.model + ": is too small to be scaled");
  }
  geometry::transform(model, Eigen::Affine3d(Eigen::Scaling(scale)));
  const Vector3d own_index =
      is_tiled(scene) ? Vector3d(0, 0, 0) : compute_base_centre(geometry::bounding_box(model));
  geometry::transform(model, Eigen::Affine3d(Eigen::Translation3d(scene.position - own_index)));
  const Eigen::AlignedBox3d box = geometry::bounding_box(model);
  for (const Vector3d& corner : {box.min(), box.max()}) {
    geometry::require_valid_position(corner, scene.model + ": a corner of the placed model");
  }
}

std::vector<Eigen::Isometry3d> compute_copy_poses(const SceneOptions& scene) {
  std::vector<Eigen::Isometry3d> poses = {Eigen::Isometry3d::Identity()};
  for (const Vector3d& copy : scene.copies) {
    poses.push_back(Eigen::Translation3d(scene.position + Vector3d(copy.x(), copy.y(), 0.0)) *
                    AngleAxisd(copy.z(), Vector3d::UnitZ()) *
                    Eigen::Translation3d(-scene.position));
  }
  return poses;
}

geometry::Mesh with_copies(const SceneOptions& scene, const geometry::Mesh& placed_model) {
  const std::vector<Eigen::Isometry3d> poses = compute_copy_poses(scene);
  const double triangles =
      static_cast<double>(poses.size()) * static_cast<double>(placed_model.triangles.size());
  if (triangles > max_triangles) {
    throw Error(ErrorKind::bad_config, "scene.copies: " + std::to_string(poses.size()) + " times " +
                                           std::to_string(placed_model.triangles.size()) +
                                           " triangles exceed the limit of " +
                                           support::short_text(max_triangles) +
                                           "; use fewer copies or a coarser model");
  }
  geometry::Mesh all;
  for (const Eigen::Isometry3d& pose : poses) {
    geometry::Mesh copy = placed_model;
    geometry::transform(copy, Eigen::Affine3d(pose));
    geometry::append(all, copy);
  }
  return all;
}

ReflectingScene reflecting_scene(const SceneOptions& scene, const std::filesystem::path& folder) {
  ReflectingScene result;
  if (scene.is_truth_prior()) {
    result.model = prior_truth(scene);
  } else if (scene.materials) {
    result = make_reflecting_scene(scene, folder);
  } else {
    result.model = load_model(scene, folder);
    result.surfaces = load_surfaces(scene, folder);
  }
  if (!scene.is_truth_prior()) place_model(scene, result.model);
  const auto reflectance = static_cast<float>(scene.reflectance);
  result.reflectances.resize(result.model.triangles.size(), reflectance);
  result.poses = compute_copy_poses(scene);
  if (scene.ground || scene.neighbours) {
    const geometry::Mesh all = with_copies(scene, result.model);
    result.surroundings = make_surroundings(scene, geometry::bounding_box(all));
  }
  result.surroundings_reflectances.resize(result.surroundings.triangles.size(), reflectance);
  return result;
}

sim::Scene ReflectingScene::scene(unsigned threads) const {
  if (poses.size() == 1) {  // Ray casting is faster with a single mesh than with an instance.
    geometry::Mesh mesh = model;
    std::vector<float> all = reflectances;
    std::vector<sim::Surface> lit = surfaces;
    geometry::append(mesh, surroundings);
    all.insert(all.end(), surroundings_reflectances.begin(), surroundings_reflectances.end());
    if (!lit.empty()) lit.resize(mesh.triangles.size(), sim::Surface::matt);
    return sim::Scene(std::array{sim::ScenePart{mesh, all, {}, lit}}, threads);
  }
  std::vector<sim::ScenePart> parts = {{model, reflectances, poses, surfaces}};
  if (!surroundings.triangles.empty())
    parts.push_back({surroundings, surroundings_reflectances, {}});
  return sim::Scene(parts, threads);
}

Vector3d ReflectingScene::centre() const {
  Eigen::AlignedBox3d box;
  for (const Eigen::Isometry3d& pose : poses) {
    box.extend(geometry::bounding_box(model).transformed(pose));
  }
  return box.center();
}

std::string ReflectingScene::content_checksum() const {
  std::string content_checksum;
  const auto add = [&](const auto& items) {
    const auto* const bytes = reinterpret_cast<const char*>(items.data());
    const auto sum = geometry::compute_crc32({bytes, items.size() * sizeof(items[0])});
    content_checksum += fmt::format("{}{:08x}", content_checksum.empty() ? "" : " ", sum);
  };
  for (const geometry::Mesh* mesh : {&model, &surroundings}) {
    add(mesh->vertices);
    add(mesh->triangles);
  }
  add(reflectances);
  add(surroundings_reflectances);
  add(poses);
  if (!surfaces.empty()) add(surfaces);
  return content_checksum;
}

geometry::Mesh make_ground(const SceneOptions& scene, const Eigen::AlignedBox3d& model) {
  const bool has_terrain = scene.priors && scene.priors->terrain;
  return has_terrain ? scene.priors->terrain->surface() : ground_under(model);
}

geometry::Mesh make_surroundings(const SceneOptions& scene, const Eigen::AlignedBox3d& model) {
  geometry::Mesh mesh = prior_neighbours(scene);
  if (scene.ground) geometry::append(mesh, make_ground(scene, model));
  return mesh;
}

geometry::Mesh ground_under(const Eigen::AlignedBox3d& model) {
  const Vector3d middle = compute_base_centre(model);
  const double half = 5.0 * model.sizes().maxCoeff();
  return {{middle + Vector3d(-half, -half, 0), middle + Vector3d(half, -half, 0),
           middle + Vector3d(half, half, 0), middle + Vector3d(-half, half, 0)},
          {{0, 1, 2}, {0, 2, 3}}};
}

}  // namespace skycap::missions::scene
