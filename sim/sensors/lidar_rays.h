/// Rays of a block of firings: poses of the moving sensor, rays by slot, and their hits. Internal
/// to lidar.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include <Eigen/Geometry>

#include "sim/scene/four_lanes.h"
#include "sim/scene/scene_trees.h"
#include "sim/scene/surface_effects.h"
#include "sim/sensors/scan_pattern.h"
#include "sim/sensors/trajectory.h"

namespace skycap::sim {

inline constexpr std::uint32_t firings_in_block = ScanPattern::firings_in_block;

/// world_from_sensor at the start of each firing of a block and of the next one, relative to a
/// fixed origin. Entries are the nine elements of the rotation, row by row, and the position. Four
/// firings are adjacent, like their rays.
struct BlockPoses {
  float entries[12][firings_in_block + 4];
};

/// Poses of four consecutive firings.
struct FourPoses {
  FourFloats entries[12];

  FourPoses(const BlockPoses& poses, std::uint32_t firing) {
    for (int i = 0; i < 12; ++i) {
      std::memcpy(&entries[i], &poses.entries[i][firing], sizeof entries[i]);
    }
  }
  void rotate(const FourFloats (&vector)[3], FourFloats (&rotated)[3]) const {
    for (int row = 0; row < 3; ++row) {
      rotated[row] = entries[3 * row] * vector[0] + entries[3 * row + 1] * vector[1] +
                     entries[3 * row + 2] * vector[2];
    }
  }
  void shift(FourFloats (&vector)[3]) const {
    for (int row = 0; row < 3; ++row) vector[row] += entries[9 + row];
  }
};

/// Returns the poses for a channel that fires with a delay, as a fraction of the firing period.
inline FourPoses delayed(FourPoses poses, const FourPoses& next, float share) {
  for (int i = 0; i < 12; ++i) {
    poses.entries[i] += share * (next.entries[i] - poses.entries[i]);
  }
  return poses;
}

inline BlockPoses block_poses(const Trajectory& trajectory,
                              const Eigen::Isometry3d& body_from_sensor, double start,
                              double firing_period, const Eigen::Vector3d& origin) {
  constexpr int firings = firings_in_block;
  constexpr double pose_spacing = 1e-4;  // Sampling interval of the trajectory [s].
  const double duration = firing_period * firings;
  const int spans = std::clamp(static_cast<int>(std::ceil(duration / pose_spacing)), 1, firings);
  float knots[firings + 1][12];
  for (int i = 0; i <= spans; ++i) {
    const Eigen::Isometry3d pose = trajectory.pose(start + duration * i / spans) * body_from_sensor;
    for (int entry = 0; entry < 9; ++entry) {
      knots[i][entry] = static_cast<float>(pose.linear()(entry / 3, entry % 3));
    }
    for (int axis = 0; axis < 3; ++axis) {
      knots[i][9 + axis] = static_cast<float>(pose.translation()[axis] - origin[axis]);
    }
  }
  BlockPoses poses = {};
  for (int firing = 0; firing <= firings; ++firing) {
    const int knot = std::min(firing * spans / firings, spans - 1);
    const float share =
        static_cast<float>(firing * spans) / static_cast<float>(firings) - static_cast<float>(knot);
    for (int entry = 0; entry < 12; ++entry) {
      poses.entries[entry][firing] =
          knots[knot][entry] + share * (knots[knot + 1][entry] - knots[knot][entry]);
    }
  }
  return poses;
}

/// Directions across a beam, along azimuth and elevation. `up` is the sensor's z axis.
struct AcrossBeam {
  Eigen::Vector3f horizontal, vertical;
};
inline AcrossBeam across(const Eigen::Vector3f& direction, const Eigen::Vector3f& up) {
  const Eigen::Vector3f sideways = up.cross(direction);
  const float length = sideways.norm();
  const Eigen::Vector3f horizontal =
      length > 1e-6F ? Eigen::Vector3f(sideways / length) : direction.unitOrthogonal();
  return {horizontal, direction.cross(horizontal)};
}

/// Rays relative to the centre of the scene's trees, by slot.
struct Rays {
  std::vector<float> origin[3], direction[3];

  void resize(std::size_t rays) {
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis].resize(rays);
      direction[axis].resize(rays);
    }
  }
  Eigen::Vector3f from(std::size_t ray) const {
    return {origin[0][ray], origin[1][ray], origin[2][ray]};
  }
  Eigen::Vector3f towards(std::size_t ray) const {
    return {direction[0][ray], direction[1][ray], direction[2][ray]};
  }
  Eigen::Vector3f at(std::size_t ray, float range) const {
    return from(ray) + range * towards(ray);
  }
  void set_direction(std::size_t ray, const Eigen::Vector3f& towards) {
    for (int axis = 0; axis < 3; ++axis) direction[axis][ray] = towards[axis];
  }
};

/// Hits of rays.
struct Hits {
  std::vector<int> active;    // Non-zero: cast the ray.
  std::vector<float> range;   // Range [m]. Negative: no hit.
  std::vector<float> cosine;  // Cosine of the angle of incidence, at most 1.
  std::vector<std::uint32_t> triangle;

  void resize(std::size_t rays) {
    active.resize(rays);
    range.resize(rays);
    cosine.resize(rays);
    triangle.resize(rays);
  }
};

/// Casts the active rays. The other rays get negative ranges. The number of rays must be a multiple
/// of the packet width.
inline void cast_rays(const Scene::Trees& trees, float reach, const Rays& rays, Hits& hits) {
  constexpr int width = RayPacket::width;
  const RayKernels& kernels = ray_kernels();
  RayPacket packet;
  for (std::size_t first = 0; first < hits.active.size(); first += width) {
    std::uint32_t lanes = 0;
    for (int lane = 0; lane < width; ++lane) {
      lanes |= (hits.active[first + lane] != 0 ? 1U : 0U) << lane;
    }
    if (lanes == 0) {
      std::fill_n(hits.range.data() + first, width, -1.0F);
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) {
      std::copy_n(rays.origin[axis].data() + first, width, packet.origin[axis]);
      std::copy_n(rays.direction[axis].data() + first, width, packet.direction[axis]);
    }
    if (trees.surfaces.empty()) {
      kernels.cast(trees.target, packet, lanes, reach);
    } else {
      cast_at_surfaces(trees, packet, lanes, reach);
    }
    std::copy_n(packet.triangle, width, hits.triangle.data() + first);
    std::copy_n(packet.distance, width, hits.range.data() + first);
    for (int lane = 0; lane < width; lane += 4) {
      const auto load_lanes = [&](const float* values) { return four<FourFloats>(values + lane); };
      FourFloats along = {}, squared = {};
      for (int axis = 0; axis < 3; ++axis) {
        const FourFloats normal = load_lanes(packet.normal[axis]);
        along += load_lanes(packet.direction[axis]) * normal;
        squared += normal * normal;
      }
      const FourFloats cosine = (along < 0.0F ? -along : along) / square_root(squared);
      const FourFloats one = FourFloats{} + 1.0F;
      put_four(hits.cosine.data() + first + lane, cosine < one ? cosine : one);
    }
  }
}

}  // namespace skycap::sim
