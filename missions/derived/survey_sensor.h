/// The simulated sensor of a survey: a depth camera, or a laser scanner on a carrier that stops at
/// each view while the scanner turns once.
///
/// A sweep is not organised: its scan has points and no pixels. The scanner is mounted so that the
/// middle of its lasers, at azimuth zero, is the view's direction.
#pragma once

#include <cstdint>
#include <filesystem>
#include <variant>

#include "geometry/place/pose.h"
#include "geometry/points/scan.h"
#include "missions/file/mission.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "sim/sensors/lidar.h"

namespace skycap::missions::derived {

/// The pinhole camera that sees what a spinning scanner sees in the quarter turn before it, with as
/// many pixels as the scanner sends rays there: planners choose views by it. Throws
/// Error{bad_config} if the scanner does not spin or has not several lasers one above the other.
sim::DepthCameraConfig forward_camera(const sim::LidarConfig& lidar);

/// Reads the scanner that `sensor.lidar` names, a path being relative to `folder`, and makes
/// `camera` its forward camera. Throws what find_sensor() and forward_camera() throw, and
/// Error{bad_config} if the description is a camera's.
void use_lidar(file::SensorConfig& sensor, const std::filesystem::path& folder);

/// Immutable; safe to use from any number of threads.
class SurveySensor {
 public:
  /// Throws what the sensor's configuration throws when it is not valid.
  SurveySensor(const file::SensorConfig& config, std::uint64_t seed);

  /// What is measured from `view`, in its optical frame (geometry::camera_pose()). With the seed,
  /// `frame` alone decides the noise; the result does not depend on `threads` (zero: all
  /// processors). The memory of `recycled` is used again.
  geometry::Scan scan(const sim::Scene& scene, const geometry::View& view, std::uint64_t frame,
                      unsigned threads, geometry::Scan recycled = {}) const;

 private:
  std::variant<sim::DepthCamera, sim::Lidar> sensor_;
};

}  // namespace skycap::missions::derived
