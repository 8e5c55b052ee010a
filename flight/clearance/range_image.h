/// Min/max depth pyramid of one scan, for conservative queries over pixel patches.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/clearance/measured_space.h"
#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"

namespace skycap::flight {

/// Visibility of a ball from the sensor.
enum class BallVisibility {
  free,     ///< Entirely in front of all measurements in its direction.
  hidden,   ///< Entirely outside the view, or behind all measurements in its direction.
  partial,  ///< All other cases.
};

/// Minimum and maximum depths of pixel patches, stored as an image pyramid.
class RangeImage {
 public:
  /// Constructs a pinhole image with depth along the optical axis [m]. Pixels without a point have
  /// `depth_without_return`. Uses `threads` threads (0: all processors).
  RangeImage(const geometry::Scan& scan, const geometry::Camera& camera,
             double depth_without_return, double max_depth, unsigned threads);

  /// Constructs an image of azimuth and elevation around the rotation axis, with the range as depth
  /// [m]. Cells are as wide as the ray spacing. Cells without a point have depth 0.
  RangeImage(const geometry::Scan& scan, const SweepRays& rays, double max_depth, unsigned threads);

  /// Returns the visibility of a ball (world coordinates) [m]. `margin` is the required free
  /// distance in front of measurements [m].
  BallVisibility visibility(const Eigen::Vector3d& centre_in_world, double radius,
                            double margin) const;

  /// Returns the maximum depth in the image [m].
  double farthest() const { return levels_.back().max().front(); }

  /// Returns a box around all space that the image can prove free.
  Eigen::AlignedBox3d reach() const;

 private:
  struct Patch {  ///< Pixel bounds, both inclusive. May extend beyond the image.
    double left, right, top, bottom;
    double nearest, farthest;  ///< Depth interval of the ball [m].
  };
  struct Depths {
    float min, max;
  };
  struct Level {
    int width, height;
    /// Pyramid data. Empty `max_depths` means that they equal `min_depths`.
    std::vector<float> min_depths, max_depths;

    const std::vector<float>& min() const { return min_depths; }
    const std::vector<float>& max() const { return max_depths.empty() ? min_depths : max_depths; }
    Level halved(unsigned threads) const;
  };

  std::optional<Patch> pinhole_patch(const Eigen::Vector3d& centre, double radius) const;
  std::optional<Patch> spherical_patch(const Eigen::Vector3d& centre, double radius) const;
  void build_pyramid(std::vector<float> depths, unsigned threads);
  Depths over(int left, int right, int top, int bottom) const;
  Depths over_wrapped(const Patch& patch) const;

  Eigen::Isometry3d sensor_from_world_;  ///< For a spherical image, y is along the rotation axis.
  double origin_spread_ = 0.0;
  std::optional<geometry::Camera> camera_;  ///< Empty: spherical image.
  double pixels_per_radian_ = 0.0;
  int width_ = 0, height_ = 0;
  std::vector<Level> levels_;
};

}  // namespace skycap::flight
