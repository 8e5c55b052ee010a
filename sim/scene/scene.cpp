#include "sim/scene/scene.h"

#include <algorithm>
#include <array>
#include <bit>
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

void require_one_each(std::size_t count, const char* what, const geometry::Mesh& mesh) {
  if (count == mesh.triangles.size()) return;
  throw Error(ErrorKind::bad_geometry, "there are " + std::to_string(count) + " " + what + " for " +
                                           std::to_string(mesh.triangles.size()) + " triangles");
}

// The properties of all parts' triangles, in their order; none if all are the default.
template <typename Property>
std::vector<Property> joined(std::span<const ScenePart> parts,
                             std::span<const Property> ScenePart::*own, Property usual) {
  const auto has_none = [&](const ScenePart& part) { return (part.*own).empty(); };
  if (std::ranges::all_of(parts, has_none)) return {};
  std::vector<Property> all;
  for (const ScenePart& part : parts) {
    all.insert(all.end(), (part.*own).begin(), (part.*own).end());
    all.insert(all.end(), part.mesh.triangles.size() - (part.*own).size(), usual);
  }
  return all;
}

}  // namespace

Scene::Scene(const geometry::Mesh& mesh, unsigned threads)
    : Scene(std::array{ScenePart{mesh, {}, {}}}, threads) {}

Scene::Scene(const geometry::Mesh& mesh, std::span<const float> reflectances, unsigned threads)
    : Scene(std::array{ScenePart{mesh, reflectances, {}}}, threads) {
  require_one_each(reflectances.size(), "reflectances", mesh);
}

Scene::Scene(std::span<const ScenePart> parts, unsigned threads) {
  if (parts.empty()) throw Error(ErrorKind::bad_geometry, "the scene has no meshes");
  for (const ScenePart& part : parts) {
    geometry::validate(part.mesh);
    if (!part.reflectances.empty()) {
      require_one_each(part.reflectances.size(), "reflectances", part.mesh);
    }
    if (!part.surfaces.empty()) require_one_each(part.surfaces.size(), "surfaces", part.mesh);
  }
  trees_ = grow_trees(parts, threads);
  reflectances_ = joined(parts, &ScenePart::reflectances, default_reflectance);
  trees_->surfaces = joined(parts, &ScenePart::surfaces, Surface::matt);
}

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

std::uint32_t Scene::blocked(std::span<const Sight> sights) const {
  static_assert(most_sights == RayPacket::width);
  RayPacket packet = {};
  std::array<float, most_sights> reach{};
  std::uint32_t left = 0, blocked = 0;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const auto& [from, to] = sights[i];
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
  while (left != 0) {  // a packet has one reach
    const float its_reach = reach[static_cast<std::size_t>(std::countr_zero(left))];
    std::uint32_t lanes = 0;
    for (std::size_t i = 0; i < sights.size(); ++i) {
      if (reach[i] == its_reach) lanes |= left & 1U << i;
    }
    blocked |= ray_kernels().blocked(trees_->target, packet, lanes, its_reach);
    left &= ~lanes;
  }
  return blocked;
}

}  // namespace skycap::sim
