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
using geometry::View;

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

std::uint64_t firings_in_turn(const sim::LidarConfig& lidar) {
  return static_cast<std::uint64_t>(std::ceil(2.0 * std::numbers::pi / azimuth_step(lidar)));
}

/// Turn after turn, each from a pose of the scanner, world_from_scanner; `first_turn` numbers them.
void append_turns(const sim::Lidar& lidar, const sim::Scene& scene,
                  const std::vector<Eigen::Isometry3d>& poses, const Carriage& carriage,
                  std::uint64_t first_turn, unsigned threads,
                  std::vector<Eigen::Vector3f>& points) {
  const std::uint64_t firings = firings_in_turn(lidar.config());
  constexpr std::uint64_t firings_in_task = 128;
  const std::uint64_t tasks = (firings + firings_in_task - 1) / firings_in_task;
  const auto standing = [](const Eigen::Isometry3d& pose) {
    return sim::Trajectory(
        {{.position = pose.translation(), .attitude = Eigen::Quaterniond(pose.linear())}});
  };
  std::vector<sim::Trajectory> flown, believed;
  for (const Eigen::Isometry3d& pose : poses) {
    flown.push_back(standing(carriage.true_pose(pose)));
    believed.push_back(standing(pose));
  }
  std::vector<sim::LidarReturns> returns(tasks * poses.size());
  geometry::parallel_for(returns.size(), threads, [&](std::size_t task) {
    const std::size_t turn = task / tasks;
    const std::uint64_t first = task % tasks * firings_in_task;
    returns[task] = lidar.measure(
        scene, {flown[turn], believed[turn]},
        {(first_turn + turn) * firings + first, std::min(firings_in_task, firings - first)});
  });
  for (const sim::LidarReturns& part : returns) {
    for (const Eigen::Vector3f& point : part.points) {
      points.emplace_back((part.origin + point.cast<double>()).cast<float>());
    }
  }
}

/// An image as wide and as high as these angles, with a pixel to each ray in its middle.
sim::DepthCameraConfig ray_camera(const sim::LidarConfig& lidar, double wide, double columns_step,
                                  double high, double rows_step) {
  // As many pixels as make the middle of the image as dense as the rays.
  const auto pixels = [](double angle, double step) {
    return std::max(1, static_cast<int>(std::lround(2.0 * std::tan(0.5 * angle) / step)));
  };
  sim::DepthCameraConfig config;
  config.camera = {.width = pixels(wide, columns_step),
                   .height = pixels(high, rows_step),
                   .horizontal_fov = wide,
                   .vertical_fov = high,
                   .min_range = lidar.min_range,
                   .max_range = lidar.max_range};
  config.noise.sigma = lidar.errors.sigma;
  config.noise.direction = sim::NoiseDirection::along_ray;
  return config;
}

/// Of a scanner, by its description.
struct Field {
  double around, around_step;  ///< what is looked at of a turn, and the angle between firings [rad]
  double up, up_step;          ///< across the turn, and between neighbouring lasers
};

Field field_of(const sim::LidarConfig& lidar) {
  const auto [lowest, highest] = elevations(lidar);
  if (!lidar.prisms.empty() || lidar.rotation_rate == 0.0) {
    throw Error(ErrorKind::bad_config,
                "this scanner does not spin; a survey needs one that does, such as ouster_os1_128");
  }
  if (highest - lowest < 0.01) {
    throw Error(ErrorKind::bad_config,
                "this scanner measures a line, not a field; a survey needs one with several "
                "lasers, such as ouster_os1_128");
  }
  const double step = (highest - lowest) / static_cast<double>(lidar.channels.size() - 1);
  return {std::min(lidar.field_of_view, 0.5 * std::numbers::pi), azimuth_step(lidar),
          highest - lowest + step, step};
}

Eigen::Isometry3d world_from_body(const View& nose) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = nose.position;
  pose.linear() =
      Eigen::AngleAxisd(std::atan2(nose.direction.y(), nose.direction.x()), Vector3d::UnitZ())
          .toRotationMatrix();
  return pose;
}

/// Of the scanner's axis in the level plane of the body's frame.
double axis_azimuth(const Eigen::Isometry3d& mount) {
  const Vector3d axis = mount.linear().col(2);
  return std::atan2(axis.y(), axis.x());
}

View turned_level(const Vector3d& position, const Vector3d& direction, double angle) {
  const Vector3d level(direction.x(), direction.y(), 0.0);
  return {position, Eigen::AngleAxisd(angle, Vector3d::UnitZ()) * level.normalized()};
}

}  // namespace

sim::DepthCameraConfig forward_camera(const sim::LidarConfig& lidar) {
  const Field field = field_of(lidar);
  return ray_camera(lidar, field.around, field.around_step, field.up, field.up_step);
}

sim::DepthCameraConfig side_camera(const sim::LidarConfig& lidar, std::size_t turns) {
  const Field field = field_of(lidar);
  // Across the axis is the middle of the image, though not of the lasers if more of them look ahead
  // than back: as wide as there are lasers on both sides.
  const auto [lowest, highest] = elevations(lidar);
  const double wide = 2.0 * std::max(std::min(-lowest, highest), field.up_step) + field.up_step;
  const double denser = std::sqrt(static_cast<double>(turns));  // each way
  return ray_camera(lidar, wide, field.up_step / denser, field.around, field.around_step / denser);
}

std::size_t turns_of(const file::SensorConfig& sensor) {
  if (!sensor.mount || !sensor.is_moving()) return 1;
  const double turns = sensor.frame_period * std::abs(sensor.scanner->rotation_rate);
  return static_cast<std::size_t>(std::max(1L, std::lround(turns)));
}

double ray_spacing(const sim::LidarConfig& lidar) {
  std::vector<double> lasers;
  for (const sim::Channel& channel : lidar.channels) lasers.push_back(channel.elevation);
  std::ranges::sort(lasers);
  double spacing = azimuth_step(lidar);
  for (std::size_t i = 1; i < lasers.size(); ++i) {
    spacing = std::max(spacing, lasers[i] - lasers[i - 1]);
  }
  return spacing;
}

double range_noise(const sim::LidarConfig& lidar, double range) {
  const auto& errors = lidar.errors;
  return std::hypot(errors.sigma, errors.sigma_per_metre * range,
                    errors.sigma_per_square_metre * range * range);
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
  sensor.scanner = *lidar;
  sensor.camera = sensor.mount ? side_camera(*lidar, turns_of(sensor)) : forward_camera(*lidar);
}

Eigen::Quaterniond rotation_of(const Vector3d& angles) {
  return Eigen::AngleAxisd(angles.z(), Vector3d::UnitZ()) *
         Eigen::AngleAxisd(angles.y(), Vector3d::UnitY()) *
         Eigen::AngleAxisd(angles.x(), Vector3d::UnitX());
}

Eigen::Isometry3d mount_of(const file::ScanConfig& scan) {
  Eigen::Isometry3d mount(rotation_of(scan.mount_rotation));
  mount.translation() = scan.mount_position;
  return mount;
}

View nose_view(const Eigen::Isometry3d& mount, const View& view) {
  const Vector3d axis = geometry::camera_pose(view).linear().col(0);  // level, to the right
  return turned_level(view.position, axis, -axis_azimuth(mount));
}

View side_view(const Eigen::Isometry3d& mount, const View& nose) {
  return turned_level(nose.position, nose.direction, axis_azimuth(mount) + 0.5 * std::numbers::pi);
}

Eigen::Isometry3d Carriage::true_pose(const Eigen::Isometry3d& believed) const {
  if (turn.isZero(0.0) && shift.isZero(0.0)) return believed;
  Eigen::Isometry3d pose(rotation_of(turn) * believed.linear());
  pose.translation() = believed.translation() + shift;
  return pose;
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
      }()),
      shutter_(config.shutter) {
  if (!config.scanner || !config.mount) return;
  mount_ = config.mount;
  turns_ = turns_of(config);
}

std::vector<Eigen::Isometry3d> SurveySensor::turns(const View& view) const {
  const sim::LidarConfig& lidar = std::get<sim::Lidar>(sensor_).config();
  if (!mount_) return {geometry::camera_pose(view) * scanner_from_optical(lidar).inverse()};
  // The rays of turns on a way fall between each other's: spread by the R2 sequence, along the axis
  // (some rays of a turn are as far apart at twenty metres) and between two firings.
  constexpr double first_ratio = 0.7548776662466927, second_ratio = 0.5698402909980532;
  const Eigen::Isometry3d world_from_scanner = world_from_body(nose_view(*mount_, view)) * *mount_;
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t turn = 0; turn < turns_; ++turn) {
    const auto share = [&](double ratio) {
      const double sum = ratio * static_cast<double>(turn);
      return sum - std::floor(sum);
    };
    Eigen::Isometry3d pose = world_from_scanner;
    pose.translation() += spread_of_turns * (share(first_ratio) - 0.5) * pose.linear().col(2);
    pose.rotate(Eigen::AngleAxisd(share(second_ratio) * azimuth_step(lidar), Vector3d::UnitZ()));
    poses.push_back(pose);
  }
  return poses;
}

geometry::Scan SurveySensor::scan(const sim::Scene& scene, const View& view, std::uint64_t frame,
                                  unsigned threads, geometry::Scan recycled) const {
  return scan(scene, view, {}, frame, threads, std::move(recycled));
}

geometry::Scan SurveySensor::scan(const sim::Scene& scene, const View& view,
                                  const Carriage& carriage, std::uint64_t frame, unsigned threads,
                                  geometry::Scan recycled) const {
  if (const auto* lidar = std::get_if<sim::Lidar>(&sensor_)) {
    geometry::Scan scan = std::move(recycled);
    scan.world_from_sensor = geometry::camera_pose(view);
    scan.points.clear();
    scan.pixels.clear();
    append_turns(*lidar, scene, turns(view), carriage, frame * turns_, threads, scan.points);
    return scan;
  }
  const auto& camera = std::get<sim::DepthCamera>(sensor_);
  const Eigen::Isometry3d believed = geometry::camera_pose(view);
  if (carriage.instants == 0 && carriage.shift.isZero(0.0) && carriage.turn.isZero(0.0)) {
    return camera.scan(scene, believed, frame, threads, std::move(recycled));
  }
  sim::FrameMotion motion{.world_from_camera = carriage.true_pose(believed)};
  if (carriage.instants > 0) {
    motion.velocity = carriage.velocity;
    motion.turn_rate = carriage.turn_rate;
    motion.exposure = shutter_.exposure;
    motion.readout = shutter_.readout;
    motion.instants = carriage.instants;
  }
  return camera.scan(scene, believed, motion, frame, threads, std::move(recycled));
}

}  // namespace skycap::missions::derived
