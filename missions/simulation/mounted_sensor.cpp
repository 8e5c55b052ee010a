#include "missions/simulation/mounted_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "flight/motion/image_motion_bounds.h"
#include "sim/sensors/noise.h"

namespace skycap::missions::simulation {
namespace {

using Eigen::Vector3d;

/// Smaller movements are simulated as rest.
constexpr double min_movement_px = 0.5;
/// Maximum pixel motion between two instants of the exposure, and the maximum number of instants,
/// which takes precedence.
constexpr double max_step_px = 1.0;
constexpr int max_instants = 12;

/// Draws a uniformly distributed direction from three normal variates.
Vector3d compute_direction(std::uint64_t seed, std::uint32_t stream, std::uint64_t frame) {
  std::array<float, 32> normals;
  sim::fill_normals(sim::noise_key(seed, stream, frame), 0, normals);
  const Vector3d drawn(normals[0], normals[1], normals[2]);
  return drawn.norm() > 0.0 ? drawn.normalized() : Vector3d(Vector3d::UnitX());
}

}  // namespace

MountedSensor::MountedSensor(const evaluation::SimulationOptions& options, std::uint64_t seed)
    : sensor_(options.sensor, seed),
      seed_(seed),
      camera_(options.sensor.camera.camera),
      shutter_(options.sensor.shutter) {
  const flight::FlightOptions& flight = options.survey.flight;
  if (!flight.has_vehicle()) return;
  if (!options.sensor.scanner) {
    vehicle_ = flight.required_vehicle();
    distance_ = flight.capture.view_distance;
  }
  if (options.sensor.navigation.are_on()) {
    sim::NavigationErrors errors = options.sensor.navigation;
    errors.seed = seed;
    navigation_.emplace(errors);
  }
}

sim::PlatformMotion MountedSensor::platform_motion(const session::ViewInFlight& view,
                                                   std::uint64_t frame) const {
  sim::PlatformMotion platform_motion{.stretch = view.stretch};
  if (!vehicle_) return platform_motion;
  constexpr std::uint32_t drift_stream = 0x53574159, turn_stream = 0x53574154;
  flight::Vehicle moving = *vehicle_;
  moving.sway_speed += view.velocity.norm();
  const flight::ImageMotionBounds max = image_motion_bounds(moving, camera_, shutter_, distance_);
  if (std::max(max.blur_px, max.shear_px) < min_movement_px) return platform_motion;
  platform_motion.velocity =
      view.velocity + vehicle_->sway_speed * compute_direction(seed_, drift_stream, frame);
  platform_motion.turn_rate = vehicle_->sway_rate * compute_direction(seed_, turn_stream, frame);
  platform_motion.instants =
      std::clamp(1 + static_cast<int>(std::ceil(max.blur_px / max_step_px)), 2, max_instants);
  return platform_motion;
}

geometry::Scan MountedSensor::scan(const sim::Scene& scene, const session::ViewInFlight& view,
                                   std::uint64_t frame, unsigned threads, geometry::Scan buffer) {
  sim::PlatformMotion platform_motion = this->platform_motion(view, frame);
  if (navigation_) {
    const std::array<double, 6> error = navigation_->next(view.time - last_time_);
    last_time_ = view.time;
    platform_motion.shift = {error[0], error[1], error[2]};
    platform_motion.turn = {error[3], error[4], error[5]};
  }
  return sensor_.scan(scene, view.view, platform_motion, frame, threads, std::move(buffer));
}

}  // namespace skycap::missions::simulation
