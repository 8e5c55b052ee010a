#include "missions/wizard/mission_text.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include <fmt/format.h>

#include "missions/config/sensor_reader.h"
#include "missions/site_data/prior_text.h"
#include "missions/support/flow_text.h"

namespace skycap::missions::wizard {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using site_data::Source;
using support::yaml_quoted;

std::string vector_text(const Vector3d& position) {
  return fmt::format("[{:g}, {:g}, {:g}]", position.x(), position.y(), position.z());
}

/// Returns a quoted path relative to the mission's folder.
std::string path_text(const std::filesystem::path& file, const std::filesystem::path& mission) {
  const auto absolute = std::filesystem::absolute(file).lexically_normal();
  const auto folder = std::filesystem::absolute(mission).lexically_normal().parent_path();
  return yaml_quoted(absolute.lexically_proximate(folder).string());
}

std::string source_text(const Source& source, const std::filesystem::path& mission) {
  std::string text = fmt::format("{{file: {}, role: {}", path_text(source.file, mission),
                                 site_data::to_string(source.role));
  if (!source.crs.empty()) text += ", crs: " + yaml_quoted(source.crs);
  if (source.vertical) text += std::string(", vertical: ") + site_data::to_string(*source.vertical);
  if (source.base_on_terrain) text += ", base: terrain";
  if (source.base) text += fmt::format(", base: {:g}", *source.base);
  if (source.height) text += fmt::format(", height: {:g}", *source.height);
  if (source.uncertainty) text += fmt::format(", uncertainty: {:g}", *source.uncertainty);
  std::string ids;
  for (const std::string& id : source.select.ids)
    ids += (ids.empty() ? "" : ", ") + yaml_quoted(id);
  if (!ids.empty()) text += ", select: {id: [" + ids + "]}";
  return text + "}";
}

const char* describe_purpose(site_data::Role role) {
  switch (role) {
    case site_data::Role::target:
      return "surveyed object; its coverage is reported";
    case site_data::Role::obstacle:
      return "avoided by every leg, enlarged by its uncertainty; does not mark space as free";
    case site_data::Role::terrain:
      return "ground: legs stay above it; the take-off point is on it";
    case site_data::Role::truth:
      break;
  }
  return "ground truth of the simulated sensor";
}

std::string prior_section(const MissionValues& values) {
  std::string text =
      "# Prior data: data available before the survey. The key 'uncertainty' is their maximum "
      "error in metres.\nprior:\n";
  for (const Source& source : values.sources) {
    text += fmt::format("  # {}\n  - {}\n", describe_purpose(source.role),
                        source_text(source, values.file));
  }
  return text;
}

std::string site_section(const MissionValues& values) {
  const Vector3d low = values.fence.min(), high = values.fence.max();
  const bool counts_from_takeoff = std::ranges::any_of(values.sources, [](const Source& source) {
    return source.vertical == site_data::HeightDatum::takeoff;
  });
  return fmt::format(
      "site:\n  # Origin of the mission frame (x east, y north, z up): {}.\n  latitude_deg: {:.7f} "
      " # WGS84, north\n  longitude_deg: {:.7f}  # east\n  ellipsoid_height: {:.2f}  # {}\n  # "
      "Views and legs stay inside this "
      "geofence; set the area in which you are allowed to fly.\n  geofence: [[{:g}, {:g}], [{:g}, "
      "{:g}], [{:g}, {:g}], [{:g}, {:g}]]\n  max_height: {:g}  # z in the mission frame: maximum "
      "flight height\n",
      values.origin_is, values.origin.latitude_deg, values.origin.longitude_deg,
      values.origin.height,
      counts_from_takeoff ? "unknown; all heights are relative to the take-off point. Set it "
                            "before you use files with absolute altitudes"
                          : "metres above the WGS84 ellipsoid, not above mean sea level",
      low.x(), low.y(), high.x(), low.y(), high.x(), high.y(), low.x(), high.y(), high.z());
}

std::string flight_section(const MissionValues& values) {
  // The value is a preset name, or a path if it ends in .yaml.
  const bool is_file = std::filesystem::path(values.vehicle).extension() == ".yaml";
  std::string text = fmt::format(
      "flight:\n  vehicle: {}  # a preset, or the path of a vehicle file\n  clearance: {:g}  # "
      "minimum distance from the vehicle centre to any obstacle\n",
      is_file ? path_text(values.vehicle, values.file) : yaml_quoted(values.vehicle),
      values.clearance);
  if (values.pad) {
    text += fmt::format(
        "  # Take-off point, where the vehicle also lands. Check on site that it and the air above "
        "are free.\n  takeoff: {}\n",
        vector_text(*values.pad));
  }
  if (values.photo) {
    return text +
           "  # A photo camera does not measure free space. Outside the prior data, enlarged by "
           "their "
           "uncertainty and the\n  # clearance, the air is assumed free; the pilot must check it "
           "for trees, wires and cranes.\n  free_space: assumed\n";
  }
  text += fmt::format(
      "  # In this box unknown space is treated as occupied. Outside it the air is assumed free, "
      "except\n  # for prior data; the pilot must check it. Extend the box over trees, wires and "
      "cranes.\n  unknown_box: {{min: {}, max: {}}}\n",
      vector_text(values.unknown.min()), vector_text(values.unknown.max()));
  std::string corners;
  for (const Eigen::AlignedBox3d& box : values.extra_unknown_boxes) {
    corners += fmt::format("{}{}, {}", corners.empty() ? "" : ",\n    ", vector_text(box.min()),
                           vector_text(box.max()));
  }
  if (!corners.empty()) {
    text +=
        "  # The same for neighbouring targets: the corners of each box.\n"
        "  extra_unknown_boxes: [" +
        corners + "]\n";
  }
  return text;
}

/// The generic depth camera, or the image of a camera preset: photo cameras with fewer pixels.
std::string camera_text(const MissionValues& values) {
  constexpr int width = 320;
  std::string text = "sensor:  # a depth camera; `skycap check` prints its resolution\n";
  int height = 240;
  bool is_depth_camera = false;
  if (!values.sensor.empty()) {
    const config::SensorDescription preset = config::find_camera(values.sensor);
    const sim::DepthCameraConfig& camera = std::get<sim::DepthCameraConfig>(preset.sensor);
    is_depth_camera = preset.useful_range.has_value();
    text = fmt::format("sensor:  # {}\n  preset: {}  # values of a camera preset\n", preset.name,
                       yaml_quoted(values.sensor));
    height = static_cast<int>(
        std::round(static_cast<double>(width) * camera.camera.height / camera.camera.width));
  }
  if (!is_depth_camera) {
    text += fmt::format(
        "  width: {}  # pixels{}\n  height: {}  # pixels\n", width,
        values.sensor.empty() ? "" : ", reduced from the camera's resolution for faster planning",
        height);
  }
  text += fmt::format("  max_range: {:g}  # metres\n", sensor_range(values));
  if (!is_depth_camera) {
    text += "  noise: {sigma: 0.02}  # metres, one standard deviation\n";
  }
  return text;
}

std::string sensor_section(const MissionValues& values) {
  if (values.sensor.empty() || !is_lidar(values.sensor)) return camera_text(values);
  const bool is_file = std::filesystem::path(values.sensor).extension() == ".yaml";
  return fmt::format(
      "sensor:\n  lidar: {}  # a LiDAR preset, or the path of a sensor file; it measures en "
      "route\n",
      is_file ? path_text(values.sensor, values.file) : yaml_quoted(values.sensor));
}

/// Head of a photo mission, which requires no simulated scene.
std::string photo_head(const MissionValues& values) {
  return fmt::format(
      "# First photo mission, proposed by `{}`. It can be planned unchanged. Values that the files "
      "do not\n# contain are estimates: check every line before you fly. `skycap check` prints "
      "what "
      "the files contain.\nname: {}  # name of the results\n",
      values.command, yaml_quoted(values.file.stem().string()));
}

/// The sections of a photo mission after those of the flight.
std::string photo_section(const MissionValues& values) {
  const std::string& camera = values.photo->camera;
  const bool is_file = std::filesystem::path(camera).extension() == ".yaml";
  return photo_sections(*values.photo,
                        is_file ? path_text(camera, values.file) : yaml_quoted(camera));
}

std::string planner_section(const MissionValues& values) {
  const double distance = values.registration_distance;
  std::string text =
      sensor_section(values) +
      "planner:\n  preset: building  # settings of SEE and SEE++ for large structures\n";
  if (values.scene) {
    text += fmt::format(
        "  # Region of interest, from below the base of the target.\n  scene_box: {{min: {}, "
        "max: {}}}\n",
        vector_text(values.scene->min()), vector_text(values.scene->max()));
  }
  return text +
         fmt::format(
             "  view_distance: {:g}  # metres, distance of views from the surface\n  density: "
             "{:.3g}  # required points per cubic metre\n  resolution_radius: {:g}  # metres, "
             "radius in which points are counted\n  spacing: {:g}  # metres, minimum spacing of "
             "stored points\nevaluation:\n  coverage_distance: {:g}  # metres; a surface point "
             "with a measurement within this distance is covered\nlimits:\n  max_views: 150  # the "
             "survey "
             "ends earlier when it is complete\n",
             values.view_distance, 0.36 / (distance * distance), 3.0 * distance, 0.5 * distance,
             distance);
}

}  // namespace

double sensor_range(const MissionValues& values) {
  return values.max_range.value_or(4.0 * values.view_distance);
}

bool is_lidar(const std::string& sensor) {
  return std::holds_alternative<sim::LidarConfig>(config::find_sensor(sensor).sensor);
}

std::string mission_text(const MissionValues& values) {
  if (values.photo) {
    return photo_head(values) + prior_section(values) + site_section(values) +
           flight_section(values) + photo_section(values);
  }
  const std::string name = values.file.stem().string();
  return fmt::format(
             "# First mission, proposed by `{}`. It can be run unchanged. Values that the files do "
             "not contain are\n"
             "# estimates: check every line before you fly. `skycap check` prints what the files "
             "contain.\n"
             "name: {}  # name of the results\n"
             "# Simulation: {} the ground truth. Remove `scene` for a live survey.\n"
             "scene: {{model: prior, ground: true{}{}}}\n",
             values.command, yaml_quoted(name),
             values.sees_neighbours ? "the target and its neighbours are" : "the target is",
             values.sees_neighbours ? ", neighbours: true" : "",
             values.ground == 0.0 ? "" : fmt::format(", position: [0, 0, {:g}]", values.ground)) +
         prior_section(values) + site_section(values) + flight_section(values) +
         planner_section(values);
}

}  // namespace skycap::missions::wizard
