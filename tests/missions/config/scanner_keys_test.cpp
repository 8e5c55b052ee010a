// Laser scanners that a mission may name, and their related keys.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/config/resolve.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;

TEST(SensorLidar, RejectsConflictingSettings) {
  const auto validation_error = [](const std::string& sensor,
                                   const std::string& more) -> std::string {
    try {
      config::parse_mission("scene: {model: builtin:teapot}\nsensor: " + sensor +
                                "\nplanner: {density: 100, resolution_radius: 0.2}\n"
                                "evaluation: {coverage_distance: 0.2}\n" +
                                more,
                            "m.yaml");
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_config);
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(validation_error("{lidar: velodyne_vlp16}", ""), "accepted");
  EXPECT_EQ(validation_error("{lidar: livox_avia}", ""), "accepted");
  EXPECT_THAT(validation_error("{lidar: riegl_vux_1uav}", ""),
              HasSubstr("m.yaml:2: key sensor.lidar: a single-line LiDAR requires flight.vehicle"));
  EXPECT_THAT(validation_error("{lidar: see_d435}", ""), HasSubstr("is a camera"));
  EXPECT_THAT(validation_error("{lidar: os1}", ""), HasSubstr("expected one of"));
  EXPECT_THAT(validation_error("{lidar: velodyne_vlp16, width: 100}", ""),
              HasSubstr("key sensor.width conflicts with sensor.lidar"));
  const std::string flight_mission =
      "flight: {vehicle: m350_rtk, unknown_box: {min: [-1, -1, 0], max: [1, 1, 1]}}\n";
  EXPECT_EQ(validation_error("{lidar: velodyne_vlp16}", flight_mission), "accepted");
  EXPECT_THAT(validation_error("{lidar: velodyne_vlp16, width: 100}", flight_mission),
              HasSubstr("key sensor.width conflicts with sensor.lidar"));
  EXPECT_THAT(validation_error("{lidar: velodyne_vlp16}",
                               flight_mission + "scan: {mount: {rotation_deg: [0, 0, 30]}}\n"),
              HasSubstr("key scan.mount.rotation_deg: the scanner's axis must be level"));
  EXPECT_EQ(validation_error("{lidar: livox_avia}", flight_mission), "accepted");
  EXPECT_THAT(
      validation_error("{lidar: livox_avia}",
                       flight_mission + "scan: {mount: {rotation_deg: [0, 90, 0]}}\n"),
      HasSubstr(
          "key scan.mount.rotation_deg: the scanner must not point up or down by more than 75"));
  EXPECT_EQ(validation_error("{lidar: riegl_vux_1uav}", flight_mission), "accepted");
  EXPECT_THAT(validation_error("{lidar: riegl_vux_1uav, capture: stops}", flight_mission),
              HasSubstr("key sensor.capture: stops conflicts with a single-line LiDAR"));
}

}  // namespace
}  // namespace skycap::missions
