/// The depths that a sensor measured from one place, prepared to be asked over a patch of pixels at
/// a time.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/space/measured_space.h"
#include "geometry/place/camera.h"
#include "geometry/points/scan.h"

namespace skycap::flight {

/// What an image says about a ball in front of the sensor.
enum class BallSight {
  free,     ///< wholly in front of everything measured in its direction
  hidden,   ///< wholly out of view, or behind everything measured in its direction
  partial,  ///< anything else
};

/// Least and greatest depth over patches of pixels, in a pyramid of halved images.
class RangeImage {
 public:
  /// A pinhole image; depth is along the optical axis. Pixels without a point count as
  /// `depth_without_return`. Made on so many threads (zero: all processors).
  RangeImage(const geometry::Scan& scan, const geometry::Camera& camera,
             double depth_without_return, double max_depth, unsigned threads);

  /// An image of azimuth and elevation about the axis, whose cells are as wide as the rays are
  /// apart; depth is the range. Cells without a point count as 0.
  RangeImage(const geometry::Scan& scan, const SweepRays& rays, double max_depth, unsigned threads);

  /// `margin` is kept free in front of the measurements.
  BallSight sight(const Eigen::Vector3d& centre_in_world, double radius, double margin) const;

  /// The greatest depth in the image.
  double farthest() const { return levels_.back().greatest().front(); }

  /// A box around all that the image can prove free.
  Eigen::AlignedBox3d reach() const;

 private:
  struct Patch {  ///< pixels, both ends included; may reach beyond the image
    double left, right, top, bottom;
    double nearest, farthest;  ///< depth of the ball
  };
  struct Depths {
    float least, greatest;
  };
  struct Level {
    int width, height;
    std::vector<float> least_depths, greatest_depths;  ///< the latter empty: the same

    const std::vector<float>& least() const { return least_depths; }
    const std::vector<float>& greatest() const {
      return greatest_depths.empty() ? least_depths : greatest_depths;
    }
    Level halved(unsigned threads) const;
  };

  std::optional<Patch> pinhole_patch(const Eigen::Vector3d& centre, double radius) const;
  std::optional<Patch> spherical_patch(const Eigen::Vector3d& centre, double radius) const;
  void build_pyramid(std::vector<float> depths, unsigned threads);
  Depths over(int left, int right, int top, int bottom) const;
  Depths over_wrapped(const Patch& patch) const;

  Eigen::Isometry3d sensor_from_world_;  ///< of the image: y along the axis if it is spherical
  double origin_spread_ = 0.0;
  std::optional<geometry::Camera> camera_;  ///< none: spherical
  double pixels_per_radian_ = 0.0;
  int width_ = 0, height_ = 0;
  std::vector<Level> levels_;
};

}  // namespace skycap::flight
