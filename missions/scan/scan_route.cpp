#include "missions/scan/scan_route.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "flight/export/export.h"
#include "flight/export/text.h"
#include "flight/export/trajectory_file.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/pose/pose.h"
#include "missions/support/number_text.h"

namespace skycap::missions::scan {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using geometry::View;

sim::StampedPose stamped(double time, const Isometry3d& world_from_body) {
  return {time, world_from_body.translation(), Quaterniond(world_from_body.linear())};
}

sim::StampedPose level_pose(double time, const Vector3d& position, double heading) {
  return {time, position, Quaterniond(AngleAxisd(heading, Vector3d::UnitZ()))};
}

/// Returns the pose of the platform at a view. Headings are counter-clockwise from east.
sim::StampedPose pose_at(double time, const View& view, Platform platform) {
  if (platform == Platform::airframe) {
    return level_pose(time, view.position, std::atan2(view.direction.y(), view.direction.x()));
  }
  return stamped(time, geometry::camera_pose(view) * body_from_camera().inverse());
}

ScanRoute from_tum(const std::string& text) {
  std::vector<sim::StampedPose> poses;
  for (const flight::TimedPose& pose : flight::read_tum(text)) {
    poses.push_back(stamped(pose.time, pose.world_from_camera * body_from_camera().inverse()));
  }
  return {sim::Trajectory(std::move(poses)), {}};
}

ScanRoute from_states(const std::vector<flight::TimedState>& states, Platform platform) {
  const std::vector<flight::TimedPose> cameras = flight::camera_poses(states);
  std::vector<sim::StampedPose> poses;
  std::vector<double> image_times;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const flight::TimedState& state = states[i];
    if (state.is_capture) image_times.push_back(state.time);
    poses.push_back(
        platform == Platform::gimbal
            ? stamped(state.time, cameras[i].world_from_camera * body_from_camera().inverse())
            : level_pose(state.time, state.position, 0.5 * std::numbers::pi - state.yaw));
  }
  return {sim::Trajectory(std::move(poses)), std::move(image_times)};
}

std::vector<View> parse_views(const std::string& text) {
  const std::vector<std::string> lines = flight::split_lines(text);
  std::vector<View> views;
  for (std::size_t line = 1; line < lines.size(); ++line) {
    if (lines[line].empty()) continue;
    const std::string location = "line " + std::to_string(line + 1);
    const std::vector<std::string> fields = flight::split(lines[line], ',');
    if (fields.size() < 7) {
      throw Error(ErrorKind::bad_file, location + " has " + std::to_string(fields.size()) +
                                           " fields; a view requires at least 7");
    }
    flight::Problems problems;
    const auto numbers =
        flight::to_numbers({fields.begin() + 1, fields.begin() + 7}, location + " ", problems);
    if (!numbers) throw Error(ErrorKind::bad_file, problems.front());
    const Vector3d direction((*numbers)[3], (*numbers)[4], (*numbers)[5]);
    if (direction.norm() < 1e-6) {
      throw Error(ErrorKind::bad_file, location + " has a direction vector of zero length");
    }
    views.push_back(
        {Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]), direction.normalized()});
  }
  return views;
}

ScanRoute from_views(const std::vector<View>& views, double speed, Platform platform) {
  constexpr double turn_rate = 1.0;  // [rad/s]
  constexpr double min_time = 1e-3;  // Minimum time between views at the same position [s].
  std::vector<sim::StampedPose> poses;
  std::vector<double> image_times;
  double time = 0.0;
  for (const View& view : views) {
    sim::StampedPose pose = pose_at(time, view, platform);
    if (!poses.empty()) {
      const double travelled = (pose.position - poses.back().position).norm();
      const double turn = pose.attitude.angularDistance(poses.back().attitude);
      time += std::max({travelled / speed, turn / turn_rate, min_time});
      pose.time = time;
    }
    poses.push_back(pose);
    image_times.push_back(time);
  }
  return {sim::Trajectory(std::move(poses)), std::move(image_times)};
}

/// Creates a level flight with the nose forward. Climbs keep the previous heading.
ScanRoute from_points(const std::vector<Vector3d>& points, double speed) {
  std::vector<View> views;  // Each corner occurs twice: at arrival and at departure.
  Vector3d ahead = Vector3d::UnitX();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector3d travelled = points[i] - points[i - 1];
    const Vector3d level(travelled.x(), travelled.y(), 0.0);
    if (level.norm() > 1e-3) ahead = level.normalized();
    views.push_back({points[i - 1], ahead});
    views.push_back({points[i], ahead});
  }
  ScanRoute route = from_views(views, speed, Platform::airframe);
  route.image_times.clear();
  return route;
}

std::string route_text(const std::filesystem::path& file) {
  constexpr std::size_t largest = std::size_t{256} << 20;
  return geometry::read_file(file, largest);
}

[[noreturn]] void fail_in(const std::filesystem::path& file, const Error& error) {
  throw Error(ErrorKind::bad_file, file.string() + ": " + error.what());
}

/// Returns the trajectory files of a mission package, one per sortie in order. Returns an empty
/// list if the mission has no flight. Throws Error{bad_file} if it has one but its trajectories
/// were not exported.
std::vector<std::filesystem::path> sorties_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::exists(folder / "mission.csv")) return {folder / "mission.csv"};
  for (std::size_t number = 1;; ++number) {
    const std::filesystem::path file = folder / ("mission-" + std::to_string(number) + ".csv");
    if (!std::filesystem::exists(file)) break;
    files.push_back(file);
  }
  if (files.empty() && std::filesystem::exists(folder / "free_space.bin")) {
    throw Error(ErrorKind::bad_file,
                folder.string() +
                    ": contains a flight, but no mission.csv; export one (skycap export " +
                    folder.string() + " --format csv) and use that file");
  }
  return files;
}

/// Concatenates sorties with a short pause that does not represent the time for changing the
/// battery.
ScanRoute from_sorties(const std::vector<std::filesystem::path>& files, double speed,
                       Platform platform) {
  constexpr double pause = 1.0;  // [s]
  std::vector<flight::TimedState> all;
  for (const std::filesystem::path& file : files) {
    try {
      double later = 0.0;
      for (flight::TimedState& state : flight::read_trajectory_csv(route_text(file))) {
        if (later == 0.0 && !all.empty()) {
          const double travelled = (state.position - all.back().position).norm();
          later = all.back().time + std::max(pause, travelled / speed) - state.time;
        }
        state.time += later;
        all.push_back(state);
      }
    } catch (const Error& error) {
      fail_in(file, error);
    }
  }
  return from_states(all, platform);
}

}  // namespace

ScanRoute read_scan_route(const std::filesystem::path& path, const ScanFlightOptions& options,
                          Platform platform) {
  std::filesystem::path file = path;
  if (std::filesystem::is_directory(path)) {
    const std::vector<std::filesystem::path> sorties = sorties_in(path);
    if (!sorties.empty()) return from_sorties(sorties, options.speed, platform);
    file = path / "views.csv";
  }
  const std::string extension = file.extension().string();
  const bool has_local_positions =
      extension == ".tum" || extension == ".txt" || extension == ".csv";
  if (!has_local_positions) {
    if (!options.site) {
      throw Error(ErrorKind::bad_config,
                  file.string() +
                      ": has geographic positions; set site.latitude_deg and site.longitude_deg");
    }
    return from_points(flight::read_route(file, *options.site, options.pad), options.speed);
  }
  const std::string text = route_text(file);
  try {
    if (extension != ".csv") return from_tum(text);
    if (text.starts_with("view,")) return from_views(parse_views(text), options.speed, platform);
    return from_states(flight::read_trajectory_csv(text), platform);
  } catch (const Error& error) {
    fail_in(file, error);
  }
}

sim::Trajectory orbit_trajectory(const OrbitOptions& orbit) {
  // [s]; at 10 m/s and a radius of 30 m, the chord error is 0.2 mm.
  constexpr double interval = 0.02;
  const double round = 2.0 * std::numbers::pi * orbit.radius;
  const double step =
      orbit.circles > 1 ? (orbit.max_height - orbit.min_height) / (orbit.circles - 1) : 0.0;
  const double climb = std::abs(step);
  const double length = orbit.circles * round + (orbit.circles - 1) * climb;
  const auto pose_after = [&](double time, double travelled) {
    const auto circle =
        std::min<int>(static_cast<int>(travelled / (round + climb)), orbit.circles - 1);
    const double rest = travelled - circle * (round + climb);
    const double angle = orbit.start + std::min(rest, round) / orbit.radius;
    const double climbed = climb > 0.0 ? std::max(0.0, rest - round) / climb : 0.0;
    const double height = orbit.min_height + step * (circle + climbed);
    const Vector3d spoke(std::cos(angle), std::sin(angle), 0.0);
    return level_pose(time, orbit.centre + orbit.radius * spoke + height * Vector3d::UnitZ(),
                      angle + 0.5 * std::numbers::pi);
  };
  const double duration = length / orbit.speed;
  constexpr double max_poses = 3e6;  // 16 hours.
  if (!(duration / interval <= max_poses)) {
    throw Error(ErrorKind::bad_config,
                "scan.orbit.speed: these circles require " + support::short_text(duration) +
                    " s and " + support::short_text(duration / interval) +
                    " poses; the maximum is " + support::short_text(max_poses) +
                    "; raise the speed, or fly fewer or smaller circles");
  }
  std::vector<sim::StampedPose> poses;
  double time = 0.0;
  while (time < duration - 1e-6) {
    poses.push_back(pose_after(time, time * orbit.speed));
    time = interval * static_cast<double>(poses.size());
  }
  poses.push_back(pose_after(duration, length));
  return sim::Trajectory(std::move(poses));
}

Isometry3d body_from_camera() {
  Isometry3d pose = Isometry3d::Identity();
  // Columns are the camera's x (right), y (down) and z (forward) in the body frame.
  pose.linear().col(0) = -Vector3d::UnitY();
  pose.linear().col(1) = -Vector3d::UnitZ();
  pose.linear().col(2) = Vector3d::UnitX();
  return pose;
}

}  // namespace skycap::missions::scan
