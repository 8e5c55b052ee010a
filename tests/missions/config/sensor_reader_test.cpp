#include "missions/config/sensor_reader.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "sim/sensors/scan_pattern.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using sim::DepthCameraConfig;
using sim::LidarConfig;
using testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180.0;

const LidarConfig& lidar(const config::SensorDescription& description) {
  return std::get<LidarConfig>(description.sensor);
}

double pulses_per_second(const char* preset) {
  const config::SensorDescription description = config::find_sensor(preset);
  const LidarConfig& config = lidar(description);
  return static_cast<double>(config.channels.size()) / config.firing_period;
}

TEST(SensorPresets, AreValid) {
  EXPECT_EQ(config::sensor_presets().size(), 19U);
  for (const std::string_view preset : config::sensor_presets()) {
    EXPECT_FALSE(config::find_sensor(std::string(preset)).name.empty()) << preset;
  }
}

// Pulse rates of the data sheets: the number of lasers divided by the firing period.
TEST(SensorPresets, HavePulseRatesOfDataSheets) {
  EXPECT_NEAR(pulses_per_second("velodyne_vlp16"), 289'352, 1);
  EXPECT_NEAR(pulses_per_second("velodyne_vlp32c"), 578'704, 1);
  EXPECT_NEAR(pulses_per_second("ouster_os1_64"), 655'360, 1);
  EXPECT_NEAR(pulses_per_second("ouster_os1_128"), 2'621'440, 1);
  EXPECT_NEAR(pulses_per_second("livox_mid70"), 100'000, 1);
  EXPECT_NEAR(pulses_per_second("livox_avia"), 240'000, 1);
  EXPECT_NEAR(pulses_per_second("dji_zenmuse_l1"), 240'000, 1);
  EXPECT_NEAR(pulses_per_second("dji_zenmuse_l2"), 240'000, 1);
  EXPECT_NEAR(pulses_per_second("riegl_minivux_1uav"), 100'000, 1);
  EXPECT_NEAR(pulses_per_second("riegl_vux_1uav"), 550'000, 1);
}

// Compares the largest off-axis angle of a rosette with half the field of view in the data sheet.
TEST(SensorPresets, CoverFieldsOfViewOfRosettes) {
  const auto widest = [](const char* preset) {
    const config::SensorDescription description = config::find_sensor(preset);
    double angle = 0.0;
    for (int i = 0; i < 20'000; ++i) {
      const Eigen::Vector3d beam =
          sim::refract(lidar(description).prisms, 1.7e-4 * i, Eigen::Vector3d::UnitX());
      angle = std::max(angle, std::acos(beam.x()));
    }
    return angle / degree;
  };
  EXPECT_NEAR(widest("livox_mid70"), 0.5 * 70.4, 0.2);
  EXPECT_NEAR(widest("livox_avia"), 0.5 * 77.2, 0.5);
  EXPECT_NEAR(widest("dji_zenmuse_l2"), 0.5 * 70.0, 0.5);
}

TEST(SensorPresets, ConvertBeamDivergenceToOneOverESquared) {
  const config::SensorDescription description = config::find_sensor("dji_zenmuse_l2");
  EXPECT_NEAR(lidar(description).beam.divergence_horizontal, 1.02e-3, 1e-5);
  EXPECT_NEAR(lidar(description).beam.divergence_vertical, 0.34e-3, 1e-5);
}

TEST(SensorPresets, MatchSimulatorCameras) {
  const auto camera = [](const char* preset) {
    const config::SensorDescription description = config::find_sensor(preset);
    return std::get<DepthCameraConfig>(description.sensor);
  };
  const DepthCameraConfig high = camera("see_high_resolution"), known = sim::high_resolution();
  EXPECT_EQ(high.camera.width, known.camera.width);
  EXPECT_DOUBLE_EQ(high.camera.horizontal_fov, known.camera.horizontal_fov);
  EXPECT_DOUBLE_EQ(high.camera.vertical_fov, known.camera.vertical_fov);
  EXPECT_EQ(high.noise.sigma, known.noise.sigma);
  // sigma_z = s z^2 / (f B): 3.8 mm at 1 m.
  const sim::StereoErrors stereo = camera("intel_d435").stereo;
  EXPECT_NEAR(stereo.disparity_sigma_px / (stereo.focal_length_px * stereo.baseline), 3.8e-3, 5e-5);
}

// `plan` and `scan` share one list of presets. An error for the wrong kind names the right key.
TEST(SensorPresets, AreOneListForPlanAndScan) {
  EXPECT_EQ(config::find_camera("d435").name, config::find_sensor("see_d435").name);
  EXPECT_EQ(config::find_sensor("high_resolution").name,
            "High-resolution sensor of the SEE++ experiments");
  EXPECT_EQ(
      std::get<DepthCameraConfig>(config::find_camera("dji_mavic_3e_wide").sensor).camera.width,
      5280);
  const auto error_message = [](const std::string& name) {
    return testing_support::thrown_message([&] { config::find_camera(name); });
  };
  EXPECT_EQ(error_message("dji_zenmuse_l2"),
            "dji_zenmuse_l2 is a LiDAR; set sensor.lidar: dji_zenmuse_l2 instead of sensor.preset");
  EXPECT_THAT(error_message("d345"),
              HasSubstr("unknown camera d345; expected one of: d435, high_res"));
  EXPECT_THAT(error_message("mine.yaml"), HasSubstr("must be the name of a preset"));
}

TEST(SensorPresets, RealDepthCamerasStateTheirUsefulRange) {
  for (const char* name : {"d435", "intel_d435"}) {
    const auto useful = config::find_camera(name).useful_range;
    ASSERT_TRUE(useful) << name;
    EXPECT_EQ(useful->min, 0.3);
    EXPECT_EQ(useful->max, 3.0);
  }
  EXPECT_FALSE(config::find_camera("high_resolution").useful_range);
}

void expect_message(const std::string& text, const char* message) {
  try {
    config::read_sensor(text, "my.yaml");
    FAIL() << "accepted: " << message;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_config);
    EXPECT_THAT(error.what(), HasSubstr(message));
  }
}

constexpr const char* scanner_text =
    "name: test\nkind: spinning\nrotation_rate_hz: 10\nfiring_period_us: 50\n"
    "channels: {count: 2, lowest_deg: -1, highest_deg: 1}\nrange: {min: 1, max: 100}\n";
constexpr const char* camera_text =
    "name: test\nkind: camera\nhorizontal_fov_deg: 60\nvertical_fov_deg: 40\n"
    "range: {min: 0.1, max: 10}\n";
constexpr const char* table_text =
    "{range: [1, 20], incidence_deg: [0, 60], reflectance: [0.1, 0.8], "
    "sigma: [1, 2, 3, 4, 5, 6, 7, 8]}";

std::string sensor_error(const std::string& text) {
  return testing_support::thrown_message([&] { config::read_sensor(text, "sensor.yaml"); });
}

TEST(ReadSensor, ReadsNoiseTables) {
  const auto expect_table = [](const sim::NoiseTable& table) {
    ASSERT_TRUE(table.is_on());
    EXPECT_NEAR(table.sigma(20.0, std::cos(60.0 * degree), 0.1), 7.0, 1e-5);
    EXPECT_NEAR(table.sigma(1.0, std::cos(60.0 * degree), 0.8), 4.0, 1e-5);
    EXPECT_NEAR(table.sigma(20.0, 1.0, 0.1), 5.0, 1e-5);
  };
  const auto scanner =
      config::read_sensor(scanner_text + ("errors: {table: " + std::string(table_text)) + "}", "a");
  expect_table(lidar(scanner).errors.table);
  const auto camera =
      config::read_sensor(camera_text + ("noise: {table: " + std::string(table_text)) + "}", "a");
  const sim::NoiseConfig& noise = std::get<DepthCameraConfig>(camera.sensor).noise;
  expect_table(noise.table);
  EXPECT_EQ(noise.sigma, 0.0);
  const auto plain = config::read_sensor(
      scanner_text + std::string("errors: {table: {range: [10], sigma: [0.02]}}"), "a");
  EXPECT_FLOAT_EQ(lidar(plain).errors.table.sigma(3.0, 0.2, 0.3), 0.02F);
}

TEST(ReadSensor, RejectsInvalidNoiseTables) {
  const auto error = [](const std::string& errors) {
    return sensor_error(scanner_text + ("errors: " + errors + "\n"));
  };
  EXPECT_THAT(error("{sigma: 0.1, table: {range: [1], sigma: [1]}}"),
              HasSubstr("conflicts with table"));
  EXPECT_THAT(error("{table: {sigma: [1]}}"), HasSubstr("must list at least one range"));
  EXPECT_THAT(error("{table: {range: [1, 2], sigma: [1]}}"),
              HasSubstr("sensor.yaml: errors.table.sigma lists 1 values"));
  EXPECT_THAT(error("{table: {range: [2, 1], sigma: [1, 2]}}"), HasSubstr("in ascending order"));
  EXPECT_THAT(error("{table: {range: [1], sigmas: [1]}}"), HasSubstr("sigma"));
  EXPECT_THAT(error("{table: {range: [1], incidence_deg: [95], sigma: [1]}}"),
              HasSubstr("errors.table.incidence contains"));
}

TEST(ReadSensor, ReportsFileLineAndKeyOfErrors) {
  const std::string head = "name: X\nkind: spinning\n";
  expect_message("name: X\n", "my.yaml:1: key kind is missing");
  expect_message("name: X\nkind: sonar\n", "my.yaml:2: key kind is sonar; it must be one of");
  expect_message(head, "my.yaml:1: key rotation_rate_hz is missing");
  const std::string turning = head + "rotation_rate_hz: 10\nfiring_period_us: 50\n";
  expect_message(turning + "wings: 2\n", "my.yaml:5: key wings is unknown; expected one of:");
  expect_message(turning + "range: {min: near, max: 9}\n",
                 "my.yaml:5: key range.min must be a number");
  expect_message(turning + "range: {min: 1, max: 9, middle: 5}\n", "key range.middle is unknown");
  expect_message(turning + "channels:\n  elevation_deg: [1, 2]\n  delay_us: [0]\n",
                 "my.yaml:7: key channels.delay_us has 1 numbers for 2 channels");
  expect_message(turning + "channels: {count: 1, lowest_deg: 0, highest_deg: 1}\n",
                 "my.yaml:5: key channels.count must be between 2 and 1024");
  expect_message(turning + "returns: {max: 1.5, choice: first}\n", "must be an integer");
  expect_message(turning + "range: 5\n", "my.yaml:5: key range must be a map");
  expect_message(turning + "range: {min: 9, max: 1}\n", "my.yaml: max_range is 1");
  expect_message("name: X\nkind: rosette\nfiring_period_us: 10\n", "key prisms must list");
}

TEST(FindSensor, ListsKnownSensorsWhenUnknown) {
  try {
    config::find_sensor("ouster");
    FAIL() << "found";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("expected one of: dji_m30t_wide"));
  }
  EXPECT_THAT(testing_support::thrown_message([&] { config::find_sensor("no/such/file.yaml"); }),
              testing::HasSubstr("no/such/file.yaml: "));
}

}  // namespace
}  // namespace skycap::missions
