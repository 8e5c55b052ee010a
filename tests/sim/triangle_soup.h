/// Random triangles and single rays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <random>

#include <Eigen/Core>
#include <embree3/rtcore.h>

#include "geometry/surfaces/mesh.h"
#include "sim/scene/ray_kernels.h"
#include "sim/scene/ray_tree.h"

namespace skycap::sim {

inline constexpr float infinity = std::numeric_limits<float>::infinity();

inline RTCDevice device() {
  struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
  };
  static const std::unique_ptr<RTCDeviceTy, Release> only(rtcNewDevice("threads=1"));
  return only.get();
}

/// Triangles with unchanged coordinates.
class Triangles {
 public:
  explicit Triangles(const geometry::Mesh& mesh)
      : tree_(device(), mesh, Eigen::Vector3d::Zero(), 1) {}
  RayTarget target() const { return {tree_.root()}; }

 private:
  RayTree tree_;
};

inline SingleRay ray(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) {
  SingleRay made = {};
  for (int axis = 0; axis < 3; ++axis) {
    made.origin[axis] = origin[axis];
    made.direction[axis] = direction[axis];
  }
  return made;
}

inline SingleRay cast(const Triangles& triangles, SingleRay ray, float reach = infinity) {
  ray_kernels().cast_single(triangles.target(), ray, reach);
  return ray;
}

inline Eigen::Vector3f random_point(std::mt19937_64& random, float size) {
  std::uniform_real_distribution<float> coordinate(-size, size);
  const float x = coordinate(random), y = coordinate(random), z = coordinate(random);
  return {x, y, z};
}

/// Returns triangles of all kinds: large, small, thin, axis-parallel, and duplicates. The first one
/// is never hit. With it, a scene with any other triangle has the extent of the whole soup.
inline geometry::Mesh random_soup(std::mt19937_64& random, std::size_t count) {
  geometry::Mesh mesh{{{12, 12, 12}}, {{0, 0, 0}}};
  std::uniform_int_distribution<int> kind(0, 4);
  while (mesh.triangles.size() < count) {
    const int what = kind(random);
    const Eigen::Vector3f a = random_point(random, 4.0F);
    Eigen::Vector3f b = a + random_point(random, what == 0 ? 6.0F : 0.5F);
    Eigen::Vector3f c = a + random_point(random, what == 0 ? 6.0F : 0.5F);
    if (what == 1) c = a + 0.7F * (b - a) + random_point(random, 1e-6F);  // nearly degenerate
    if (what == 2) b.z() = c.z() = a.z();
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const Eigen::Vector3f& corner : {a, b, c})
      mesh.vertices.emplace_back(corner.cast<double>());
    mesh.triangles.push_back({first, first + 1, first + 2});
    if (what == 3) mesh.triangles.push_back({first + 1, first, first + 2});
  }
  return mesh;
}

}  // namespace skycap::sim
