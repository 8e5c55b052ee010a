// Simulated logs with a known vehicle and wind. The calibration must recover both.
#include "flight/calibration/calibration.h"

#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/geodesy.h"
#include "flight/motion/motion.h"
#include "geometry/error.h"
#include "tests/flight/vehicles.h"

namespace skycap::flight {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double period = 0.1;  ///< sampling period [s]

/// Returns the vehicle that flies in the log. It differs slightly from the preset.
Vehicle reference_vehicle() {
  Vehicle vehicle = vehicle_profile("generic_ardupilot");
  vehicle.endurance_min = 22.0;
  vehicle.avionics_power = 35.0;
  vehicle.drag_area = 0.06;
  return vehicle;
}

/// Returns eight minutes of velocities: hover, climb, legs at several speeds in four directions,
/// descent and hover.
std::vector<Vector3d> velocities() {
  std::vector<Vector3d> all;
  const auto fly = [&](const Vector3d& velocity, double time) {
    for (double t = 0.0; t < time; t += period) all.push_back(velocity);
  };
  fly({0, 0, 0}, 70);
  fly({0, 0, 2.5}, 20);
  for (const double speed : {3.0, 6.0, 9.0}) {
    for (const Vector2d& direction :
         {Vector2d(1, 0), Vector2d(0, 1), Vector2d(-1, 0), Vector2d(0, -1)}) {
      fly({speed * direction.x(), speed * direction.y(), 0}, 25);
    }
  }
  fly({0, 0, -1.5}, 33);
  fly({0, 0, 0}, 70);
  return all;
}

/// Simulates a log. `noise` is the standard deviation of the measured power [W].
FlightLog make_log(const Vehicle& vehicle, const Vector2d& wind, double noise) {
  const Motion motion(vehicle, {.wind = wind});
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  FlightLog log;
  for (const Vector3d& velocity : velocities()) {
    const double time = period * static_cast<double>(log.samples.size());
    log.samples.push_back({time, velocity, motion.flight_power(velocity) + noise * normal(random)});
  }
  return log;
}

TEST(Calibration, RecoversVehicleAndWindFromNoiseFreeLog) {
  const Calibration found = calibrate(make_log(reference_vehicle(), {2.0, -1.0}, 0.0),
                                      vehicle_profile("generic_ardupilot"), 1.225);
  EXPECT_NEAR(found.vehicle.endurance_min, 22.0, 0.01);
  EXPECT_NEAR(found.vehicle.avionics_power, 35.0, 0.5);
  EXPECT_NEAR(found.vehicle.drag_area, 0.06, 0.001);
  EXPECT_LT((found.wind - Vector2d(2.0, -1.0)).norm(), 0.02);
  EXPECT_NEAR(found.hover_power, Motion(reference_vehicle(), {}).hover_power(), 0.1);
  EXPECT_LT(found.energy_error, 0.001);
  EXPECT_EQ(found.vehicle.energy_error, min_energy_error);
}

// Noise of 10% in single power readings leaves the energy within 1%.
TEST(Calibration, PredictsPowerFromNoisyLog) {
  const Calibration found = calibrate(make_log(reference_vehicle(), {2.0, -1.0}, 25.0),
                                      vehicle_profile("generic_ardupilot"), 1.225);
  const Motion real(reference_vehicle(), {}), model(found.vehicle, {});
  for (const Vector3d& velocity :
       {Vector3d(0, 0, 0), Vector3d(0, 0, 2), Vector3d(5, 0, 0), Vector3d(0, 9, 0)}) {
    EXPECT_NEAR(model.flight_power(velocity) / real.flight_power(velocity), 1.0, 0.02);
  }
  EXPECT_LT(found.energy_error, 0.03);
}

// The reported error is large if the model cannot explain the log: here the power oscillates by a
// third.
TEST(Calibration, ReportsLargeEnergyErrorWhenModelDoesNotFit) {
  FlightLog log = make_log(reference_vehicle(), {0, 0}, 0.0);
  for (std::size_t i = 0; i < log.samples.size(); ++i) {
    if (i * 5 / log.samples.size() % 2 == 1) log.samples[i].power *= 1.33;
  }
  EXPECT_GT(calibrate(log, vehicle_profile("generic_ardupilot"), 1.225).energy_error, 0.1);
}

TEST(Calibration, RejectsLogsWithTooLittleFlight) {
  const auto tried = [](FlightLog log) {
    return [log] { calibrate(log, vehicle_profile("generic_ardupilot"), 1.225); };
  };
  FlightLog log = make_log(reference_vehicle(), {0, 0}, 0.0);
  FlightLog hovering = log, level = log, brief = log;
  std::erase_if(hovering.samples, [](const LogSample& s) { return s.velocity.norm() > 0.1; });
  std::erase_if(level.samples, [](const LogSample& s) { return s.velocity.norm() < 0.1; });
  brief.samples.resize(600);
  const auto throws_message = [](const char* what) {
    return ThrowsMessage<Error>(HasSubstr(what));
  };
  EXPECT_THAT(tried(brief), throws_message("s of steady flight; required: at least 120 s"));
  EXPECT_THAT(tried(hovering),
              throws_message("s of level flight faster than 2.5 m/s; required: at least 30 s"));
  EXPECT_THAT(tried(level), throws_message("s of hovering; required: at least 20 s"));
}

TEST(Calibration, ReadsLimitsFromLoggedParameters) {
  FlightLog log = make_log(reference_vehicle(), {0, 0}, 0.0);
  log.parameters = {{"WPNAV_SPEED_UP", 400}, {"WP_SPD_DN", 2.25},    {"ATC_INPUT_TC", 0.2},
                    {"LAND_SPEED", 70},      {"ATC_SLEW_YAW", 9000}, {"FENCE_RADIUS", 300}};
  const Calibration found = calibrate(log, vehicle_profile("generic_ardupilot"), 1.225);
  EXPECT_EQ(found.parameters, 5U);
  EXPECT_DOUBLE_EQ(found.vehicle.mode.max_ascent, 4.0);
  EXPECT_DOUBLE_EQ(found.vehicle.mode.max_descent, 2.25);
  EXPECT_DOUBLE_EQ(found.vehicle.mode.jerk_rise, 0.4);
  EXPECT_DOUBLE_EQ(found.vehicle.mode.landing_speed, 0.7);
  EXPECT_NEAR(found.vehicle.mode.yaw_rate, M_PI / 2.0, 1e-12);
}

// Legs of 20 m that take 0.8 s longer than the motion law predicts. Every second waypoint is flown
// through without a stop.
TEST(Calibration, ComputesSettleTimeFromLegDurations) {
  FlightLog log = make_log(reference_vehicle(), {0, 0}, 0.0);
  const LocalFrame frame({51.0, 7.0, 0.0});
  const Vehicle vehicle = vehicle_profile("generic_ardupilot");
  const Motion motion(vehicle, {});
  const double predicted = motion.leg_time({20, 0, 0}) - vehicle.mode.settle_time;
  double time = 10.0;
  for (int i = 0; i < 20; ++i) {
    const GeodeticPoint geodetic = frame.to_geodetic({20.0 * i, 0, 0});
    log.commands.push_back({time, 16, 0, 0, geodetic.latitude_deg, geodetic.longitude_deg, 30.0});
    time += predicted + 0.8 + (i % 2 == 0 ? 0.0 : 3.0);
    if (i % 2 == 0) log.commands.push_back({time, 93, 0.5, 0, 0, 0, 0});
    time += 0.5;
  }
  const Calibration found = calibrate(log, vehicle, 1.225);
  ASSERT_TRUE(found.settling);
  EXPECT_GE(found.legs, 9U);
  EXPECT_NEAR(*found.settling, 0.8, 0.01);
}

}  // namespace
}  // namespace skycap::flight
