/// What is known of space: the depth images of all scans, asked by projection. No voxels, no box.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "survey/skycap/block_image.h"

namespace skycap::survey::skycap {

enum class SpaceState {
  unknown,   ///< no scan saw it: outside every image, or behind what was measured
  measured,  ///< at a measured surface, within the tolerance
  empty,     ///< a scan saw through it
};

/// Grows by one depth image a scan. A query costs one projection for each image, newest first.
class SpaceMemory {
 public:
  /// `tolerance` is how far from its depth a measured surface is taken to reach. With
  /// `misses_are_empty`, a ray without a return proves its way empty as long as its neighbours have
  /// no return either; without it, it proves nothing.
  SpaceMemory(float tolerance, bool misses_are_empty)
      : tolerance_(tolerance), misses_are_empty_(misses_are_empty) {}

  /// `noise` is the measurements' standard deviation along the ray: it does not count as relief.
  void add(const BlockImage& image, float noise);

  /// What the scans say of the point, in this order: empty if one saw through it, measured if one
  /// measured there, unknown otherwise. Only images from the number `first` on are asked.
  SpaceState query(const Eigen::Vector3f& point, std::size_t first = 0) const;

  /// Whether the ball is certainly empty: one scan's *returns*, the nearest of each block, all lie
  /// beyond it. Rays without a return prove nothing here, whatever the constructor was told.
  bool is_proven_empty(const Eigen::Vector3f& centre, float radius) const;

  std::size_t image_count() const { return images_.size(); }

 private:
  struct DepthImage {
    BlockProjection projection;
    std::vector<float> empty_before;    ///< seen through up to here; -infinity: proves nothing
    std::vector<float> measured_until;  ///< measured between `empty_before` and here
    std::vector<float> least;           ///< the nearest return; -infinity without one
  };
  static bool proves_empty(const DepthImage& image, const Eigen::Vector3f& centre, float radius);

  float tolerance_;
  bool misses_are_empty_;
  std::vector<DepthImage> images_;
};

}  // namespace skycap::survey::skycap
