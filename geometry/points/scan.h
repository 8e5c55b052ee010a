/// One measurement of the scene: the returned points and the sensor pose. Scans are the only source
/// of information of a planner.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace skycap::geometry {

/// Scan in the world frame. Points are finite and in single precision. World frames are local, so
/// that the rounding error at 100 m is 4 µm. Depths are not stored, because they can be computed
/// from the points with one dot product and are absent from all cloud formats.
struct Scan {
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();  ///< optical frame
  std::vector<Eigen::Vector3f> points;  ///< returns in order of measurement [m]

  /// Pixel `row * width + column` of each point of an organised scan, strictly ascending. Pixels
  /// that are not listed had no return. Empty if the sensor has no image.
  std::vector<std::uint32_t> pixels;

  Eigen::Vector3d sensor_position() const { return world_from_sensor.translation(); }
};

/// Non-owning view of the points and pixels of a scan: a Scan, a driver buffer or a numpy array.
/// The data must stay valid and unchanged during the lifetime of the view.
struct ScanSpan {
  Eigen::Isometry3d world_from_sensor = Eigen::Isometry3d::Identity();
  std::span<const Eigen::Vector3f> points;
  std::span<const std::uint32_t> pixels;

  ScanSpan() = default;
  // Implicit, so that functions with a ScanSpan parameter accept a Scan.
  ScanSpan(const Scan& scan)  // NOLINT(google-explicit-constructor)
      : world_from_sensor(scan.world_from_sensor), points(scan.points), pixels(scan.pixels) {}

  Eigen::Vector3d sensor_position() const { return world_from_sensor.translation(); }
};

/// Pixels in which the points were measured, as in Scan. Empty if the points have no image.
struct ImagePixels {
  std::span<const std::uint32_t> pixels;
  std::uint32_t width = 0;  ///< image width [px]
};

}  // namespace skycap::geometry
