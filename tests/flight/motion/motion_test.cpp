#include "flight/motion/motion.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/flight/vehicles.h"
#include "tests/support/complaint.h"
#include "tests/support/not_empty.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

/// Integrates the fastest jerk-limited motion from rest on a time grid, by brute force. It
/// accelerates with bang-bang jerk and brakes symmetrically. Only the distance is compared.
double distance_covered(double time, double speed, double acceleration, double jerk) {
  // First half: raise, hold and lower the acceleration so that it ends at zero with speed v.
  const double dt = time / 400000;
  double a = 0, v = 0, half = 0;
  for (double t = 0; t < time / 2; t += dt) {
    // Lowering the acceleration from a takes a / j and adds a^2 / (2 j) to the speed. It must also
    // end at half time.
    const bool must_lower = v + a * a / (2 * jerk) >= speed || t + a / jerk >= time / 2;
    a = must_lower ? std::max(0.0, a - jerk * dt) : std::min(acceleration, a + jerk * dt);
    v += a * dt;
    half += v * dt;
  }
  return 2 * half;
}

TEST(RestToRest, CoversDistanceInAllRegimes) {
  for (const double distance : {0.01, 0.3, 2.0, 5.0, 20.0, 300.0}) {
    for (const double speed : {1.0, 4.0, 15.0}) {
      const double time = rest_to_rest_time(distance, speed, 2.0, 4.0);
      // The grid overshoots the speed by the acceleration of one step, 2 time / 400,000: at most
      // 0.15%.
      EXPECT_NEAR(distance_covered(time, speed, 2.0, 4.0), distance, 1.5e-3 * distance)
          << distance << " m at " << speed << " m/s";
    }
  }
}

TEST(RestToRest, IsMonotonicAndContinuousAcrossRegimes) {
  double before = 0.0;
  for (double distance = 0.001; distance < 60.0; distance *= 1.01) {
    const double time = rest_to_rest_time(distance, 4.0, 2.0, 4.0);
    EXPECT_GT(time, before);
    EXPECT_LT(time - before, 0.35);
    before = time;
  }
  EXPECT_EQ(rest_to_rest_time(0.0, 4.0, 2.0, 4.0), 0.0);
}

TEST(Turn, IsTriangularThenTrapezoidal) {
  EXPECT_DOUBLE_EQ(turn_time(0.5, 1.0, 2.0), 1.0);  // reaches 1 rad/s halfway
  EXPECT_DOUBLE_EQ(turn_time(-3.0, 1.0, 2.0), 3.5);
  EXPECT_DOUBLE_EQ(turn_time(0.125, 1.0, 2.0), 0.5);
}

TEST(Motion, HasSeparateLimitsForVerticalLegs) {
  Vehicle vehicle;
  vehicle.mode.max_descent = 2.0;  // climb at 3 m/s
  const Motion motion(vehicle, {.cruise_speed = 8.0});
  EXPECT_DOUBLE_EQ(motion.leg_speed({1, 0, 0}), 8.0);
  EXPECT_DOUBLE_EQ(motion.leg_speed({0, 0, 1}), 3.0);
  EXPECT_DOUBLE_EQ(motion.leg_speed({0, 0, -1}), 2.0);
  EXPECT_NEAR(motion.leg_speed(Vector3d(0.6, 0, -0.8)), 2.5, 1e-12);
  EXPECT_GT(motion.leg_time({0, 0, -30}), motion.leg_time({0, 0, 30}));
}

// Vertical motion uses the vertical limit and level motion the horizontal limit. On a slope, the
// limit that is reached first determines the acceleration.
TEST(Motion, LimitsAccelerationBySlowerAxis) {
  Vehicle vehicle;
  vehicle.mode.acceleration = 2.5, vehicle.mode.vertical_acceleration = 1.0;
  const Motion motion(vehicle, {});
  EXPECT_DOUBLE_EQ(motion.leg_acceleration({1, 0, 0}), 2.5);
  EXPECT_DOUBLE_EQ(motion.leg_acceleration({0, 0, -1}), 1.0);
  for (double slope = 0.02; slope < 1.6; slope += 0.02) {
    const Vector3d displacement(std::cos(slope), 0.0, std::sin(slope));
    const Vector3d acceleration = motion.leg_acceleration(displacement) * displacement;
    EXPECT_LE(acceleration.x(), 2.5 + 1e-12);
    EXPECT_LE(acceleration.z(), 1.0 + 1e-12);
    EXPECT_TRUE(acceleration.x() > 2.5 - 1e-12 || acceleration.z() > 1.0 - 1e-12) << slope;
  }
}

// Written trajectories have seven phases. They must end before the autopilot's motion does.
TEST(Motion, IsNotFasterThanSevenPhases) {
  for (const Vehicle& vehicle : testing_support::not_empty(vehicle_profiles())) {
    const Motion motion(vehicle, {});
    for (const Vector3d& displacement :
         {Vector3d(0.05, 0, 0), Vector3d(0, 0.7, 0.1), Vector3d(3, 0, -2), Vector3d(0, 0, 12),
          Vector3d(40, 30, 5)}) {
      const Vector3d direction = displacement.normalized();
      const double min = rest_to_rest_time(displacement.norm(), motion.leg_speed(direction),
                                           motion.leg_acceleration(direction), vehicle.mode.jerk);
      EXPECT_GE(motion.leg_time(displacement), min + vehicle.mode.settle_time - 1e-9)
          << vehicle.name;
    }
    EXPECT_EQ(motion.leg_time(Vector3d::Zero()), 0.0);
  }
}

TEST(Motion, LandsInTwoStages) {
  Vehicle vehicle;
  vehicle.mode.max_descent = 1.5, vehicle.mode.landing_speed = 0.5;
  vehicle.mode.landing_height = 10.0, vehicle.mode.touchdown_time = 2.0;
  const Motion motion(vehicle, {});
  EXPECT_DOUBLE_EQ(motion.landing_time(5.0), 12.0);
  EXPECT_DOUBLE_EQ(motion.landing_time(40.0), 20.0 + 20.0 + 2.0);
}

// Aiming takes as long as the slowest of leg, heading and gimbal. DJI's gimbal starts on arrival.
TEST(Motion, AimsEnRoute) {
  Vehicle vehicle;
  vehicle.mode.yaw_rate = 1.0, vehicle.mode.yaw_acceleration = 2.0, vehicle.gimbal_rate = 0.5;
  const Motion other(vehicle, {});
  EXPECT_DOUBLE_EQ(other.aimed_time(9.0, 2.0, 1.0), 9.0);
  EXPECT_DOUBLE_EQ(other.aimed_time(1.0, 3.0, 1.0), 3.5);
  EXPECT_DOUBLE_EQ(other.aimed_time(1.0, 0.0, -1.0), 2.0);
  vehicle.autopilot = AutopilotType::dji;
  EXPECT_DOUBLE_EQ(Motion(vehicle, {}).aimed_time(9.0, 2.0, -1.0), 11.0);
}

TEST(Motion, LimitsGroundSpeedInHeadwind) {
  Vehicle vehicle;  // airspeed 10 m/s
  const Motion motion(vehicle, {.wind = {0, -6}, .cruise_speed = 10.0});
  EXPECT_NEAR(motion.leg_speed({0, 1, 0}), 4.0, 1e-12);    // headwind
  EXPECT_NEAR(motion.leg_speed({1, 0, 0}), 8.0, 1e-12);    // crosswind: 6-8-10
  EXPECT_NEAR(motion.leg_speed({0, -1, 0}), 10.0, 1e-12);  // tailwind, limited by the cruise speed
}

// Calibration of the model: hovering until the battery is empty takes as long as in the data sheet.
TEST(Motion, MatchesDataSheetEndurance) {
  for (const Vehicle& vehicle : testing_support::not_empty(vehicle_profiles())) {
    const Motion motion(vehicle, {.reserve = 0.0});
    const double battery = motion.usable_energy() * (1.0 + vehicle.energy_error);
    const double minutes = battery / motion.hover_power() / 60.0;
    EXPECT_NEAR(minutes, vehicle.endurance_min, 1e-6) << vehicle.name;
  }
}

// Momentum theory: the power has its minimum slightly below hover power at a moderate speed, and
// rises steeply above it.
TEST(Motion, HasMinPowerAtModerateForwardSpeed) {
  for (const Vehicle& vehicle : testing_support::not_empty(vehicle_profiles())) {
    const Motion motion(vehicle, {});
    double min = motion.hover_power();
    for (double speed = 0; speed <= 15; speed += 0.5) {
      min = std::min(min, motion.forward_power(speed));
    }
    EXPECT_LT(min, 0.99 * motion.hover_power()) << vehicle.name;
    EXPECT_GT(min, 0.5 * motion.hover_power()) << vehicle.name;
    EXPECT_GT(motion.forward_power(30.0), motion.hover_power()) << vehicle.name;
  }
}

TEST(Motion, UsesMoreThanPotentialEnergyWhenClimbing) {
  const Vehicle vehicle;
  const Motion motion(vehicle, {});
  const double up = motion.leg_energy({0, 0, 50}, 0.0);
  const double level = motion.hover_power() * motion.leg_time({0, 0, 50});
  EXPECT_GT(up - level, vehicle.mass * 9.8 * 50);
}

TEST(Motion, ReducesUsableEnergyForColdReserveAndModelError) {
  const Vehicle vehicle;
  const double warm = Motion(vehicle, {.reserve = 0.0}).usable_energy();
  EXPECT_NEAR(Motion(vehicle, {.temperature_c = -5.0, .reserve = 0.0}).usable_energy(), 0.8 * warm,
              1e-6);
  EXPECT_NEAR(Motion(vehicle, {.reserve = 0.25}).usable_energy(), 0.75 * warm, 1e-6);
  Vehicle unsure = vehicle;
  unsure.energy_error = 2 * vehicle.energy_error + 0.05;
  EXPECT_LT(Motion(unsure, {.reserve = 0.0}).usable_energy(), warm);
}

std::string error_message(const Vehicle& vehicle, const Conditions& conditions) {
  return testing_support::thrown_message([&] { const Motion motion(vehicle, conditions); });
}

TEST(Motion, RejectsInvalidLimits) {
  const Vehicle good;
  EXPECT_EQ(error_message(good, {}), "");
  EXPECT_THAT(error_message(good, {.wind = {20, 0}}), HasSubstr("the wind is 20"));
  EXPECT_THAT(error_message(good, {.cruise_speed = 50}), HasSubstr("the cruise speed is 50"));
  EXPECT_THAT(error_message(good, {.cruise_speed = std::nan("")}), HasSubstr("cruise speed"));
  EXPECT_THAT(error_message(good, {.reserve = 1.0}), HasSubstr("reserve"));
  Vehicle heavy = good;
  heavy.mass = 20;
  EXPECT_THAT(error_message(heavy, {}),
              HasSubstr("less than the power required to hover at this mass"));
  Vehicle still = good;
  still.mode.acceleration = 0;
  EXPECT_THAT(error_message(still, {}), HasSubstr("acceleration is 0"));
}

}  // namespace
}  // namespace skycap::flight
