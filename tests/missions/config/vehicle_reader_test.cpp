#include "missions/config/vehicle_reader.h"

#include <array>
#include <fstream>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/motion/motion.h"
#include "geometry/error.h"
#include "missions/config/preset_files.h"
#include "missions/config/sensor_reader.h"
#include "tests/support/complaint.h"
#include "tests/support/not_empty.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions {
namespace {

using flight::AutopilotType;
using flight::LegProfile;
using testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180.0;

std::string error_message(const std::string& text) {
  return testing_support::thrown_message([&] { config::read_vehicle(text, "kite.yaml"); });
}

TEST(VehiclePresets, AreValidAndNamedLikeTheirFiles) {
  EXPECT_EQ(config::vehicle_preset_files().size(), 11U);
  for (const auto& [preset, text] : config::vehicle_preset_files()) {
    const flight::Vehicle vehicle = config::find_vehicle(std::string(preset));
    EXPECT_EQ(vehicle.name, preset);
    EXPECT_NO_THROW(vehicle.validate()) << preset;
    EXPECT_EQ(vehicle.autopilot == AutopilotType::dji, vehicle.wpml.drone > 0) << preset;
  }
}

// Calibration of the energy model: for each preset, a full battery hovers as long as the data sheet
// states.
TEST(VehiclePresets, HaveHoverTimeOfDataSheets) {
  for (const auto& [preset, text] : testing_support::not_empty(config::vehicle_preset_files())) {
    const flight::Vehicle vehicle = config::find_vehicle(std::string(preset));
    const flight::Motion motion(vehicle, {.reserve = 0.0});
    const double battery = motion.usable_energy() * (1.0 + vehicle.energy_error);
    EXPECT_NEAR(battery / motion.hover_power() / 60.0, vehicle.endurance_min, 1e-6) << preset;
  }
}

// ArduPilot documentation: WP_SPD_UP, WP_SPD_DN, WP_ACC, WP_ACC_Z, WP_JERK, LAND_SPD_MS.
TEST(VehiclePresets, HaveArduCopterDefaults) {
  const flight::Vehicle vehicle = config::find_vehicle("generic_ardupilot");
  EXPECT_EQ(vehicle.autopilot, AutopilotType::ardupilot);
  EXPECT_EQ(vehicle.mode.leg_profile, LegProfile::s_curve);
  EXPECT_EQ(vehicle.mode.max_ascent, 2.5);
  EXPECT_EQ(vehicle.mode.max_descent, 1.5);
  EXPECT_EQ(vehicle.mode.acceleration, 2.5);
  EXPECT_EQ(vehicle.mode.vertical_acceleration, 1.0);
  EXPECT_EQ(vehicle.mode.jerk, 1.0);
  EXPECT_NEAR(vehicle.mode.yaw_rate, 60 * degree, 1e-12);
  EXPECT_EQ(vehicle.mode.landing_speed, 0.5);
}

TEST(VehicleReader, InheritsUnsetValuesFromBaseVehicle) {
  const flight::Vehicle base_vehicle = config::find_vehicle("m350_rtk");
  const flight::Vehicle vehicle = config::read_vehicle(
      "name: mine\nlike: m350_rtk\nmass: 8\ngimbal_rate_deg: 45\nwpml: {payload: 65534}\n"
      "mode: {max_ascent: 4}\n",
      "mine.yaml");
  EXPECT_EQ(vehicle.name, "mine");
  EXPECT_EQ(vehicle.mass, 8.0);
  EXPECT_NEAR(vehicle.gimbal_rate, 45 * degree, 1e-12);
  EXPECT_EQ(vehicle.wpml.payload, 65534);
  EXPECT_EQ(vehicle.wpml.drone, base_vehicle.wpml.drone);
  EXPECT_EQ(vehicle.mode.max_ascent, 4.0);
  EXPECT_EQ(vehicle.mode.max_descent, base_vehicle.mode.max_descent);
  EXPECT_EQ(vehicle.battery_wh, base_vehicle.battery_wh);
}

TEST(VehicleReader, ReadsFixedCamerasAndTheNamesOfOwnOnes) {
  const flight::Vehicle fixed = config::read_vehicle(
      "name: mine\nlike: generic_ardupilot\ngimbal_min_deg: -15\ngimbal_max_deg: -15\n", "m.yaml");
  EXPECT_EQ(fixed.gimbal_min, fixed.gimbal_max);
  EXPECT_EQ(config::find_vehicle_camera("mavic_3e"), "dji_mavic_3e_wide");
  EXPECT_EQ(config::find_vehicle_camera("generic"), "");
}

TEST(VehicleReader, ReadsTheAppOfConsumerDrones) {
  const flight::Vehicle fly = config::find_vehicle("mini_4_pro");
  EXPECT_EQ(fly.app, flight::MissionApp::fly);
  EXPECT_EQ(fly.max_waypoints, 200);
  EXPECT_TRUE(fly.needs_waypoint_per_photo());
  EXPECT_EQ(config::find_vehicle("air_2s").app, flight::MissionApp::litchi);
  EXPECT_EQ(config::find_vehicle("air_2s").max_waypoints, 99);
  EXPECT_EQ(config::find_vehicle("mavic_3e").app, flight::MissionApp::pilot);
  const flight::Vehicle own =
      config::read_vehicle("name: mine\nlike: mini_4_pro\nmax_waypoints: 99\n", "mine.yaml");
  EXPECT_EQ(own.app, flight::MissionApp::fly);
  EXPECT_EQ(own.max_waypoints, 99);
  EXPECT_THAT(error_message("name: kite\nlike: generic\napp: litchi\n"),
              HasSubstr("kite.yaml:3: key app requires dialect: dji"));
  EXPECT_THAT(error_message("name: kite\nlike: mini_2\napp: dronelink\n"),
              HasSubstr("kite.yaml:3: key app"));
}

TEST(VehicleReader, ReportsLineOfErrors) {
  const std::string base = "name: kite\nlike: generic\n";
  EXPECT_THAT(error_message(base + "masss: 3\n"), HasSubstr("kite.yaml:3: key masss is unknown"));
  EXPECT_THAT(error_message(base + "mass: heavy\n"),
              HasSubstr("kite.yaml:3: key mass must be a num"));
  EXPECT_THAT(error_message(base + "mass: -1\n"),
              HasSubstr("kite.yaml:3: key mass is -1; it must be from 0.01 to 1000"));
  EXPECT_THAT(error_message(base + "mode:\n  jerk: 0\n"),
              HasSubstr("kite.yaml:4: key mode.jerk is 0; it must be from"));
  EXPECT_THAT(error_message(base + "mode: {law: straight}\n"),
              HasSubstr("it must be one of s_curve"));
  EXPECT_THAT(error_message(base + "rotors: 4.5\n"), HasSubstr("key rotors must be an integer"));
  EXPECT_THAT(error_message(base + "gimbal_max_deg: -90\ngimbal_min_deg: -89\n"),
              HasSubstr("must be at least gimbal_min_deg"));
  EXPECT_THAT(error_message(base + "camera: ouster_os1_64\n"),
              HasSubstr("kite.yaml:3: key camera: ouster_os1_64 is a LiDAR"));
  EXPECT_THAT(error_message(base + "mass: 20\n"),
              HasSubstr("less than the power required to hover at this mass"));
  EXPECT_THAT(
      error_message("name: kite\nlike: dragon\n"),
      HasSubstr("kite.yaml:2: key like: unknown vehicle dragon; expected one of: air_2s, "));
  EXPECT_THAT(error_message("name: kite\n"), HasSubstr("key dialect is missing"));
  EXPECT_THAT(error_message("like: generic\n"), HasSubstr("key name is missing"));
}

// Drone types of DJI's WPML documentation and product page; payload types of its WPMZ library: H20
// 42, M30T 53, M3E 66, M4E 88, L1 90742, EP810 (L2) 84.
TEST(VehiclePresets, HaveTypeNumbersOfTheMaker) {
  const auto numbers = [](const char* name) {
    const flight::WpmlCodes codes = config::find_vehicle(name).wpml;
    return std::array{codes.drone, codes.drone_variant, codes.payload};
  };
  EXPECT_THAT(numbers("m350_rtk"), testing::ElementsAre(89, 0, 42));
  EXPECT_THAT(numbers("m30t"), testing::ElementsAre(67, 1, 53));
  EXPECT_THAT(numbers("mavic_3e"), testing::ElementsAre(77, 0, 66));
  EXPECT_THAT(numbers("matrice_4e"), testing::ElementsAre(99, 0, 88));
  EXPECT_EQ(config::find_sensor("dji_zenmuse_l1").wpml_payload, 90742);
  EXPECT_EQ(config::find_sensor("dji_zenmuse_l2").wpml_payload, 84);
}

TEST(VehicleReader, ReadsVehicleFiles) {
  const testing_support::TemporaryFolder folder;
  const std::string path = (folder.path() / "mine.yaml").string();
  std::ofstream(path) << "name: mine\nlike: skydio_x10\nmax_speed: 12\n";
  EXPECT_EQ(config::find_vehicle(path).max_speed, 12.0);
  EXPECT_EQ(config::find_vehicle(path).position_error, 1.5);
  EXPECT_THAT(testing_support::thrown_message(
                  [&] { config::find_vehicle((folder.path() / "none.yaml").string()); }),
              testing::HasSubstr("none.yaml: "));
}

}  // namespace
}  // namespace skycap::missions
