#include "sim/scene/scene_trees.h"

#include <limits>
#include <string>

#include <embree3/rtcore.h>

#include "geometry/error.h"
#include "geometry/parallel.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;

std::vector<Eigen::Isometry3d> copy_poses(const ScenePart& part) {
  if (part.poses.empty()) return {Eigen::Isometry3d::Identity()};
  return {part.poses.begin(), part.poses.end()};
}

/// Embree device, which also stores its errors.
struct Device {
  explicit Device(unsigned threads) {
    const std::string config = "threads=" + std::to_string(geometry::thread_count(threads));
    handle = rtcNewDevice(config.c_str());
    if (handle == nullptr) throw_on_device_error(nullptr);
  }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  ~Device() { rtcReleaseDevice(handle); }

  RTCDevice handle;
};

SceneCopy make_copy(const TreeRoot& part, const Eigen::Isometry3d& scene_from_local,
                    std::size_t first_triangle) {
  SceneCopy copy = {.part = part,
                    .local_from_scene = {},
                    .scene_from_local = {},
                    .first_triangle = static_cast<std::uint32_t>(first_triangle)};
  const Eigen::Isometry3d local_from_scene = scene_from_local.inverse();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      copy.local_from_scene[row][column] = static_cast<float>(local_from_scene(row, column));
    }
    for (int column = 0; column < 3; ++column) {
      copy.scene_from_local[row][column] = static_cast<float>(scene_from_local(row, column));
    }
  }
  return copy;
}

Eigen::AlignedBox3d moved(const Eigen::AlignedBox3d& box, const Eigen::Isometry3d& pose) {
  Eigen::AlignedBox3d all;
  for (int corner = 0; corner < 8; ++corner) {
    all.extend(pose * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  }
  return all;
}

/// Appends a property of a part's triangles to those of the previous parts, which have `before`
/// triangles. The list remains empty until a part has the property.
template <typename Property>
void append_property(std::span<const Property> own, std::size_t triangles, std::size_t before,
                     Property usual, std::vector<Property>& all) {
  if (own.empty() && all.empty()) return;
  all.resize(before, usual);
  all.insert(all.end(), own.begin(), own.end());
  all.resize(before + triangles, usual);
}

}  // namespace

Eigen::AlignedBox3d box_around(std::span<const ScenePart> parts) {
  Eigen::AlignedBox3d all;
  for (const ScenePart& part : parts) {
    const Eigen::AlignedBox3d box = geometry::bounding_box(part.mesh);
    for (const Eigen::Isometry3d& pose : copy_poses(part)) all.extend(moved(box, pose));
  }
  return all;
}

void require_one_each(std::size_t count, const char* what, const geometry::Mesh& mesh) {
  if (count == mesh.triangles.size()) return;
  throw Error(ErrorKind::bad_geometry, "there are " + std::to_string(count) + " " + what + " for " +
                                           std::to_string(mesh.triangles.size()) + " triangles");
}

void require_valid(const ScenePart& part, unsigned threads) {
  geometry::validate(part.mesh, threads);
  if (!part.reflectances.empty()) {
    require_one_each(part.reflectances.size(), "reflectances", part.mesh);
  }
  if (!part.surfaces.empty()) require_one_each(part.surfaces.size(), "surfaces", part.mesh);
}

std::unique_ptr<Scene::Trees> grow_tree(const geometry::Mesh& mesh, unsigned threads) {
  const Device device(threads);
  auto trees = std::make_unique<Scene::Trees>();
  trees->centre = geometry::bounding_box(mesh, threads).center();
  trees->parts.emplace_back(device.handle, mesh, trees->centre, threads);
  trees->target.tree = trees->parts[0].root();
  return trees;
}

struct SceneBuilder::Growth {
  Device device;
  unsigned threads;
  std::unique_ptr<Scene::Trees> trees = std::make_unique<Scene::Trees>();
  std::vector<float> reflectances{};
  std::vector<Eigen::AlignedBox3f> boxes{};  ///< Boxes of all copies.
  std::size_t first_triangle = 0;            ///< First triangle of the next copy.
  std::size_t own_triangle = 0;              ///< First triangle of the next part.
};

SceneBuilder::SceneBuilder(const Vector3d& centre, unsigned threads)
    : growth_(new Growth{Device(threads), threads}) {
  growth_->trees->centre = centre;
}

SceneBuilder::~SceneBuilder() = default;

void SceneBuilder::add(const ScenePart& part) {
  require_valid(part, growth_->threads);
  Scene::Trees& trees = *growth_->trees;
  const Eigen::AlignedBox3d box = geometry::bounding_box(part.mesh, growth_->threads);
  const Vector3d middle = box.center();
  const std::size_t triangles = part.mesh.triangles.size();
  const RayTree& tree =
      trees.parts.emplace_back(growth_->device.handle, part.mesh, middle, growth_->threads);
  for (const Eigen::Isometry3d& pose : copy_poses(part)) {
    const Eigen::Isometry3d scene_from_mesh = Eigen::Translation3d(-trees.centre) * pose;
    growth_->boxes.push_back(moved(box, scene_from_mesh).cast<float>());
    trees.copies.push_back(make_copy(tree.root(), scene_from_mesh * Eigen::Translation3d(middle),
                                     growth_->first_triangle));
    trees.own_triangles.push_back(static_cast<std::uint32_t>(growth_->own_triangle));
    growth_->first_triangle += triangles;
  }
  append_property(part.reflectances, triangles, growth_->own_triangle, Scene::default_reflectance,
                  growth_->reflectances);
  append_property(part.surfaces, triangles, growth_->own_triangle, Surface::matt, trees.surfaces);
  growth_->own_triangle += triangles;
}

Scene SceneBuilder::finish() {
  constexpr std::size_t max = std::numeric_limits<std::uint32_t>::max();
  if (growth_->first_triangle > max) {
    throw Error(ErrorKind::bad_geometry,
                "the scene's copies have " + std::to_string(growth_->first_triangle) +
                    " triangles in total; " + std::to_string(max) + " is the maximum");
  }
  Scene::Trees& trees = *growth_->trees;
  if (!trees.copies.empty()) {
    trees.over_copies.emplace_back(growth_->device.handle, growth_->boxes);
    trees.target = {trees.over_copies.back().root(), trees.copies.data()};
  }
  return {std::move(growth_->trees), std::move(growth_->reflectances)};
}

}  // namespace skycap::sim
