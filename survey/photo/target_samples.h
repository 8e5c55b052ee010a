/// Samples of the target's surface for the selection of photos and the evaluation of plans.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"
#include "geometry/surfaces/sight_lines.h"

namespace skycap::survey::photo {

/// Returns z of the ground at a horizontal position in the mission frame [m]. Must be thread-safe.
using GroundHeight = std::function<double(const Eigen::Vector2d&)>;

struct SampleOptions {
  std::size_t count = 8000;   ///< Samples of the whole surface, including inner surface.
  std::uint64_t seed = 1;     ///< Sets with different seeds are independent.
  double free_length = 1.0;   ///< Length over which a free direction must be unobstructed [m].
  double min_standoff = 0.0;  ///< Distance beyond which a free direction may meet the ground [m].
  GroundHeight ground;        ///< Null: no ground.
  unsigned threads = 1;       ///< Zero: all processors. Does not affect the samples.
};

/// Area-uniform, stratified samples of exposed surface in random order, as a structure of arrays.
struct TargetSamples {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f>
      normals;  ///< Unit normals, towards the side with more free directions.
  std::vector<std::uint32_t> triangles;  ///< Triangle of the target at each sample.
  double area_each = 0.0;                ///< Area that each sample represents [m^2].
  std::size_t inner = 0;                 ///< Number of skipped samples on inner surface.
  std::size_t size() const { return points.size(); }
  double area() const { return area_each * static_cast<double>(size()); }
  double inner_area() const { return area_each * static_cast<double>(inner); }
};

/// Samples the surface of `target`. A sample is exposed if at least 10% of 64 directions in the
/// hemisphere above one of its sides are free of `obstructions`, which must include the target.
/// Surface below the ground is inner surface.
TargetSamples sample_target(const geometry::Mesh& target, const geometry::SightLines& obstructions,
                            const SampleOptions& options);

}  // namespace skycap::survey::photo
