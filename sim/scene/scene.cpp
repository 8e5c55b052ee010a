#include "sim/scene/scene.h"

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <string>

#include "geometry/error.h"
#include "sim/scene/scene_trees.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;

/// A ray around the scene's centre; `direction` is a unit vector.
SingleRay make_ray(const Vector3d& origin, const Vector3d& direction) {
  SingleRay ray = {};
  for (int axis = 0; axis < 3; ++axis) {
    ray.origin[axis] = static_cast<float>(origin[axis]);
    ray.direction[axis] = static_cast<float>(direction[axis]);
  }
  return ray;
}

void require_one_each(std::span<const float> reflectances, const geometry::Mesh& mesh) {
  if (reflectances.size() == mesh.triangles.size()) return;
  throw Error(ErrorKind::bad_geometry, "there are " + std::to_string(reflectances.size()) +
                                           " reflectances for " +
                                           std::to_string(mesh.triangles.size()) + " triangles");
}

}  // namespace

Scene::Scene(const geometry::Mesh& mesh, unsigned threads)
    : Scene(std::array{ScenePart{mesh, {}, {}}}, threads) {}

Scene::Scene(const geometry::Mesh& mesh, std::span<const float> reflectances, unsigned threads)
    : Scene(std::array{ScenePart{mesh, reflectances, {}}}, threads) {
  require_one_each(reflectances, mesh);
}

Scene::Scene(std::span<const ScenePart> parts, unsigned threads) {
  if (parts.empty()) throw Error(ErrorKind::bad_geometry, "the scene has no meshes");
  for (const ScenePart& part : parts) {
    geometry::validate(part.mesh);
    if (!part.reflectances.empty()) require_one_each(part.reflectances, part.mesh);
  }
  trees_ = grow_trees(parts, threads);
  if (std::ranges::all_of(parts, [](const auto& part) { return part.reflectances.empty(); })) {
    return;
  }
  for (const ScenePart& part : parts) {
    reflectances_.insert(reflectances_.end(), part.reflectances.begin(), part.reflectances.end());
    const std::size_t defaults = part.mesh.triangles.size() - part.reflectances.size();
    reflectances_.insert(reflectances_.end(), defaults, default_reflectance);
  }
}

Scene::Scene(Scene&&) noexcept = default;
Scene& Scene::operator=(Scene&&) noexcept = default;
Scene::~Scene() = default;

std::size_t Scene::own_triangle(std::uint32_t triangle) const {
  const std::vector<SceneCopy>& copies = trees_->copies;
  if (copies.empty()) return triangle;
  const auto next =
      std::ranges::upper_bound(copies, triangle, std::less<>(), &SceneCopy::first_triangle);
  const std::ptrdiff_t copy = std::distance(copies.begin(), next) - 1;
  return trees_->own_triangles[copy] + (triangle - copies[copy].first_triangle);
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

}  // namespace skycap::sim
