/// Simulated sensor on a moving vehicle: with motion during flight, hover drift at stops, and
/// errors of the vehicle's position estimate.
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "flight/motion/vehicle.h"
#include "geometry/points/scan.h"
#include "geometry/pose/camera.h"
#include "geometry/pose/platform.h"
#include "geometry/pose/pose.h"
#include "missions/evaluation/simulation_options.h"
#include "missions/session/view_in_flight.h"
#include "sim/scene/scene.h"
#include "sim/sensors/navigation_errors.h"
#include "sim/sensors/survey_sensor.h"

namespace skycap::missions::simulation {

/// Takes scans in flight order. Without a vehicle, and for movements of less than half a pixel, the
/// sensor is simulated at rest, and only its noise is random.
class MountedSensor {
 public:
  /// Throws all errors of the sensor.
  MountedSensor(const evaluation::SimulationOptions& options, std::uint64_t seed);

  geometry::Scan scan(const sim::Scene& scene, const session::ViewInFlight& view,
                      std::uint64_t frame, unsigned threads, geometry::Scan buffer = {});

 private:
  /// Returns the motion of the sensor during a measurement.
  sim::PlatformMotion platform_motion(const session::ViewInFlight& view, std::uint64_t frame) const;

  sim::SurveySensor sensor_;
  std::uint64_t seed_;
  std::optional<flight::Vehicle> vehicle_;  ///< Vehicle that carries a camera; otherwise empty.
  geometry::Camera camera_;
  geometry::Shutter shutter_;
  double distance_ = 0.0;  ///< Distance at which image motion is evaluated [m].
  std::optional<sim::NavigationProcess> navigation_;
  double last_time_ = 0.0;  ///< Time of the last scan [s].
};

}  // namespace skycap::missions::simulation
