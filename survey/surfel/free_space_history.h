/// Free-space memory: depth images of the scans, queried by projection. It needs no voxels and no
/// bounding box.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "survey/surfel/block_image.h"

namespace skycap::survey::surfel {

enum class SpaceState {
  outside,   ///< outside all images, or beyond the range of the sensor
  hidden,    ///< inside an image, but behind the measured surface in all of them
  measured,  ///< on a measured surface, within the tolerance
  empty,     ///< at least one scan saw through it
};

/// Returns whether the position is unobserved, inside or outside the images.
inline bool is_unknown(SpaceState state) {
  return state == SpaceState::outside || state == SpaceState::hidden;
}

/// Distances at which a surface returns: along the optical axis of a pinhole image, along the ray
/// for a scan on cube faces [m].
struct MeasurableRange {
  float min = 0.0F, max = std::numeric_limits<float>::infinity();

  bool contains(float distance) const { return min <= distance && distance <= max; }
};

/// Stores one depth image per scan up to `max_bytes`. Beyond that, evicts the image most similar
/// to a newer one, so that memory and query time are bounded for surveys of any length. A query
/// needs one projection per image, newest first.
class FreeSpaceHistory {
 public:
  /// Default memory limit [bytes]. Sufficient for hundreds of images with typical blocks, or for 42
  /// images of 2400 x 1750 pixels with the smallest blocks.
  static constexpr std::size_t usual_size = std::size_t{128} << 20;

  /// `tolerance` is the depth range of a measured surface [m]. With `misses_are_empty`, a ray
  /// without a return proves free space within `range` if its neighbours have no return either;
  /// otherwise it proves nothing. `max_bytes` limits the size of the images; the newest image is
  /// always kept.
  FreeSpaceHistory(float tolerance, bool misses_are_empty, MeasurableRange range = {},
                   std::size_t max_bytes = usual_size)
      : tolerance_(tolerance),
        misses_are_empty_(misses_are_empty),
        range_(range),
        max_bytes_(max_bytes) {}

  /// Adds the image of a scan. `noise` is the standard deviation along the ray [m], which is not
  /// treated as relief.
  void add(const BlockImage& image, float noise);

  /// Compares rays without a return with surface measured by other scans. `points` must extend
  /// those of earlier calls. Only glass, which returns nothing, causes many surface points on such
  /// rays.
  void compare_misses(std::span<const Eigen::Vector3f> points,
                      std::span<const Eigen::Vector3f> normals);

  /// Returns whether rays without a return pass through measured surface, which indicates glass.
  bool has_false_misses() const { return has_false_misses_; }

  /// Returns the state of a point. The first applicable state is returned: empty if a scan saw
  /// through it, measured, hidden if a scan looked there, otherwise outside. Only images with
  /// number >= `first` are queried; numbers are zero-based and include evicted images.
  SpaceState query(const Eigen::Vector3f& point, std::size_t first = 0) const;

  /// Returns the state of a surface at `point` with the normal `normal`. While has_false_misses(),
  /// rays without a return are ignored unless they would hit the front of the surface.
  SpaceState query_surface(const Eigen::Vector3f& point, const Eigen::Vector3f& normal,
                           std::size_t first = 0) const;

  /// Returns whether the ball is certainly empty: the nearest *returns* of all blocks of one scan
  /// are behind it. Rays without a return never prove this, even with `misses_are_empty`.
  bool is_verified_empty(const Eigen::Vector3f& centre, float radius) const;

  /// Returns whether several scans together verify that the ball is empty: each of the smaller
  /// balls that cover it satisfies is_verified_empty(). Slower than is_verified_empty(), which
  /// implies it.
  bool is_jointly_verified_empty(const Eigen::Vector3f& centre, float radius) const;

  std::size_t image_count() const { return count_; }  ///< number of images added so far
  std::size_t bytes() const { return bytes_; }        ///< size of the stored images [bytes]

 private:
  struct DepthImage {
    BlockProjection projection;
    std::vector<float> empty_before;    ///< free up to this depth; -infinity: unknown
    std::vector<float> measured_until;  ///< measured between `empty_before` and this depth
    std::vector<float> min;             ///< minimum depth of a return; -infinity without returns
    std::size_t number;
    float farthest = 0.0F;          ///< maximum depth of a return [m]
    Eigen::Vector3f middle;         ///< centre of the imaged volume, on the optical axis
    bool has_radial_range;          ///< as in BlockImage
    std::size_t closest_newer = 0;  ///< number of the most similar newer image
    float unlikeness = std::numeric_limits<float>::infinity();  ///< dissimilarity of the two images

    std::size_t bytes() const;
    void compare(const DepthImage& newer);
  };
  void forget_one();
  void count_misses(const DepthImage& image, std::span<const Eigen::Vector3f> points,
                    std::span<const Eigen::Vector3f> normals);
  template <typename IsMissTrusted>
  SpaceState query(const Eigen::Vector3f& point, std::size_t first,
                   IsMissTrusted is_miss_trusted) const;
  /// Returns whether the sensor would have measured a surface at this position.
  bool is_in_range(const DepthImage& image, const Eigen::Vector3f& point, float depth) const;
  static bool shows_empty(const DepthImage& image, const Eigen::Vector3f& centre, float radius);
  struct Ball {
    Eigen::Vector3f centre;
    float radius;
  };
  /// Returns whether the part of the cube inside the ball is verified. The cube is divided up to
  /// `divisions` times.
  bool is_cube_verified(const Eigen::Vector3f& centre, float half_edge, const Ball& ball,
                        int divisions) const;

  float tolerance_;
  bool misses_are_empty_;
  MeasurableRange range_;
  std::size_t max_bytes_;
  std::vector<DepthImage> images_;  ///< newest last
  std::size_t count_ = 0, bytes_ = 0;
  std::size_t compared_images_ = 0, compared_points_ = 0;
  std::size_t visible_points_ = 0,
              points_missed_ = 0;  ///< counted once per image that contains them
  bool has_false_misses_ = false;
};

}  // namespace skycap::survey::surfel
