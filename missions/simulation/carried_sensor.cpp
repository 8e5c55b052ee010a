#include "missions/simulation/carried_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "flight/motion/picture_bounds.h"
#include "sim/sensors/noise.h"

namespace skycap::missions::simulation {
namespace {

using Eigen::Vector3d;

/// Smaller movements are simulated as rest.
constexpr double least_movement_px = 0.5;
/// Maximum pixel motion between two instants of the exposure, and the maximum number of instants,
/// which takes precedence.
constexpr double most_step_px = 1.0;
constexpr int most_instants = 12;

/// Draws a uniformly distributed direction from three normal variates.
Vector3d direction_of(std::uint64_t seed, std::uint32_t stream, std::uint64_t frame) {
  std::array<float, 32> normals;
  sim::fill_normals(sim::noise_key(seed, stream, frame), 0, normals);
  const Vector3d drawn(normals[0], normals[1], normals[2]);
  return drawn.norm() > 0.0 ? drawn.normalized() : Vector3d(Vector3d::UnitX());
}

}  // namespace

CarriedSensor::CarriedSensor(const evaluation::SimulationOptions& options, std::uint64_t seed)
    : sensor_(options.sensor, seed),
      seed_(seed),
      camera_(options.sensor.camera.camera),
      shutter_(options.sensor.shutter) {
  const flight::FlightOptions& flight = options.survey.flight;
  if (!flight.is_flown()) return;
  if (!options.sensor.scanner) {
    vehicle_ = flight.flown();
    distance_ = flight.capture.view_distance;
  }
  if (options.sensor.navigation.are_on()) {
    sim::NavigationErrors errors = options.sensor.navigation;
    errors.seed = seed;
    navigation_.emplace(errors);
  }
}

sim::Carriage CarriedSensor::carriage(const session::ViewInFlight& view,
                                      std::uint64_t frame) const {
  sim::Carriage carriage{.stretch = view.stretch};
  if (!vehicle_) return carriage;
  constexpr std::uint32_t drift_stream = 0x53574159, turn_stream = 0x53574154;
  flight::Vehicle moving = *vehicle_;
  moving.sway_speed += view.velocity.norm();
  const flight::PictureBounds most = picture_bounds(moving, camera_, shutter_, distance_);
  if (std::max(most.blur_px, most.shear_px) < least_movement_px) return carriage;
  carriage.velocity =
      view.velocity + vehicle_->sway_speed * direction_of(seed_, drift_stream, frame);
  carriage.turn_rate = vehicle_->sway_rate * direction_of(seed_, turn_stream, frame);
  carriage.instants =
      std::clamp(1 + static_cast<int>(std::ceil(most.blur_px / most_step_px)), 2, most_instants);
  return carriage;
}

geometry::Scan CarriedSensor::scan(const sim::Scene& scene, const session::ViewInFlight& view,
                                   std::uint64_t frame, unsigned threads, geometry::Scan recycled) {
  sim::Carriage carriage = this->carriage(view, frame);
  if (navigation_) {
    const std::array<double, 6> error = navigation_->next(view.time - last_time_);
    last_time_ = view.time;
    carriage.shift = {error[0], error[1], error[2]};
    carriage.turn = {error[3], error[4], error[5]};
  }
  return sensor_.scan(scene, view.view, carriage, frame, threads, std::move(recycled));
}

}  // namespace skycap::missions::simulation
