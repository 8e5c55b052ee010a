#include "flight/motion/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "flight/motion/hover_power.h"
#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double gravity = 9.80665;
constexpr double sea_level_density = 1.225;
constexpr double joules_per_wh = 3600.0;

/// Data sheets state endurance until the battery is empty. Ageing reduces the capacity by 5%.
constexpr double aged_capacity = 0.95;
/// Relative capacity loss per degree below 15 °C.
constexpr double loss_per_degree = 0.01;
/// Fraction of the rotors' hover power that overcomes blade drag. The ratio of cruise speed to tip
/// speed changes it by the factor 1 + 3 (v / tip)^2 (Leishman, Principles of Helicopter
/// Aerodynamics, section 5.4).
constexpr double profile_share = 0.2;
constexpr double tip_speed = 120.0;

double disc_area(const Vehicle& vehicle) {
  return vehicle.rotors * std::numbers::pi * vehicle.rotor_diameter * vehicle.rotor_diameter / 4.0;
}

/// Returns the hover power at sea level from momentum theory [W].
double ideal_power(const Vehicle& vehicle) {
  return std::pow(vehicle.mass * gravity, 1.5) /
         std::sqrt(2.0 * sea_level_density * disc_area(vehicle));
}

}  // namespace

void Conditions::validate(const Vehicle& vehicle) const {
  const auto fail = [](const std::string& what) { throw Error(ErrorKind::bad_config, what); };
  if (!wind.allFinite() || wind.norm() > vehicle.max_wind) {
    fail("the wind is " + std::to_string(wind.norm()) + " m/s; vehicle \"" + vehicle.name +
         "\" is limited to " + std::to_string(vehicle.max_wind) + " m/s");
  }
  if (!(cruise_speed > 0.0) || !(cruise_speed <= vehicle.max_speed)) {
    fail("the cruise speed is " + std::to_string(cruise_speed) + " m/s; for vehicle \"" +
         vehicle.name + "\" it must be above 0 and at most " + std::to_string(vehicle.max_speed) +
         " m/s");
  }
  if (!(reserve >= 0.0 && reserve < 1.0)) {
    fail("the battery reserve is " + std::to_string(reserve) +
         "; it must be at least 0 and below 1");
  }
  if (!(longest_flight >= 1.0)) {
    fail("the longest flight is " + std::to_string(longest_flight) +
         " times the estimated time; it must be at least 1");
  }
  if (!(air_density > 0.3 && air_density < 2.0)) {
    fail("the air density is " + std::to_string(air_density) +
         " kg/m^3; it must be between 0.3 and 2 (exclusive)");
  }
  if (!(temperature_c >= -40.0 && temperature_c <= 60.0)) {
    fail("the temperature is " + std::to_string(temperature_c) +
         " degrees Celsius; it must be between -40 and 60");
  }
}

double rest_to_rest_time(double distance, double speed, double acceleration, double jerk) {
  if (distance <= 0.0) return 0.0;
  // Time to reach the speed, with or without a phase of constant acceleration.
  const double ramp = speed * jerk >= acceleration * acceleration
                          ? acceleration / jerk + speed / acceleration
                          : 2.0 * std::sqrt(speed / jerk);
  if (distance >= speed * ramp) return ramp + distance / speed;
  // The speed is not reached. The acceleration may be.
  if (distance >= 2.0 * std::pow(acceleration, 3) / (jerk * jerk)) {
    const double half_rise = 0.5 * acceleration / jerk;
    return 2.0 * (half_rise + std::sqrt(half_rise * half_rise + distance / acceleration));
  }
  return 4.0 * std::cbrt(distance / (2.0 * jerk));
}

MotionState rest_to_rest_state(double distance, double speed, double acceleration, double jerk,
                               double time) {
  const double total = rest_to_rest_time(distance, speed, acceleration, jerk);
  if (time <= 0.0 || distance <= 0.0) return {};
  if (time >= total) return {distance, 0.0, 0.0};
  if (time > 0.5 * total) {  // Braking mirrors the acceleration.
    const MotionState mirrored =
        rest_to_rest_state(distance, speed, acceleration, jerk, total - time);
    return {distance - mirrored.distance, mirrored.speed, -mirrored.acceleration};
  }
  // Up to the peak speed: the acceleration rises, is constant, and falls. Then the speed is
  // constant.
  const double peak_ramp = std::min(0.5 * total, speed * jerk >= acceleration * acceleration
                                                     ? acceleration / jerk + speed / acceleration
                                                     : 2.0 * std::sqrt(speed / jerk));
  const double rise = std::min(acceleration / jerk, 0.5 * peak_ramp);
  MotionState state;
  double left = time;
  const auto advance = [&](double phase, double phase_jerk) {
    const double t = std::min(left, phase);
    state.distance += t * (state.speed + t * (state.acceleration / 2.0 + t * phase_jerk / 6.0));
    state.speed += t * (state.acceleration + t * phase_jerk / 2.0);
    state.acceleration += t * phase_jerk;
    left -= t;
  };
  advance(rise, jerk);
  advance(peak_ramp - 2.0 * rise, 0.0);
  advance(rise, -jerk);
  advance(left, 0.0);
  return state;
}

double turn_time(double angle, double rate, double acceleration) {
  const double turn = std::abs(angle);
  const double ramp = rate / acceleration;
  if (turn >= rate * ramp) return ramp + turn / rate;
  return 2.0 * std::sqrt(turn / acceleration);
}

double data_sheet_power(const Vehicle& vehicle) {
  return aged_capacity * vehicle.battery_wh * 60.0 / vehicle.endurance_min;
}

double endurance_at(const Vehicle& vehicle, double hover_power) {
  return aged_capacity * vehicle.battery_wh * 60.0 / hover_power;
}

double min_rotor_power(const Vehicle& vehicle) {
  return ideal_power(vehicle) / (1.0 - profile_share);
}

Motion::Motion(const Vehicle& vehicle, const Conditions& conditions)
    : vehicle_(vehicle), conditions_(conditions) {
  vehicle.validate();
  conditions.validate(vehicle);
  const double thrust = vehicle.mass * gravity;
  const double rotor_power = data_sheet_power(vehicle) - vehicle.avionics_power;
  efficiency_ = ideal_power(vehicle) / ((1.0 - profile_share) * rotor_power);
  if (!(rotor_power > 0.0) || !(efficiency_ < 1.0)) {
    throw Error(ErrorKind::bad_config,
                "vehicle \"" + vehicle.name + "\": an endurance of " +
                    std::to_string(vehicle.endurance_min) + " min corresponds to a power of " +
                    std::to_string(data_sheet_power(vehicle)) +
                    " W, which is less than the power required to hover at this mass");
  }
  const double density_ratio = conditions.air_density / sea_level_density;
  induced_speed_ = std::sqrt(thrust / (2.0 * conditions.air_density * disc_area(vehicle)));
  induced_power_ = (1.0 - profile_share) * rotor_power / std::sqrt(density_ratio);
  profile_power_ = profile_share * rotor_power * density_ratio;
}

double Motion::hover_power() const { return forward_power(0.0); }

// Induced power decreases with airspeed, profile and parasite power increase (Liu et al. 2017, Eq.
// (12)).
double Motion::forward_power(double airspeed) const {
  const double ratio = 0.5 * airspeed * airspeed / (induced_speed_ * induced_speed_);
  const double induced = std::sqrt(std::sqrt(1.0 + ratio * ratio) - ratio);
  const double parasite =
      0.5 * conditions_.air_density * vehicle_.drag_area * std::pow(airspeed, 3) / efficiency_;
  return induced_power_ * induced +
         profile_power_ * (1.0 + 3.0 * std::pow(airspeed / tip_speed, 2)) + parasite +
         vehicle_.avionics_power;
}

double Motion::leg_speed(const Vector3d& direction) const {
  const double horizontal = direction.head<2>().norm();
  double speed = conditions_.cruise_speed;
  if (direction.z() > 0.0) speed = std::min(speed, vehicle_.mode.max_ascent / direction.z());
  if (direction.z() < 0.0) speed = std::min(speed, vehicle_.mode.max_descent / -direction.z());
  if (horizontal > 0.0) {
    // |ground velocity - wind| <= max_speed, solved for the ground speed along the leg.
    const double along = conditions_.wind.dot(direction.head<2>()) / horizontal;
    const double across_squared = conditions_.wind.squaredNorm() - along * along;
    const double root =
        std::sqrt(std::max(0.0, vehicle_.max_speed * vehicle_.max_speed - across_squared));
    speed = std::min(speed, (along + root) / horizontal);
  }
  // The wind limit of any realistic vehicle is below its maximum speed.
  return std::max(speed, 0.1);
}

double Motion::leg_acceleration(const Vector3d& direction) const {
  return acceleration_along(vehicle_.mode, direction);
}

double acceleration_along(const MissionMode& mode, const Vector3d& direction) {
  const double horizontal = direction.head<2>().norm(), vertical = std::abs(direction.z());
  if (vertical * mode.acceleration > horizontal * mode.vertical_acceleration) {
    return mode.vertical_acceleration / vertical;
  }
  return mode.acceleration / horizontal;
}

double stopping_distance(const Vehicle& vehicle, const Vector3d& velocity) {
  const double speed = velocity.norm();
  if (speed == 0.0) return 0.0;
  MissionMode mode = vehicle.mode;
  mode.acceleration = acceleration_along(mode, velocity / speed);
  return vehicle.autopilot == AutopilotType::ardupilot ? braking_distance(mode, speed)
                                                       : 0.5 * speed * speed / mode.acceleration;
}

double Motion::moving_time(const Vector3d& displacement) const {
  const double distance = displacement.norm();
  if (distance == 0.0) return 0.0;
  const Vector3d direction = displacement / distance;
  const LegLimits limits{leg_speed(direction), leg_acceleration(direction)};
  const MissionMode& mode = vehicle_.mode;
  if (mode.leg_profile == LegProfile::s_curve) {
    return s_curve_time(distance, limits, mode.jerk, mode.jerk_rise);
  }
  // On distances within the acceptance radius, the vehicle still flies to the position.
  return std::max(braking_distance_time(distance, limits, mode.jerk),
                  rest_to_rest_time(distance, limits.speed, limits.acceleration, mode.jerk));
}

double Motion::leg_time(const Vector3d& displacement) const {
  const double moving = moving_time(displacement);
  return moving == 0.0 ? 0.0 : moving + vehicle_.mode.settle_time;
}

double Motion::aimed_time(double leg, double yaw, double pitch) const {
  const double turning = turn_time(yaw, vehicle_.mode.yaw_rate, vehicle_.mode.yaw_acceleration);
  const double tilting = std::abs(pitch) / vehicle_.gimbal_rate;
  if (vehicle_.autopilot == AutopilotType::dji) return std::max(leg, turning) + tilting;
  return std::max({leg, turning, tilting});
}

double Motion::takeoff_time(double climb) const {
  const MissionMode& mode = vehicle_.mode;
  return climb / mode.takeoff_speed + mode.takeoff_ramp + mode.settle_time;
}

double Motion::landing_time(double descent) const {
  const MissionMode& mode = vehicle_.mode;
  const double slow = std::min(descent, mode.landing_height);
  return (descent - slow) / mode.max_descent + slow / mode.landing_speed + mode.touchdown_time;
}

double Motion::takeoff_energy(double climb) const {
  return hover_energy(takeoff_time(climb)) + vehicle_.mass * gravity * climb / efficiency_;
}

double Motion::hover_energy(double duration) const {
  return forward_power(conditions_.wind.norm()) * duration;
}

double Motion::leg_energy(const Vector3d& displacement, double duration) const {
  const double moving = moving_time(displacement);
  if (moving == 0.0) return hover_energy(duration);
  const double distance = displacement.norm();
  const double peak_speed = std::min(leg_speed(displacement / distance), 2.0 * distance / moving);
  return flight_power(displacement / moving) * moving + stopping_energy(peak_speed) +
         hover_energy(std::max(0.0, duration - moving));
}

double Motion::flight_power(const Vector3d& velocity) const {
  // Climbing lifts the mass. Slow descent recovers no energy.
  const double climb = std::max(0.0, velocity.z()) * vehicle_.mass * gravity / efficiency_;
  return forward_power((velocity.head<2>() - conditions_.wind).norm()) + climb;
}

double Motion::stopping_energy(double speed) const {
  return 0.5 * vehicle_.mass * speed * speed / efficiency_;
}

double Motion::usable_energy() const {
  const double cold = std::max(0.0, 15.0 - conditions_.temperature_c);
  return joules_per_wh * vehicle_.battery_wh * aged_capacity *
         std::max(0.0, 1.0 - loss_per_degree * cold) * (1.0 - conditions_.reserve) /
         (1.0 + vehicle_.energy_error);
}

}  // namespace skycap::flight
