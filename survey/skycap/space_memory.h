/// What is known of space: the depth images of the scans, asked by projection. No voxels, no box.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "survey/skycap/block_image.h"

namespace skycap::survey::skycap {

enum class SpaceState {
  outside,   ///< no scan looked there: outside every image
  hidden,    ///< scans looked, and none saw it: behind what was measured
  measured,  ///< at a measured surface, within the tolerance
  empty,     ///< a scan saw through it
};

/// Whether no scan saw it, whether one looked there or not.
inline bool is_unknown(SpaceState state) {
  return state == SpaceState::outside || state == SpaceState::hidden;
}

/// Grows by one depth image a scan, up to a size: from there on, the image that is most like a
/// newer one is forgotten, so that a survey of any length goes on in bounded memory and time. A
/// query costs one projection for each image, newest first.
class SpaceMemory {
 public:
  /// Hundreds of images with usual blocks; 42 of 2400 x 1750 pixels in the smallest.
  static constexpr std::size_t usual_size = std::size_t{128} << 20;

  /// `tolerance` is how far from its depth a measured surface is taken to reach. With
  /// `misses_are_empty`, a ray without a return proves its way empty as long as its neighbours have
  /// no return either; without it, it proves nothing. `most_bytes` bounds the images; the newest
  /// is always kept.
  SpaceMemory(float tolerance, bool misses_are_empty, std::size_t most_bytes = usual_size)
      : tolerance_(tolerance), misses_are_empty_(misses_are_empty), most_bytes_(most_bytes) {}

  /// `noise` is the measurements' standard deviation along the ray: it does not count as relief.
  void add(const BlockImage& image, float noise);

  /// Compares rays without a return with surface that other scans measured: of `points`, which are
  /// those of earlier calls with new ones behind. Where there is glass, which returns nothing, many
  /// lie on such rays, and nowhere else.
  void compare_misses(std::span<const Eigen::Vector3f> points,
                      std::span<const Eigen::Vector3f> normals);

  /// Whether rays without a return have been found to pass through surface: there is glass.
  bool misses_lie() const { return misses_lie_; }

  /// What the scans say of the point, in this order: empty if one saw through it, measured if one
  /// measured there, hidden if one looked there, outside otherwise. Only images from the number
  /// `first` on are asked; they are counted from zero, forgotten ones too.
  SpaceState query(const Eigen::Vector3f& point, std::size_t first = 0) const;

  /// The same of a surface there that faces `normal`: as long as misses_lie(), a ray without a
  /// return tells nothing of a surface that it would not have struck from the front.
  SpaceState query_surface(const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
                           std::size_t first = 0) const;

  /// Whether the ball is certainly empty: one scan's *returns*, the nearest of each block, all lie
  /// beyond it. Rays without a return prove nothing here, whatever the constructor was told.
  bool is_proven_empty(const Eigen::Vector3f& centre, float radius) const;

  std::size_t image_count() const { return count_; }  ///< that were ever added
  std::size_t bytes() const { return bytes_; }        ///< of the images that are kept

 private:
  struct DepthImage {
    BlockProjection projection;
    std::vector<float> empty_before;    ///< seen through up to here; -infinity: proves nothing
    std::vector<float> measured_until;  ///< measured between `empty_before` and here
    std::vector<float> least;           ///< the nearest return; -infinity without one
    std::size_t number;
    float farthest = 0.0F;   ///< depth of a return
    Eigen::Vector3f middle;  ///< of what it shows, on its axis
    std::size_t twin = 0;    ///< number of the newer one that is most like it
    float unlikeness = std::numeric_limits<float>::infinity();  ///< of the two

    std::size_t bytes() const;
    void compare(const DepthImage& newer);
  };
  void forget_one();
  void count_misses(const DepthImage& image, std::span<const Eigen::Vector3f> points,
                    std::span<const Eigen::Vector3f> normals);
  template <typename Believes>
  SpaceState query(const Eigen::Vector3f& point, std::size_t first, Believes believes_miss) const;
  static bool proves_empty(const DepthImage& image, const Eigen::Vector3f& centre, float radius);

  float tolerance_;
  bool misses_are_empty_;
  std::size_t most_bytes_;
  std::vector<DepthImage> images_;  ///< the newest last
  std::size_t count_ = 0, bytes_ = 0;
  std::size_t compared_images_ = 0, compared_points_ = 0;
  std::size_t points_in_sight_ = 0, points_missed_ = 0;  ///< once for each image that has them
  bool misses_lie_ = false;
};

}  // namespace skycap::survey::skycap
