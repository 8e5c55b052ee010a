/// The simulated sensor of a survey as a vehicle carries it: in motion or swaying at a stop, and
/// beside where the vehicle believes to be.
#pragma once

#include <cstdint>
#include <optional>

#include <Eigen/Core>

#include "flight/motion/vehicle.h"
#include "geometry/place/camera.h"
#include "geometry/place/platform.h"
#include "geometry/place/pose.h"
#include "geometry/points/scan.h"
#include "missions/evaluation/simulation_options.h"
#include "missions/session/view_in_flight.h"
#include "sim/scene/scene.h"
#include "sim/sensors/navigation_errors.h"
#include "sim/sensors/survey_sensor.h"

namespace skycap::missions::simulation {

/// Scans in the order flown. Without a vehicle, and for movements of less than half a pixel, it is
/// the sensor itself: nothing is random but its noise.
class CarriedSensor {
 public:
  /// Throws what the sensor throws.
  CarriedSensor(const evaluation::SimulationOptions& options, std::uint64_t seed);

  geometry::Scan scan(const sim::Scene& scene, const session::ViewInFlight& view,
                      std::uint64_t frame, unsigned threads, geometry::Scan recycled = {});

 private:
  /// How it moves while it measures.
  sim::Carriage carriage(const session::ViewInFlight& view, std::uint64_t frame) const;

  sim::SurveySensor sensor_;
  std::uint64_t seed_;
  std::optional<flight::Vehicle> vehicle_;  ///< of a camera that is flown
  geometry::Camera camera_;
  geometry::Shutter shutter_;
  double distance_ = 0.0;  ///< at which pixels are counted [m]
  std::optional<sim::NavigationProcess> navigation_;
  double last_time_ = 0.0;  ///< of a scan [s]
};

}  // namespace skycap::missions::simulation
