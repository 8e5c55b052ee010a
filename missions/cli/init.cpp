// skycap init: creates a commented mission for a sensor, a vehicle and a target without a
// georeference.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/surfaces/mesh.h"
#include "missions/cli/command_options.h"
#include "missions/config/resolve.h"
#include "missions/config/sensor_reader.h"
#include "missions/config/vehicle_reader.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/support/flow_text.h"
#include "missions/wizard/photo_proposal.h"
#include "missions/wizard/proposal.h"

namespace skycap::missions::cli {
namespace {

namespace fs = std::filesystem;
using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using support::yaml_quoted;

struct InitOptions {
  std::string target;  ///< mesh file, builtin:NAME, model:NAME, or "room"
  std::string sensor;  ///< empty: by the size of the target
  std::string vehicle = "none";
  std::optional<double> gsd;                   ///< ground sampling distance of a photo camera [m]
  std::vector<double> size = {6.0, 4.0, 2.8};  ///< dimensions of a room [m]
  fs::path out = "mission.yaml";

  bool is_room() const { return target == "room"; }
  bool has_vehicle() const { return vehicle != "none"; }
};

/// Values of the proposed mission; lengths in metres.
struct Proposal {
  AlignedBox3d target;  ///< bounding box in the mission frame
  double coverage_distance = 0.0, view_distance = 0.0, clearance = 0.0;
  double unknown_margin = 0.0;  ///< distance from the target to the edge of the unknown space
  config::SensorDescription sensor;
};

std::string vector_text(const Vector3d& position) {
  return fmt::format("[{:.4g}, {:.4g}, {:.4g}]", position.x(), position.y(), position.z());
}

std::string box_text(const AlignedBox3d& box) {
  return fmt::format("{{min: {}, max: {}}}", vector_text(box.min()), vector_text(box.max()));
}

/// Rounds to two significant digits.
double rounded(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1.0);
  return unit * std::round(value / unit);
}

/// Returns a model name unchanged, or a file path relative to the mission's folder.
std::string model_text(const std::string& model, const fs::path& mission) {
  if (model.starts_with("builtin:") || model.starts_with("model:")) return yaml_quoted(model);
  const fs::path folder = fs::absolute(mission).lexically_normal().parent_path();
  return yaml_quoted(fs::absolute(model).lexically_normal().lexically_proximate(folder).string());
}

AlignedBox3d make_target_box(const InitOptions& options) {
  if (!options.is_room()) {
    return geometry::bounding_box(evaluation::placed_model({.model = options.target}, ""));
  }
  const Vector3d half(0.5 * options.size[0], 0.5 * options.size[1], 0.0);
  return {-half, half + options.size[2] * Vector3d::UnitZ()};
}

/// Returns the maximum range of the sensor [m].
double max_range(const config::SensorDescription& sensor) {
  if (const auto* camera = std::get_if<sim::DepthCameraConfig>(&sensor.sensor)) {
    return camera->camera.max_range;
  }
  return std::get<sim::LidarConfig>(sensor.sensor).max_range;
}

/// Returns the maximum range in which the sensor is accurate [m].
double max_accurate_range(const config::SensorDescription& sensor) {
  return sensor.useful_range ? sensor.useful_range->max : max_range(sensor);
}

/// Returns the half width [m] of the column above the take-off point in a room. The vehicle climbs
/// in it before the first scan.
double column_half_width(const Proposal& proposal) { return proposal.clearance + 0.5; }

/// Returns the room without the column above the take-off point, in parts.
std::vector<AlignedBox3d> around_column(const Proposal& proposal) {
  const AlignedBox3d& room = proposal.target;
  const double half = column_half_width(proposal);
  const Vector3d low = room.min(), high = room.max();
  const std::array parts{
      AlignedBox3d(low, Vector3d(-half, high.y(), high.z())),
      AlignedBox3d(Vector3d(half, low.y(), low.z()), high),
      AlignedBox3d(Vector3d(-half, low.y(), low.z()), Vector3d(half, -half, high.z())),
      AlignedBox3d(Vector3d(-half, half, low.z()), Vector3d(half, high.y(), high.z()))};
  std::vector<AlignedBox3d> boxes;
  for (const AlignedBox3d& part : parts) {
    if ((part.sizes().array() > 0.0).all()) boxes.push_back(part);
  }
  return boxes;
}

/// Sets the margin of the unknown space, and the view distance such that the first view can be
/// outside of it.
void set_distances_of_flight(Proposal& proposal, const InitOptions& options) {
  constexpr double max_view_distance = 25.0, min_margin = 1.0, reserve = 0.5;
  const auto min_distance = [&](double margin) { return margin + proposal.clearance + reserve; };
  const double usual_margin = std::ceil(proposal.clearance + 1.0);
  const double distance = std::min(proposal.view_distance, max_view_distance);
  proposal.unknown_margin = distance < min_distance(usual_margin) ? min_margin : usual_margin;
  proposal.view_distance = std::max(distance, min_distance(proposal.unknown_margin));
  if (proposal.view_distance > max_range(proposal.sensor)) {
    throw Error(ErrorKind::bad_usage,
                fmt::format("--sensor {}: its range of {:g} m is too short for {}, which needs "
                            "views from {:g} m or more; choose a sensor with a longer range",
                            options.sensor, max_range(proposal.sensor), options.vehicle,
                            proposal.view_distance));
  }
}

Proposal proposal_for(const InitOptions& options) {
  Proposal proposal{.target = make_target_box(options),
                    .sensor = config::find_sensor(options.sensor)};
  const double side = proposal.target.sizes().maxCoeff();
  const double share = proposal.sensor.useful_range ? 0.9 : 0.5;
  const double farthest = share * max_accurate_range(proposal.sensor);
  proposal.coverage_distance = rounded(side / (options.is_room() ? 300.0 : 200.0));
  proposal.view_distance = rounded(std::min(options.is_room() ? 0.3 * side : side, farthest));
  if (!options.has_vehicle()) return proposal;
  proposal.clearance = wizard::compute_min_clearance(config::find_vehicle(options.vehicle));
  if (!options.is_room()) {
    set_distances_of_flight(proposal, options);
  } else if (proposal.target.sizes().minCoeff() <= 2.0 * proposal.clearance ||
             around_column(proposal).empty()) {
    throw Error(ErrorKind::bad_usage,
                fmt::format("--size: each side of the room must be longer than twice the clearance "
                            "({:g} m); raise --size or use --vehicle none",
                            proposal.clearance));
  }
  return proposal;
}

std::string head_text(const InitOptions& options) {
  const std::string name = yaml_quoted(options.out.stem().string());
  if (options.is_room()) {
    return "# Mission file for a live survey of a room, created by `skycap init`. Check each line "
           "and\n# adapt it to your room. Then run: skycap next " +
           options.out.string() +
           " --survey survey\n"
           "name: " +
           name + "  # name of the results\n";
  }
  return "# Mission file for a survey of a model, created by `skycap init`. Check and adapt each "
         "line.\n# Then run:\n"
         "# skycap check " +
         options.out.string() + " and skycap plan " + options.out.string() + "\nname: " + name +
         "  # name of the results\n"
         "scene:\n"
         "  model: " +
         model_text(options.target, options.out) +
         "  # in metres, z up; otherwise set scene.scale and scene.up_axis\n"
         "  ground: true  # the sensor also sees the ground\n";
}

std::string sensor_text(const InitOptions& options, const Proposal& proposal) {
  const auto* const camera = std::get_if<sim::DepthCameraConfig>(&proposal.sensor.sensor);
  if (camera == nullptr) {
    return fmt::format("sensor:\n  lidar: {}  # {}\n", yaml_quoted(options.sensor),
                       proposal.sensor.name);
  }
  if (fs::path(options.sensor).extension() != ".yaml") {
    const std::string useful =
        proposal.sensor.useful_range
            ? fmt::format(", accurate from {:g} to {:g} m", proposal.sensor.useful_range->min,
                          proposal.sensor.useful_range->max)
            : "";
    std::string text = fmt::format("sensor:\n  preset: {}  # {}{}\n", options.sensor,
                                   proposal.sensor.name, useful);
    if (options.is_room() && proposal.sensor.useful_range) {
      text += fmt::format("  max_range: {:g}  # metres; farther measurements are ignored\n",
                          max_accurate_range(proposal.sensor));
    }
    return text;
  }
  const double degree = geometry::radians_per_degree;
  return fmt::format(
      "sensor:  # {}\n"
      "  width: {}  # pixels\n"
      "  height: {}  # pixels\n"
      "  horizontal_fov_deg: {:.6g}\n"
      "  vertical_fov_deg: {:.6g}\n"
      "  min_range: {:g}  # metres\n"
      "  max_range: {:g}  # metres; the range in which the sensor is accurate\n",
      proposal.sensor.name, camera->camera.width, camera->camera.height,
      camera->camera.horizontal_fov / degree, camera->camera.vertical_fov / degree,
      proposal.sensor.useful_range ? proposal.sensor.useful_range->min : camera->camera.min_range,
      max_accurate_range(proposal.sensor));
}

std::string planner_text(const InitOptions& options, const Proposal& proposal) {
  AlignedBox3d scene = proposal.target;
  const double margin = 0.05 * scene.sizes().maxCoeff();
  scene.min().array() -= margin;
  scene.max().array() += margin;
  if (!options.is_room()) scene.min().z() = 0.005 * proposal.target.sizes().z();
  const double distance = proposal.coverage_distance;
  return fmt::format(
      "planner:\n"
      "  name: skycap\n"
      "  preset: building  # for scenes of any size; paper: the values of the SEE++ paper\n"
      "  scene_box: {}  # region of interest{}\n"
      "  view_distance: {:g}  # metres from a view to the surface\n"
      "  density: {:.3g}  # required points per cubic metre\n"
      "  resolution_radius: {:g}  # metres, radius in which points are counted\n"
      "evaluation:\n"
      "  coverage_distance: {:g}  # metres; a surface point with a measurement within this "
      "distance is covered\n",
      box_text(scene), options.is_room() ? "" : ", without the ground", proposal.view_distance,
      0.36 / (distance * distance), 3.0 * distance, distance);
}

std::string limits_text(const InitOptions& options, const Proposal& proposal) {
  const AlignedBox3d& room = proposal.target;
  std::string text =
      "limits:\n"
      "  max_views: 150  # the survey ends earlier if it is complete\n";
  if (!options.has_vehicle()) {
    text +=
        fmt::format("  stand_off: {:g}  # metres, minimum distance of a view from any surface\n",
                    rounded(0.2 * proposal.view_distance));
  }
  if (!options.is_room()) return text;
  const double floor = options.has_vehicle() ? proposal.clearance : 0.2;
  return text +
         fmt::format(
             "site:  # keeps views inside the room; the frame's origin is the middle of the floor\n"
             "  geofence: [[{0:.4g}, {1:.4g}], [{2:.4g}, {1:.4g}], [{2:.4g}, {3:.4g}], "
             "[{0:.4g}, {3:.4g}]]\n"
             "  min_height: {4:.4g}  # z in metres\n"
             "  max_height: {5:.4g}  # z in metres\n",
             room.min().x(), room.min().y(), room.max().x(), room.max().y(), floor, room.max().z());
}

std::string unknown_text(const InitOptions& options, const Proposal& proposal,
                         const AlignedBox3d& unknown) {
  if (!options.is_room()) return fmt::format("  unknown_box: {}\n", box_text(unknown));
  const std::vector<AlignedBox3d> boxes = around_column(proposal);
  std::string more;
  for (std::size_t i = 1; i < boxes.size(); ++i) {
    more += fmt::format("{}{}, {}", i == 1 ? "" : ",\n    ", vector_text(boxes[i].min()),
                        vector_text(boxes[i].max()));
  }
  return fmt::format(
      "  # The boxes exclude the column above the take-off point, in which the vehicle climbs "
      "before\n"
      "  # the first scan: the pilot must check that it is free.\n"
      "  unknown_box: {}\n"
      "  extra_unknown_boxes: [{}]  # corners of the other boxes\n",
      box_text(boxes.front()), more);
}

std::string flight_text(const InitOptions& options, const Proposal& proposal) {
  if (!options.has_vehicle()) return "";
  AlignedBox3d unknown = proposal.target;
  if (!options.is_room()) {
    unknown.min().head<2>().array() -= proposal.unknown_margin;
    unknown.max().array() += proposal.unknown_margin;
    unknown.min().z() = 0.0;
  }
  const bool is_file = fs::path(options.vehicle).extension() == ".yaml";
  std::string text = fmt::format(
      "flight:\n"
      "  vehicle: {}  # a preset (skycap presets) or a description NAME.yaml\n"
      "  clearance: {:g}  # metres from the vehicle's centre to anything not known to be free\n"
      "  # Unknown space in this box is treated as occupied. Outside, the airspace above the "
      "ground\n"
      "  # is assumed free: the pilot must check it.\n",
      is_file ? model_text(options.vehicle, options.out) : yaml_quoted(options.vehicle),
      proposal.clearance);
  text += unknown_text(options, proposal, unknown);
  if (options.is_room()) {
    const double height = 0.5 * proposal.target.sizes().z();
    text += fmt::format(
        "  takeoff: [0, 0, 0]  # take-off and landing point\n"
        "  takeoff_climb: {:.4g}  # metres, vertical climb before the first leg\n",
        height);
  }
  return text;
}

/// Returns the pose of the first scan: above the take-off point of a room, or in front of the
/// middle of the longer side of a model.
std::string start_text(const InitOptions& options, const Proposal& proposal) {
  if (options.is_room() && !options.has_vehicle()) return "";
  const AlignedBox3d& target = proposal.target;
  Vector3d position = target.center(), direction = Vector3d::UnitX();
  std::string remark;
  if (!options.is_room()) {
    const int axis = target.sizes().x() < target.sizes().y() ? 0 : 1;
    direction = Vector3d::Unit(axis);
    position[axis] = target.min()[axis] - proposal.view_distance;
    position.z() = std::max(position.z(), target.min().z() + proposal.clearance + 0.1);
    remark = "; without this section it depends on the seed";
  }
  return fmt::format("start:  # pose of the first scan{}\n  position: {}\n  direction: {}\n",
                     remark, vector_text(position), vector_text(direction));
}

/// Mission with a photo camera for a mesh file.
std::string photo_mission_text(const InitOptions& options) {
  if (options.is_room() || options.target.starts_with("builtin:") ||
      options.target.starts_with("model:")) {
    throw Error(ErrorKind::bad_usage,
                options.target + ": photos require a mesh file with the shape of the target");
  }
  constexpr double uncertainty = 0.1;
  flight::Vehicle vehicle;
  double clearance = 0.0;
  std::string flight;
  if (options.has_vehicle()) {
    vehicle = config::find_vehicle(options.vehicle);
    clearance = wizard::compute_min_clearance(vehicle);
    const bool is_file = fs::path(options.vehicle).extension() == ".yaml";
    flight = fmt::format(
        "flight:\n"
        "  vehicle: {}  # a preset (skycap presets) or a description NAME.yaml\n"
        "  clearance: {:g}  # metres from the vehicle's centre to the prior data\n"
        "  # A photo camera does not measure free space. Outside the prior data, enlarged by their "
        "uncertainty and the\n"
        "  # clearance, the air is assumed free; the pilot must check it for trees, wires and "
        "cranes.\n"
        "  free_space: assumed\n",
        is_file ? model_text(options.vehicle, options.out) : yaml_quoted(options.vehicle),
        clearance);
  }
  constexpr bool is_coarse = false;
  const wizard::PhotoValues values = wizard::propose_photos(options.sensor, *options.gsd, vehicle,
                                                            clearance, uncertainty, is_coarse);
  return fmt::format(
             "# Mission file for photos of a model, created by `skycap init`. Check and adapt each "
             "line.\n# Then run:\n"
             "# skycap check {0} and skycap plan {0}\n"
             "name: {1}  # name of the results\n"
             "prior:\n"
             "  # The surface to photograph: metres, z up, in the mission frame; otherwise add "
             "unit "
             "and up_axis.\n"
             "  # The key 'uncertainty' is its maximum error in metres.\n"
             "  - {{file: {2}, role: target, uncertainty: {3:g}}}\n",
             options.out.string(), yaml_quoted(options.out.stem().string()),
             model_text(options.target, options.out), uncertainty) +
         flight +
         photo_sections(values, fs::path(options.sensor).extension() == ".yaml"
                                    ? model_text(options.sensor, options.out)
                                    : yaml_quoted(options.sensor));
}

std::string survey_mission_text(const InitOptions& options, const Console& console) {
  const Proposal proposal = proposal_for(options);
  if (proposal.view_distance > max_accurate_range(proposal.sensor)) {
    console.err << fmt::format(
        "skycap: warning: {} is accurate up to {:g} m only, but the views are {:g} m from the "
        "target; choose a sensor with a longer range\n",
        options.sensor, max_accurate_range(proposal.sensor), proposal.view_distance);
  }
  return head_text(options) + sensor_text(options, proposal) + planner_text(options, proposal) +
         limits_text(options, proposal) + flight_text(options, proposal) +
         start_text(options, proposal);
}

/// Returns the sensor for a target: a LiDAR if the range of a D435 is too short.
std::string default_sensor(const InitOptions& options) {
  constexpr double max_side_of_d435 = 5.0;
  if (options.is_room() || options.gsd) return "intel_d435";
  const double side = make_target_box(options).sizes().maxCoeff();
  return side > max_side_of_d435 ? "ouster_os1_64" : "intel_d435";
}

int init(const InitOptions& given, const Console& console) {
  InitOptions options = given;
  if (options.out.extension() != ".yaml" && options.out.extension() != ".yml") {
    throw Error(ErrorKind::bad_usage, "--out must end in .yaml");
  }
  if (fs::exists(options.out)) {
    throw Error(ErrorKind::bad_usage,
                options.out.string() + " already exists; use another --out or move the file");
  }
  if (options.sensor.empty()) options.sensor = default_sensor(options);
  if (!options.gsd && wizard::is_photo_camera(options.sensor)) {
    throw Error(ErrorKind::bad_usage, "--sensor " + options.sensor +
                                          " is a photo camera and requires a ground sampling "
                                          "distance; set --gsd, such as --gsd 0.005");
  }
  const std::string text =
      options.gsd ? photo_mission_text(options) : survey_mission_text(options, console);
  config::parse_mission(text, options.out.string());  // throws if values conflict
  geometry::write_file(options.out, text);
  console.out << options.out.string() << ": mission for " << options.target << "; next: skycap "
              << (options.is_room() ? "next " + options.out.string() + " --survey survey"
                                    : "check " + options.out.string())
              << "\n"
              << std::flush;
  return 0;
}

}  // namespace

void add_init(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command = app.add_subcommand(
      "init", "Create a commented mission file for a model or a room, without a georeference");
  const auto options = std::make_shared<InitOptions>();
  command
      ->add_option("target", options->target,
                   "Mesh file, builtin:NAME, model:NAME, or room for a live survey")
      ->required();
  command->add_option(
      "--sensor", options->sensor,
      "Sensor preset (skycap presets) or description NAME.yaml (default: intel_d435, for "
      "models longer than 5 m ouster_os1_64). A photo camera requires --gsd");
  command
      ->add_option("--gsd", options->gsd,
                   "Ground sampling distance of a photo camera in metres; creates a photo mission")
      ->check(number_between(1e-5, 10.0));
  command->add_option("--vehicle", options->vehicle,
                      "Vehicle preset (skycap presets), description NAME.yaml, or none (default)");
  command->add_option("--size", options->size, "Size of a room in metres: X Y Z (default: 6 4 2.8)")
      ->expected(3)
      ->check(number_between(0.5, 1000.0));
  command->add_option("--out", options->out, "Mission file (default: mission.yaml)");
  run(*command, options, init, console, action);
}

}  // namespace skycap::missions::cli
