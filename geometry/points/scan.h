/// One measurement of the scene: the points a sensor returned and the pose it took them from. It is
/// all that a planner ever learns of the world.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace skycap::geometry {

/// A scan in the world frame. Points are single precision (a world frame is local: at 100 m the
/// rounding is 4 micrometres) and finite. Depths are not kept beside them: what needs them takes
/// them from the points, which is one product each, and all formats of clouds do without.
struct Scan {
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();  ///< optical frame
  std::vector<Eigen::Vector3f> points;  ///< the returns, in the order the sensor measured them

  /// For an organised scan: the pixel `row * width + column` of each point, strictly ascending;
  /// every pixel that is not listed gave no return. Empty when the sensor has no image.
  std::vector<std::uint32_t> pixels;

  Eigen::Vector3d sensor_position() const { return world_from_sensor.translation(); }
};

/// A scan whose points and pixels are someone else's: a Scan, a driver's buffer, an array of numpy.
/// They must stay as they are for as long as they are looked at.
struct ScanSpan {
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();
  std::span<const Eigen::Vector3f> points;
  std::span<const std::uint32_t> pixels;

  ScanSpan() = default;
  // Not explicit: what takes a ScanSpan takes a Scan.
  ScanSpan(const Scan& scan)  // NOLINT(google-explicit-constructor)
      : world_from_sensor(scan.world_from_sensor), points(scan.points), pixels(scan.pixels) {}

  Eigen::Vector3d sensor_position() const { return world_from_sensor.translation(); }
};

/// Where in an image its points were measured: their pixels, as a Scan has them. Of points that are
/// of no image there are none.
struct ImagePixels {
  std::span<const std::uint32_t> pixels;
  std::uint32_t width = 0;  ///< of the image
};

}  // namespace skycap::geometry
