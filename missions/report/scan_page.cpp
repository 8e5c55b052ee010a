#include "missions/report/scan_page.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <nlohmann/json.hpp>

#include "flight/export/trajectory_file.h"
#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/file.h"
#include "missions/package/cloud_normals.h"
#include "missions/package/settings.h"
#include "missions/report/cloud_code.h"
#include "missions/report/page.h"
#include "missions/report/point_figures.h"
#include "missions/report/scene_outline.h"
#include "missions/report/verdict.h"
#include "missions/support/json_text.h"

namespace skycap::missions::report {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// Reads sensor poses over time, estimated or ground truth.
std::vector<flight::TimedPose> poses_in(const fs::path& file) {
  if (!is_there(file)) return {};
  const std::string text = geometry::read_file(file);
  if (const auto problems = flight::validate_tum(text); !problems.empty()) {
    throw Error(ErrorKind::bad_file, file.string() + ": " + problems.front());
  }
  return flight::read_tum(text);
}

/// Downsamples a trajectory to a maximum number of poses, including the last.
std::vector<flight::TimedPose> downsampled(const std::vector<flight::TimedPose>& poses) {
  constexpr std::size_t max = 3000;
  if (poses.size() <= max) return poses;
  std::vector<flight::TimedPose> kept;
  for (std::size_t i = 0; i < max; ++i) kept.push_back(poses[i * (poses.size() - 1) / (max - 1)]);
  return kept;
}

Json trajectory_json(const std::vector<flight::TimedPose>& poses) {
  Json times = Json::array(), points = Json::array();
  for (const flight::TimedPose& pose : downsampled(poses)) {
    times.push_back(pose.time);
    points.push_back(support::to_json(Eigen::Vector3d(pose.world_from_camera.translation())));
  }
  return {{"times", times}, {"points", points}};
}

/// Returns the latest pose up to a time [s], or the first pose.
const flight::TimedPose& pose_at(const std::vector<flight::TimedPose>& poses, double time) {
  const auto after = std::ranges::upper_bound(poses, time, {}, &flight::TimedPose::time);
  return after == poses.begin() ? *after : *(after - 1);
}

/// Returns the sensor pose of each piece of the flight: at the middle of the piece, or of the
/// image.
std::vector<flight::TimedPose> segment_poses(const Json& preview,
                                             const std::vector<flight::TimedPose>& estimated,
                                             std::size_t segments) {
  if (!preview.contains("piece_s") || estimated.empty()) return estimated;
  const auto start = preview.at("start_s").get<double>();
  const auto length = preview.at("piece_s").get<double>();
  std::vector<flight::TimedPose> poses;
  for (std::size_t i = 0; i < segments; ++i) {
    const double time = start + (static_cast<double>(i) + 0.5) * length;
    poses.push_back({time, pose_at(estimated, time).world_from_camera});
  }
  return poses;
}

Json segments_json(const std::vector<flight::TimedPose>& poses,
                   const std::vector<std::size_t>& points) {
  Json list = Json::array();
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Eigen::Isometry3d& pose = poses[i].world_from_camera;
    list.push_back({{"time_s", poses[i].time},
                    {"position", support::to_json(Eigen::Vector3d(pose.translation()))},
                    {"direction", support::to_json(Eigen::Vector3d(pose.linear().col(2)))},
                    {"points", i < points.size() ? points[i] : 0}});
  }
  return list;
}

std::vector<std::size_t> count_points_per_view(const std::vector<std::uint32_t>& views) {
  std::vector<std::size_t> counts;
  for (const std::uint32_t view : views) {
    if (view >= counts.size()) counts.resize(std::min<std::size_t>(view + 1UL, 0x10000), 0);
    if (view < counts.size()) ++counts[view];
  }
  return counts;
}

/// Displayed points of the preview, with the geometry of their observation.
struct Shown {
  std::vector<std::uint16_t> views, incidence;
  std::vector<float> ranges;
};

Shown select_shown(geometry::AttributedCloud& cloud, const std::vector<flight::TimedPose>& poses) {
  std::vector<geometry::View> views;
  std::vector<Eigen::Vector3d> sensors;
  for (const flight::TimedPose& pose : poses) {
    sensors.emplace_back(pose.world_from_camera.translation());
    views.push_back({sensors.back(), pose.world_from_camera.linear().col(2)});
  }
  const bool is_known =
      std::ranges::all_of(cloud.views, [&](std::uint32_t view) { return view < sensors.size(); });
  if (is_known && cloud.views.size() == cloud.positions.size()) {
    // Fitting a plane to noisy points requires several neighbours on all sides.
    constexpr double spacings = 5.0;
    const double radius = spacings * compute_spacing(cloud.positions);
    if (radius > 0.0) {
      cloud.normals = package::cloud_normals({cloud.positions, cloud.views}, sensors, radius, 0);
    }
  }
  return {view_numbers(cloud), incidence_steps(cloud, views), ranges(cloud, views)};
}

std::vector<std::string> file_names(const Json& summary) {
  std::vector<std::string> names;
  const Json files = summary.value("files", Json::array());
  for (const Json& file : files) names.push_back(file.at("name").get<std::string>());
  for (const char* name : {"preview.ply", "trajectory.tum", "trajectory_estimated.tum", "depth.txt",
                           "groundtruth.txt", "estimated.txt", "camera.json", "frames.rawlog"}) {
    names.emplace_back(name);
  }
  return names;
}

Json make_verdict(const Json& summary) {
  const bool is_complete = summary.value("complete", false);
  Verdict verdict{.is_complete = is_complete,
                  .because = is_complete ? "the complete route was flown" : "interrupted",
                  .lights = {}};
  const auto add = [&](const char* name, const char* figure, const char* form) {
    if (summary.contains(figure)) verdict.lights.push_back({name, figure, form, summary[figure]});
  };
  add("Flight", "flight_s", "minutes");
  add("Images", "images", "count");
  add("Shots", "shots", "count");
  add("Points", "points", "count");
  return to_json(verdict);
}

/// Returns the field of view of the depth camera described in camera.json.
Json camera_outline(const Json& camera) {
  const auto angle = [&](const char* size, std::size_t axis) {
    return 2.0 * std::atan(camera.at(size).get<double>() /
                           (2.0 * camera.at("focal_length_px").at(axis).get<double>()));
  };
  return {{"horizontal_fov", angle("width_px", 0)},
          {"vertical_fov", angle("height_px", 1)},
          {"lidar", false}};
}

Json page_data(const Json& summary, const fs::path& file) {
  Json data = {{"kind", "scan"},
               {"title", summary.at("mission")},
               {"facts", {"sensor " + summary.at("sensor").get<std::string>()}},
               {"verdict", make_verdict(summary)},
               {"summary", summary}};
  if (summary.contains("settings")) {
    const config::MissionSetup setup =
        package::mission_from_settings(summary["settings"], file.string());
    data["facts"].push_back(setup.scene().model);
    data["scene"] = scene_outline(setup.survey(), setup.scene(), std::nullopt);
  }
  return data;
}

}  // namespace

/// Returns the file of estimated poses. Version 0.1 used different file names.
fs::path estimated_poses(const ResultFinder& results, bool is_laser) {
  const fs::path file = results(is_laser ? "trajectory_estimated.tum" : "estimated.txt");
  if (is_there(file)) return file;
  return results(is_laser ? "trajectory_believed.tum" : "believed.txt");
}

std::string scan_page(const ResultFinder& results, std::size_t max_points) {
  const fs::path file = results("scan.json");
  const Json summary = read_results(file);
  try {
    const Json preview = summary.value("preview", Json::object());
    geometry::AttributedCloud cloud;
    if (is_there(results("preview.ply"))) cloud = geometry::read_cloud(results("preview.ply"));
    const bool is_laser = summary.contains("shots");
    const auto estimated = poses_in(estimated_poses(results, is_laser));
    const auto ground_truth = poses_in(results(is_laser ? "trajectory.tum" : "groundtruth.txt"));
    const std::vector<std::size_t> counts = count_points_per_view(cloud.views);
    const auto poses = segment_poses(preview, estimated, counts.size());
    const Shown shown = select_shown(cloud, poses);
    Json data = page_data(summary, file);
    if (data.contains("scene") && is_there(results("camera.json"))) {
      data["scene"]["sensor"] = camera_outline(read_results(results("camera.json")));
    }
    data["piece"] = is_laser ? "piece" : "image";
    data["pieces"] = segments_json(poses, counts);
    data["trajectory"] = {{"flown", trajectory_json(ground_truth)},
                          {"believed", trajectory_json(estimated)}};
    data["accuracy"] = accuracy_json(shown.incidence, shown.ranges, {});
    data["files"] = files_json(file_names(summary), results, summary.value("complete", false));
    std::vector<CloudAttribute> attributes;
    if (!shown.views.empty()) {
      attributes = {{"view", shown.views}, {"incidence", shown.incidence}};
    }
    return page_text(summary.at("mission").get<std::string>(), data,
                     {{"measured", encode_cloud(cloud.positions, attributes, max_points)}});
  } catch (const Json::exception& error) {
    reject_results(file, error.what());
  }
}

}  // namespace skycap::missions::report
