#include "sim/scene/scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <iterator>
#include <utility>

#include "geometry/error.h"
#include "sim/scene/scene_trees.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;

/// Returns a ray relative to the scene's centre. `direction` is a unit vector.
SingleRay make_ray(const Vector3d& origin, const Vector3d& direction) {
  SingleRay ray = {};
  for (int axis = 0; axis < 3; ++axis) {
    ray.origin[axis] = static_cast<float>(origin[axis]);
    ray.direction[axis] = static_cast<float>(direction[axis]);
  }
  return ray;
}

}  // namespace

Scene::Scene(const geometry::Mesh& mesh, unsigned threads)
    : Scene(std::array{ScenePart{mesh, {}, {}}}, threads) {}

Scene::Scene(const geometry::Mesh& mesh, std::span<const float> reflectances, unsigned threads)
    : Scene(std::array{ScenePart{mesh, reflectances, {}}}, threads) {
  // An empty list is not replaced by the default here.
  require_one_each(reflectances.size(), "reflectances", mesh);
}

Scene::Scene(std::span<const ScenePart> parts, unsigned threads) {
  if (parts.empty()) throw Error(ErrorKind::bad_geometry, "the scene has no meshes");
  for (const ScenePart& part : parts) require_valid(part, threads);
  if (parts.size() == 1 && parts[0].poses.empty()) {
    trees_ = grow_tree(parts[0].mesh, threads);
    reflectances_.assign(parts[0].reflectances.begin(), parts[0].reflectances.end());
    trees_->surfaces.assign(parts[0].surfaces.begin(), parts[0].surfaces.end());
    return;
  }
  SceneBuilder builder(box_around(parts).center(), threads);
  for (const ScenePart& part : parts) builder.add(part);
  *this = builder.finish();
}

Scene::Scene(std::unique_ptr<Trees> trees, std::vector<float> reflectances)
    : trees_(std::move(trees)), reflectances_(std::move(reflectances)) {}

Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

float Scene::own_reflectance(std::uint32_t triangle) const {
  return reflectances_[trees_->own_triangle(triangle)];
}

Surface Scene::surface(std::uint32_t triangle) const { return trees_->surface(triangle); }

std::size_t Scene::Trees::own_triangle(std::uint32_t triangle) const {
  if (copies.empty()) return triangle;
  const auto next =
      std::ranges::upper_bound(copies, triangle, std::less<>(), &SceneCopy::first_triangle);
  const std::ptrdiff_t copy = std::distance(copies.begin(), next) - 1;
  return own_triangles[copy] + (triangle - copies[copy].first_triangle);
}

std::optional<Hit> Scene::first_hit(const Vector3d& origin, const Vector3d& direction,
                                    double max_distance) const {
  const double length = direction.norm();
  SingleRay ray = make_ray(origin - trees_->centre, direction / length);
  ray_kernels().cast_single(trees_->target, ray, static_cast<float>(max_distance * length));
  if (ray.distance < 0.0F) return std::nullopt;
  return Hit{ray.distance / length, ray.triangle,
             Vector3d(ray.normal[0], ray.normal[1], ray.normal[2]).normalized()};
}

bool Scene::is_blocked(const Vector3d& from, const Vector3d& to) const {
  const double length = (to - from).norm();
  if (length == 0.0) return false;
  const SingleRay ray = make_ray(from - trees_->centre, (to - from) / length);
  return ray_kernels().is_blocked(trees_->target, ray, static_cast<float>(length));
}

std::uint32_t Scene::blocked(std::span<const SightLine> sight_lines) const {
  static_assert(max_sight_lines == RayPacket::width);
  RayPacket packet = {};
  std::array<float, max_sight_lines> reach{};
  std::uint32_t left = 0, blocked = 0;
  for (std::size_t i = 0; i < sight_lines.size(); ++i) {
    const auto& [from, to] = sight_lines[i];
    const double length = (to - from).norm();
    if (length == 0.0) continue;
    const SingleRay ray = make_ray(from - trees_->centre, (to - from) / length);
    for (int axis = 0; axis < 3; ++axis) {
      packet.origin[axis][i] = ray.origin[axis];
      packet.direction[axis][i] = ray.direction[axis];
    }
    reach[i] = static_cast<float>(length);
    left |= 1U << i;
  }
  while (left != 0) {  // A packet has a single reach.
    const float its_reach = reach[static_cast<std::size_t>(std::countr_zero(left))];
    std::uint32_t lanes = 0;
    for (std::size_t i = 0; i < sight_lines.size(); ++i) {
      if (reach[i] == its_reach) lanes |= left & 1U << i;
    }
    blocked |= ray_kernels().blocked(trees_->target, packet, lanes, its_reach);
    left &= ~lanes;
  }
  return blocked;
}

}  // namespace skycap::sim
