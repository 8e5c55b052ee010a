#include "sim/scene/surface_effects.h"

#include <algorithm>
#include <array>

#include <Eigen/Core>

namespace skycap::sim {
namespace {

using Eigen::Vector3f;

constexpr int max_mirrors = 8;

Vector3f mirrored(const Vector3f& direction, const Vector3f& normal) {
  return direction - 2.0F * direction.dot(normal) * normal;
}

/// Emitted ray with its hit.
class Ray {
 public:
  Ray(const RayPacket& packet, int lane) : lane_(lane) {
    for (int axis = 0; axis < 3; ++axis) {
      ray_.origin[axis] = packet.origin[axis][lane];
      ray_.direction[axis] = packet.direction[axis][lane];
      ray_.normal[axis] = packet.normal[axis][lane];
    }
    ray_.distance = packet.distance[lane];
    ray_.triangle = packet.triangle[lane];
  }

  /// Continues from each mirror until a different surface is hit.
  void follow(const Scene::Trees& trees, float reach) {
    float ray_length = 0.0F;
    while (ray_.distance >= 0.0F) {
      const Surface met = trees.surface(ray_.triangle);
      if (met == Surface::matt) {
        ray_.distance += ray_length;
        return unmirror();
      }
      ray_length += ray_.distance;
      if (met == Surface::glass || mirrors_ == max_mirrors || ray_length >= reach) break;
      bounce();
      ray_kernels().cast_single(trees.target, ray_, reach - ray_length);
    }
    ray_.distance = -1.0F;
  }

  void store(RayPacket& packet) const {
    packet.distance[lane_] = ray_.distance;
    packet.triangle[lane_] = ray_.triangle;
    for (int axis = 0; axis < 3; ++axis) packet.normal[axis][lane_] = ray_.normal[axis];
  }

 private:
  void bounce() {
    Eigen::Map<Vector3f> origin(ray_.origin), direction(ray_.direction);
    Vector3f normal = Vector3f(ray_.normal[0], ray_.normal[1], ray_.normal[2]).normalized();
    if (normal.dot(direction) > 0.0F) normal = -normal;
    const Vector3f position = origin + ray_.distance * direction;
    // Displaced from the mirror by the rounding error of the position.
    origin = position + 1e-5F * (1.0F + position.cwiseAbs().maxCoeff()) * normal;
    direction = mirrored(direction, normal);
    normals_[mirrors_++] = normal;
  }

  void unmirror() {
    Vector3f normal(ray_.normal[0], ray_.normal[1], ray_.normal[2]);
    while (mirrors_ > 0) normal = mirrored(normal, normals_[--mirrors_]);
    for (int axis = 0; axis < 3; ++axis) ray_.normal[axis] = normal[axis];
  }

  SingleRay ray_ = {};
  std::array<Vector3f, max_mirrors> normals_;
  int mirrors_ = 0;
  int lane_;
};

}  // namespace

void cast_at_surfaces(const Scene::Trees& trees, RayPacket& packet, std::uint32_t lanes,
                      float reach) {
  ray_kernels().cast(trees.target, packet, lanes, reach);
  for (int lane = 0; lane < RayPacket::width; ++lane) {
    if (packet.distance[lane] < 0.0F || trees.surface(packet.triangle[lane]) == Surface::matt) {
      continue;
    }
    Ray ray(packet, lane);
    ray.follow(trees, reach);
    ray.store(packet);
  }
}

}  // namespace skycap::sim
