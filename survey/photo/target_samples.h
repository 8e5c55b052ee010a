/// Samples of the target's surface, on which photos are chosen and plans are evaluated.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"
#include "geometry/surfaces/sight_lines.h"

namespace skycap::survey::photo {

/// z of the ground below a position of the mission frame; safe to call from several threads.
using GroundHeight = std::function<double(const Eigen::Vector2d&)>;

struct SampleOptions {
  std::size_t count = 8000;   ///< of the whole surface, inner surface included
  std::uint64_t seed = 1;     ///< sets of different seeds are independent
  double free_length = 1.0;   ///< a direction is free if nothing obstructs it so far [m]
  double min_standoff = 0.0;  ///< a free direction may meet the ground from here on [m]
  GroundHeight ground;        ///< null: no ground
  unsigned threads = 1;       ///< zero: all processors; does not change the samples
};

/// Area-uniform, stratified samples of exposed surface in random order. Structure of arrays.
struct TargetSamples {
  std::vector<Eigen::Vector3f> points;
  std::vector<Eigen::Vector3f> normals;  ///< unit, towards the side with more free directions
  std::vector<std::uint32_t> triangles;  ///< of the target
  double area_each = 0.0;                ///< surface that a sample stands for [m^2]
  std::size_t inner = 0;                 ///< samples of inner surface, which are skipped
  std::size_t size() const { return points.size(); }
  double area() const { return area_each * static_cast<double>(size()); }
  double inner_area() const { return area_each * static_cast<double>(inner); }
};

/// Samples `target`. A sample is exposed if at least 10% of 64 directions of the hemisphere over
/// one of its sides are free of `obstructions`, which include the target. Surface below the ground
/// is inner surface.
TargetSamples sample_target(const geometry::Mesh& target, const geometry::SightLines& obstructions,
                            const SampleOptions& options);

}  // namespace skycap::survey::photo
