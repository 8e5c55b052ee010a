#include "sim/sensors/survey_sensor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "geometry/error.h"
#include "geometry/parallel.h"
#include "sim/sensors/trajectory.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;
using geometry::View;

/// Returns the optical frame in the scanner's frame (x forward, y left, z up). The optical axis is
/// at azimuth zero, in the middle of the lasers.
Eigen::Isometry3d scanner_from_optical(const LidarConfig& lidar) {
  const auto [min_elevation, max_elevation] = elevations(lidar);
  const double middle = 0.5 * (min_elevation + max_elevation);
  const Vector3d forward(std::cos(middle), 0.0, std::sin(middle)), right(0.0, -1.0, 0.0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() << right, forward.cross(right), forward;
  return pose;
}

std::uint64_t firings_in_turn(const LidarConfig& lidar) {
  return static_cast<std::uint64_t>(std::ceil(2.0 * std::numbers::pi / azimuth_step(lidar)));
}

void append(const std::vector<LidarReturns>& returns, std::vector<Eigen::Vector3f>& points) {
  for (const LidarReturns& part : returns) {
    for (const Eigen::Vector3f& point : part.points) {
      points.emplace_back((part.origin + point.cast<double>()).cast<float>());
    }
  }
}

/// Adds one revolution per scanner pose (world_from_scanner). `first_turn` is the number of the
/// first one.
void append_turns(const Lidar& lidar, const Scene& scene,
                  const std::vector<Eigen::Isometry3d>& poses,
                  const PlatformMotion& platform_motion, std::uint64_t first_turn, unsigned threads,
                  std::vector<Eigen::Vector3f>& points) {
  const std::uint64_t firings = firings_in_turn(lidar.config());
  constexpr std::uint64_t firings_in_task = 128;
  const std::uint64_t tasks = (firings + firings_in_task - 1) / firings_in_task;
  const auto standing = [](const Eigen::Isometry3d& pose) {
    return Trajectory(
        {{.position = pose.translation(), .attitude = Eigen::Quaterniond(pose.linear())}});
  };
  std::vector<Trajectory> ground_truth, estimated;
  for (const Eigen::Isometry3d& pose : poses) {
    ground_truth.push_back(standing(platform_motion.true_pose(pose)));
    estimated.push_back(standing(pose));
  }
  std::vector<LidarReturns> returns(tasks * poses.size());
  geometry::parallel_for(returns.size(), threads, [&](std::size_t task) {
    const std::size_t turn = task / tasks;
    const std::uint64_t first = task % tasks * firings_in_task;
    returns[task] = lidar.measure(
        scene, {ground_truth[turn], estimated[turn]},
        {(first_turn + turn) * firings + first, std::min(firings_in_task, firings - first)});
  });
  append(returns, points);
}

Eigen::Isometry3d world_from_body(const View& nose) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = nose.position;
  pose.linear() =
      Eigen::AngleAxisd(std::atan2(nose.direction.y(), nose.direction.x()), Vector3d::UnitZ())
          .toRotationMatrix();
  return pose;
}

/// Returns the body trajectory between two nose views during [`begin`, `end`] [s]. Time starts with
/// firing zero, and the body is stationary before and after.
Trajectory make_trajectory(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to, double begin,
                           double end) {
  const auto stamped = [](double time, const Eigen::Isometry3d& pose) {
    return StampedPose{time, pose.translation(), Eigen::Quaterniond(pose.linear())};
  };
  std::vector<StampedPose> poses{stamped(begin, from), stamped(end, to)};
  if (begin > 0.0) poses.insert(poses.begin(), stamped(0.0, from));
  return Trajectory(std::move(poses));
}

}  // namespace

std::size_t count_revolutions(const SurveySensorOptions& sensor) {
  if (!sensor.mount || !sensor.is_moving()) return 1;
  const double turns = sensor.frame_period * std::abs(sensor.scanner->rotation_rate);
  return static_cast<std::size_t>(std::max(1L, std::lround(turns)));
}

geometry::ScannerMount scanner_mount(const LidarConfig& lidar,
                                     const Eigen::Isometry3d& body_from_scanner) {
  if (find_scanner_kind(lidar) == ScannerKind::rosette) {
    const Vector3d boresight = body_from_scanner.linear().col(0);
    return {body_from_scanner, std::atan2(boresight.y(), boresight.x()),
            std::asin(std::clamp(boresight.z(), -1.0, 1.0))};
  }
  const Vector3d axis = body_from_scanner.linear().col(2);
  return {body_from_scanner, std::atan2(axis.y(), axis.x()) + 0.5 * std::numbers::pi, 0.0};
}

DepthCameraConfig planning_camera(const SurveySensorOptions& sensor,
                                  const std::optional<RosetteField>& rosette) {
  const LidarConfig& lidar = sensor.scanner.value();
  if (!sensor.mount) return forward_camera(lidar);
  switch (find_scanner_kind(lidar)) {
    case ScannerKind::ring:
      return side_camera(lidar, count_revolutions(sensor));
    case ScannerKind::line:
      return line_camera(lidar, sensor.frame_period,
                         static_cast<double>(count_revolutions(sensor)) * azimuth_step(lidar));
    case ScannerKind::rosette:
      break;
  }
  return rosette_camera(lidar, rosette.value());
}

std::optional<RosetteField> compute_rosette_field(const SurveySensorOptions& sensor) {
  if (!sensor.mount || find_scanner_kind(sensor.scanner.value()) != ScannerKind::rosette)
    return std::nullopt;
  const geometry::ScannerMount& mount = *sensor.mount;
  const View boresight = geometry::scanner_view(mount, {Vector3d::Zero(), Vector3d::UnitX()});
  return rosette_field(
      sensor.scanner.value(), sensor.is_moving() ? sensor.frame_period : rosette_period,
      geometry::camera_pose(boresight).linear().transpose() * mount.body_from_scanner.linear());
}

Eigen::Isometry3d PlatformMotion::true_pose(const Eigen::Isometry3d& estimated) const {
  if (is_exact()) return estimated;
  Eigen::Isometry3d pose(geometry::make_rotation(turn) * estimated.linear());
  pose.translation() = estimated.translation() + shift;
  return pose;
}

SurveySensor::SurveySensor(const SurveySensorOptions& config, std::uint64_t seed)
    : sensor_([&]() -> std::variant<DepthCamera, Lidar> {
        if (config.scanner) {
          LidarConfig lidar = *config.scanner;
          lidar.seed = seed;
          return Lidar(lidar);
        }
        DepthCameraConfig camera = config.camera;
        camera.noise.seed = seed;
        return DepthCamera(camera);
      }()),
      shutter_(config.shutter) {
  if (!config.scanner) return;
  kind_ = find_scanner_kind(*config.scanner);
  if (!config.mount) return;
  mount_ = config.mount;
  turns_ = count_revolutions(config);
  if (config.is_moving()) period_ = config.frame_period;
}

std::vector<Eigen::Isometry3d> SurveySensor::turns(const View& view) const {
  const LidarConfig& lidar = std::get<Lidar>(sensor_).config();
  if (!mount_) return {geometry::camera_pose(view) * scanner_from_optical(lidar).inverse()};
  // The rays of successive revolutions interleave. The R2 sequence distributes them along the axis
  // and between two firings. At 20 m, some rays of one revolution are as far apart as this spread.
  constexpr double first_ratio = 0.7548776662466927, second_ratio = 0.5698402909980532;
  const Eigen::Isometry3d world_from_scanner =
      world_from_body(geometry::nose_view(*mount_, view)) * mount_->body_from_scanner;
  std::vector<Eigen::Isometry3d> poses;
  for (std::size_t turn = 0; turn < turns_; ++turn) {
    const auto share = [&](double ratio) {
      const double sum = ratio * static_cast<double>(turn);
      return sum - std::floor(sum);
    };
    Eigen::Isometry3d pose = world_from_scanner;
    pose.translation() += revolution_spread * (share(first_ratio) - 0.5) * pose.linear().col(2);
    pose.rotate(Eigen::AngleAxisd(share(second_ratio) * azimuth_step(lidar), Vector3d::UnitZ()));
    poses.push_back(pose);
  }
  return poses;
}

void SurveySensor::measure_en_route(const Lidar& lidar, const Scene& scene, const View& view,
                                    const PlatformMotion& platform_motion, std::uint64_t frame,
                                    unsigned threads, std::vector<Eigen::Vector3f>& points) const {
  // Maximum duration of a stretch in periods, so that scans do not share firings.
  constexpr double max_periods = 2.0;
  const double firing = lidar.config().firing_period;
  const auto apart = static_cast<std::uint64_t>(std::ceil(max_periods * period_ / firing));
  Eigen::Isometry3d from =
      geometry::camera_pose(view) * scanner_from_optical(lidar.config()).inverse();
  if (mount_) from = world_from_body(geometry::nose_view(*mount_, view));
  Eigen::Isometry3d to = from;
  // At rest, one revolution of a line contains all measurable points.
  double duration =
      kind_ == ScannerKind::line ? 1.0 / std::abs(lidar.config().rotation_rate) : period_;
  if (platform_motion.stretch) {
    from = world_from_body(platform_motion.stretch->from);
    to = world_from_body(platform_motion.stretch->to);
    duration = platform_motion.stretch->duration;
  }
  const auto count = std::clamp<std::uint64_t>(
      static_cast<std::uint64_t>(std::llround(duration / firing)), 1, apart);
  const double begin = static_cast<double>(frame * apart) * firing;
  const double end = begin + static_cast<double>(count) * firing;
  const Trajectory estimated = make_trajectory(from, to, begin, end);
  const Trajectory ground_truth =
      make_trajectory(platform_motion.true_pose(from), platform_motion.true_pose(to), begin, end);
  const Eigen::Isometry3d body_from_scanner =
      mount_ ? mount_->body_from_scanner : Eigen::Isometry3d::Identity();
  const LidarFlight flight{ground_truth, platform_motion.is_exact() ? ground_truth : estimated,
                           body_from_scanner, body_from_scanner};
  constexpr std::uint64_t firings_in_task = 4096;
  std::vector<LidarReturns> returns((count + firings_in_task - 1) / firings_in_task);
  geometry::parallel_for(returns.size(), threads, [&](std::size_t task) {
    const std::uint64_t first = task * firings_in_task;
    returns[task] = lidar.measure(
        scene, flight, {frame * apart + first, std::min(firings_in_task, count - first)});
  });
  append(returns, points);
}

geometry::Scan SurveySensor::scan(const Scene& scene, const View& view, std::uint64_t frame,
                                  unsigned threads, geometry::Scan buffer) const {
  return scan(scene, view, {}, frame, threads, std::move(buffer));
}

geometry::Scan SurveySensor::scan(const Scene& scene, const View& view,
                                  const PlatformMotion& platform_motion, std::uint64_t frame,
                                  unsigned threads, geometry::Scan buffer) const {
  if (const auto* lidar = std::get_if<Lidar>(&sensor_)) {
    geometry::Scan scan = std::move(buffer);
    // A sensor fixed to the vehicle looks in the direction of its mount, regardless of the
    // requested view.
    const bool is_fixed = mount_ && kind_ == ScannerKind::rosette;
    scan.world_from_sensor = geometry::camera_pose(
        is_fixed ? geometry::scanner_view(*mount_, geometry::nose_view(*mount_, view)) : view);
    scan.points.clear();
    scan.pixels.clear();
    if (kind_ == ScannerKind::ring) {
      append_turns(*lidar, scene, turns(view), platform_motion, frame * turns_, threads,
                   scan.points);
    } else {
      measure_en_route(*lidar, scene, view, platform_motion, frame, threads, scan.points);
    }
    return scan;
  }
  const auto& camera = std::get<DepthCamera>(sensor_);
  const Eigen::Isometry3d estimated = geometry::camera_pose(view);
  if (platform_motion.instants == 0 && platform_motion.is_exact()) {
    return camera.scan(scene, estimated, frame, threads, std::move(buffer));
  }
  FrameMotion motion{.world_from_camera = platform_motion.true_pose(estimated)};
  if (platform_motion.instants > 0) {
    motion.velocity = platform_motion.velocity;
    motion.turn_rate = platform_motion.turn_rate;
    motion.exposure = shutter_.exposure;
    motion.readout = shutter_.readout;
    motion.instants = platform_motion.instants;
  }
  return camera.scan(scene, estimated, motion, frame, threads, std::move(buffer));
}

namespace {

/// Returns the point rate per metre along and across the path, at the view distance [1/(s m^2)].
double points_abeam(const SurveySensorOptions& sensor, double distance) {
  const LidarConfig& lidar = *sensor.scanner;
  const double swath = 2.0 * distance * std::tan(0.5 * sensor.camera.camera.horizontal_fov);
  switch (find_scanner_kind(lidar)) {
    case ScannerKind::ring: {
      const geometry::Camera camera(side_camera(lidar).camera);
      const double rays = camera.focal_length_px().prod() / (distance * distance);  // Per m^2.
      return swath * std::abs(lidar.rotation_rate) * rays;
    }
    case ScannerKind::line:
      return std::abs(lidar.rotation_rate) / (distance * azimuth_step(lidar));
    case ScannerKind::rosette:
      break;
  }
  const geometry::Camera camera(sensor.camera.camera);
  const double period = sensor.is_moving() ? sensor.frame_period : rosette_period;
  return swath * camera.focal_length_px().prod() / (distance * distance) / period;
}

}  // namespace

double scanning_speed(const SurveySensorOptions& sensor, double distance, double spacing,
                      double fastest) {
  // Lines are even and do not overlap, so most of their points are stored.
  const bool is_even = find_scanner_kind(*sensor.scanner) == ScannerKind::line;
  const double apart = (is_even ? 1.0 : 0.5) * spacing;
  return std::min(points_abeam(sensor, distance) * apart * apart, 0.5 * fastest);
}

}  // namespace skycap::sim
