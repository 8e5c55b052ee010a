#include "sim/scene/scene_trees.h"

#include <limits>
#include <string>

#include <embree3/rtcore.h>

#include "geometry/error.h"
#include "geometry/parallel.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;

std::vector<Eigen::Isometry3d> places_of(const ScenePart& part) {
  if (part.places.empty()) return {Eigen::Isometry3d::Identity()};
  return {part.places.begin(), part.places.end()};
}

/// An error of Embree's goes with its device.
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

Eigen::AlignedBox3d moved(const Eigen::AlignedBox3d& box, const Eigen::Isometry3d& place) {
  Eigen::AlignedBox3d all;
  for (int corner = 0; corner < 8; ++corner) {
    all.extend(place * box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)));
  }
  return all;
}

/// A box around all copies of all parts.
Eigen::AlignedBox3d box_around(std::span<const ScenePart> parts) {
  Eigen::AlignedBox3d all;
  for (const ScenePart& part : parts) {
    const Eigen::AlignedBox3d box = geometry::bounding_box(part.mesh);
    for (const Eigen::Isometry3d& place : places_of(part)) all.extend(moved(box, place));
  }
  return all;
}

/// A tree of each part, and one over the boxes of their copies.
void grow_trees_of_copies(RTCDevice device, std::span<const ScenePart> parts, unsigned threads,
                          Scene::Trees& trees) {
  std::vector<Eigen::AlignedBox3f> boxes;
  std::size_t first_triangle = 0, own_triangle = 0;
  for (const ScenePart& part : parts) {
    const Eigen::AlignedBox3d box = geometry::bounding_box(part.mesh);
    const Vector3d middle = box.center();
    const RayTree& tree = trees.parts.emplace_back(device, part.mesh, middle, threads);
    for (const Eigen::Isometry3d& place : places_of(part)) {
      const Eigen::Isometry3d scene_from_mesh = Eigen::Translation3d(-trees.centre) * place;
      boxes.push_back(moved(box, scene_from_mesh).cast<float>());
      trees.copies.push_back(
          make_copy(tree.root(), scene_from_mesh * Eigen::Translation3d(middle), first_triangle));
      trees.own_triangles.push_back(static_cast<std::uint32_t>(own_triangle));
      first_triangle += part.mesh.triangles.size();
    }
    own_triangle += part.mesh.triangles.size();
  }
  constexpr std::size_t most = std::numeric_limits<std::uint32_t>::max();
  if (first_triangle > most) {
    throw Error(ErrorKind::bad_geometry,
                "the scene's copies have " + std::to_string(first_triangle) +
                    " triangles in all; " + std::to_string(most) + " can be numbered");
  }
  trees.over_copies.emplace_back(device, boxes);
  trees.target = {trees.over_copies.back().root(), trees.copies.data()};
}

}  // namespace

std::unique_ptr<Scene::Trees> grow_trees(std::span<const ScenePart> parts, unsigned threads) {
  const Device device(threads);
  auto trees = std::make_unique<Scene::Trees>();
  trees->centre = box_around(parts).center();
  if (parts.size() == 1 && parts[0].places.empty()) {
    trees->parts.emplace_back(device.handle, parts[0].mesh, trees->centre, threads);
    trees->target.tree = trees->parts[0].root();
  } else {
    grow_trees_of_copies(device.handle, parts, threads, *trees);
  }
  return trees;
}

}  // namespace skycap::sim
