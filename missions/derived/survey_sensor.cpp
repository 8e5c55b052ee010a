#include "missions/derived/survey_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "missions/equipment/preset_files.h"
#include "missions/equipment/sensor_reader.h"
#include "sim/sensors/trajectory.h"

namespace skycap::missions::derived {
namespace {

using Eigen::Vector3d;

struct Elevations {
  double lowest, highest;  // of the lasers [rad]
};

Elevations elevations(const sim::LidarConfig& lidar) {
  const auto [lowest, highest] =
      std::ranges::minmax_element(lidar.channels, {}, &sim::Channel::elevation);
  return {lowest->elevation, highest->elevation};
}

/// Of the optical frame in the scanner's (x forward, y left, z up): the axis is level in azimuth
/// and in the middle of the lasers.
Eigen::Isometry3d scanner_from_optical(const sim::LidarConfig& lidar) {
  const auto [lowest, highest] = elevations(lidar);
  const double middle = 0.5 * (lowest + highest);
  const Vector3d forward(std::cos(middle), 0.0, std::sin(middle)), right(0.0, -1.0, 0.0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << right, forward.cross(right), forward;
  return pose;
}

/// Angle that the scanner turns between two firings [rad].
double azimuth_step(const sim::LidarConfig& lidar) {
  return 2.0 * std::numbers::pi * std::abs(lidar.rotation_rate) * lidar.firing_period;
}

geometry::Scan sweep(const sim::Lidar& lidar, const sim::Scene& scene, const geometry::View& view,
                     std::uint64_t frame, unsigned threads, geometry::Scan recycled) {
  geometry::Scan scan = std::move(recycled);
  scan.world_from_sensor = geometry::camera_pose(view);
  scan.points.clear();
  scan.pixels.clear();

  const sim::Trajectory standing(
      {{.position = scan.world_from_sensor.translation(),
        .attitude = Eigen::Quaterniond(scan.world_from_sensor.linear())}});
  const Eigen::Isometry3d optical_from_scanner = scanner_from_optical(lidar.config()).inverse();
  const sim::LidarFlight flight{standing, standing, optical_from_scanner, optical_from_scanner};

  const auto firings =
      static_cast<std::uint64_t>(std::ceil(2.0 * std::numbers::pi / azimuth_step(lidar.config())));
  constexpr std::uint64_t firings_in_task = 128;
  std::vector<sim::LidarReturns> returns((firings + firings_in_task - 1) / firings_in_task);
  geometry::parallel_for(returns.size(), threads, [&](std::size_t task) {
    const std::uint64_t first = task * firings_in_task;
    returns[task] = lidar.measure(
        scene, flight, {frame * firings + first, std::min(firings_in_task, firings - first)});
  });
  for (const sim::LidarReturns& part : returns) {
    for (const Eigen::Vector3f& point : part.points) {
      scan.points.emplace_back((part.origin + point.cast<double>()).cast<float>());
    }
  }
  return scan;
}

}  // namespace

sim::DepthCameraConfig forward_camera(const sim::LidarConfig& lidar) {
  const auto [lowest, highest] = elevations(lidar);
  if (!lidar.prisms.empty() || lidar.rotation_rate == 0.0) {
    throw Error(ErrorKind::bad_config,
                "this scanner does not spin; a survey from standing views needs one that does, "
                "such as ouster_os1_128");
  }
  if (highest - lowest < 0.01) {
    throw Error(ErrorKind::bad_config,
                "this scanner measures a line, not a field; a survey from standing views needs one "
                "with several lasers, such as ouster_os1_128");
  }
  const double elevation_step = (highest - lowest) / static_cast<double>(lidar.channels.size() - 1);
  const double around = std::min(lidar.field_of_view, 0.5 * std::numbers::pi);
  const double up = highest - lowest + elevation_step;
  // As many pixels as make the middle of the image as dense as the rays.
  const auto pixels = [](double angle, double step) {
    return std::max(1, static_cast<int>(std::lround(2.0 * std::tan(0.5 * angle) / step)));
  };
  sim::DepthCameraConfig config;
  config.camera = {.width = pixels(around, azimuth_step(lidar)),
                   .height = pixels(up, elevation_step),
                   .horizontal_fov = around,
                   .vertical_fov = up,
                   .min_range = lidar.min_range,
                   .max_range = lidar.max_range};
  config.noise.sigma = lidar.errors.sigma;
  config.noise.direction = sim::NoiseDirection::along_ray;
  return config;
}

void use_lidar(file::SensorConfig& sensor, const std::filesystem::path& folder) {
  const std::string& name = sensor.lidar.value();
  const equipment::SensorDescription description =
      equipment::find_sensor(equipment::named_from(folder, name));
  const auto* lidar = std::get_if<sim::LidarConfig>(&description.sensor);
  if (lidar == nullptr) {
    throw Error(ErrorKind::bad_config,
                description.name + " is a camera; give its values as the other keys of sensor");
  }
  sensor.camera = forward_camera(*lidar);
  sensor.scanner = *lidar;
}

SurveySensor::SurveySensor(const file::SensorConfig& config, std::uint64_t seed)
    : sensor_([&]() -> std::variant<sim::DepthCamera, sim::Lidar> {
        if (config.scanner) {
          sim::LidarConfig lidar = *config.scanner;
          lidar.seed = seed;
          return sim::Lidar(lidar);
        }
        sim::DepthCameraConfig camera = config.camera;
        camera.noise.seed = seed;
        return sim::DepthCamera(camera);
      }()) {}

geometry::Scan SurveySensor::scan(const sim::Scene& scene, const geometry::View& view,
                                  std::uint64_t frame, unsigned threads,
                                  geometry::Scan recycled) const {
  if (const auto* lidar = std::get_if<sim::Lidar>(&sensor_)) {
    return sweep(*lidar, scene, view, frame, threads, std::move(recycled));
  }
  return std::get<sim::DepthCamera>(sensor_).scan(scene, view, frame, threads, std::move(recycled));
}

}  // namespace skycap::missions::derived
