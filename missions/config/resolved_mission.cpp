#include "missions/config/resolved_mission.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "geometry/error.h"
#include "geometry/place/camera.h"
#include "missions/config/fleet.h"
#include "missions/config/mission_flight.h"
#include "missions/config/mission_priors.h"
#include "missions/config/mission_rules.h"
#include "missions/config/opening_flight.h"
#include "missions/config/preset_files.h"
#include "missions/config/site.h"
#include "missions/config/survey_sensor.h"
#include "missions/config/vehicle_reader.h"

namespace skycap::missions::config {
namespace {

/// Fixes the scanner to the vehicle. Where no key says otherwise the axis of one that spins lies
/// along the flight, so that it sees both sides of the way, what is below and what is above; one
/// that looks one way looks to the left and down. It measures all the way.
void mount_scanner(config::MissionFile& given) {
  config::Mission& mission = given.mission;
  const sim::LidarConfig& lidar = *mission.sensor.scanner;
  const bool spins = kind_of(lidar) != ScannerKind::rosette;
  if (!given.gives("scan.mount.rotation_deg")) {
    constexpr double right_angle = 0.5 * std::numbers::pi;
    mission.scan.mount_rotation = spins ? Eigen::Vector3d(0.0, right_angle, 0.0)
                                        : Eigen::Vector3d(0.0, right_angle / 3.0, right_angle);
  }
  const Eigen::Isometry3d mount = mount_of(mission.scan);
  constexpr double level = 0.02;
  if (spins && std::abs(mount.linear()(2, 2)) > level) {
    given.refuse("scan.mount.rotation_deg",
                 "does not lay the scanner's axis level, as planned flights need it; leave it out, "
                 "or give [0, 90, 0]: along the way");
  }
  constexpr double steepest = 75.0 * std::numbers::pi / 180.0;
  if (!spins && std::abs(mount.linear()(2, 0)) > std::sin(steepest)) {
    given.refuse("scan.mount.rotation_deg",
                 "has the scanner look up or down by more than 75 degrees, so that planned flights "
                 "could not turn it to what they want to see; leave it out, or give [0, 30, 90]: "
                 "to the left, 30 degrees down");
  }
  mission.sensor.mount = scanner_mount(lidar, mount);
  if (kind_of(lidar) == ScannerKind::line && given.gives("sensor.capture") &&
      !mission.sensor.is_moving()) {
    given.refuse("sensor.capture",
                 "is stops, at which a scanner that measures a line sees next to nothing; leave it "
                 "out");
  }
  if (!given.gives("sensor.capture")) mission.sensor.capture = config::Capture::moving;
  if (!given.gives("sensor.frame_period")) mission.sensor.frame_period = scanner_period;
}

/// How far aside a rosette's points are displaced, whose directions are far less exact than those
/// of turning lasers: also those of the ground at the pad, which is seen from all over the box.
double noise_aside(const config::Mission& mission) {
  const sim::LidarConfig& scanner = *mission.sensor.scanner;
  const Eigen::AlignedBox3d box = unknown_box_of(mission);
  if (kind_of(scanner) != ScannerKind::rosette || box.isEmpty()) return 0.0;
  return scanner.errors.angle_sigma * box.sizes().head<2>().norm();
}

/// A line's camera is as wide as it flies in a period.
void derive_line_camera(config::Mission& mission) {
  config::SensorConfig& sensor = mission.sensor;
  if (kind_of(*sensor.scanner) != ScannerKind::line) return;
  const double distance = view_distance_of(mission);
  mission.planner.see.view_distance = distance;
  sensor.camera = line_camera(*sensor.scanner, sensor.frame_period,
                              mission.flight.cruise_speed * sensor.frame_period / distance);
}

/// What follows from the scanner for the flight, where no key says otherwise.
void derive_scanner_flight(config::MissionFile& given) {
  config::Mission& mission = given.mission;
  if (!mission.sensor.mount) return;
  if (!given.gives("flight.opening")) mission.flight.opening = usual_opening(mission);
  // What is measured on the ways is measured on those of the survey.
  const bool keeps_views = mission.flight.views == config::MissionViews::survey;
  if (!given.gives("flight.order") && keeps_views) {
    mission.flight.order = config::VisitOrder::survey;
  }
  if (!given.gives("flight.cruise_speed")) mission.flight.cruise_speed = scanning_speed(mission);
  derive_line_camera(mission);
  if (!given.gives("flight.map_error")) {
    // What is farther off than five deviations is rare among a hundred million points. Twice the
    // view distance is as far as what is flown near to is measured from.
    constexpr double deviations = 5.0;
    const double noise = range_noise(*mission.sensor.scanner, 2.0 * view_distance_of(mission));
    const double aside = noise_aside(mission);
    mission.flight.map_error =
        std::max(mission.flight.map_error, deviations * std::hypot(noise, aside));
  }
  if (!given.gives("scan.sensor")) mission.scan.sensor = *mission.sensor.lidar;
}

/// Reads the scanner that takes the camera's place.
void read_lidar(config::MissionFile& given) {
  for (const auto& [path, place] : given.places) {
    if (path.starts_with("sensor.") && path != "sensor.lidar" && path != "sensor.capture" &&
        path != "sensor.frame_period") {
      given.refuse(path, "does not go with sensor.lidar; leave one of the two out");
    }
  }
  config::SensorConfig& sensor = given.mission.sensor;
  try {
    sensor.scanner = read_scanner(*sensor.lidar, std::filesystem::path(given.name).parent_path());
    kind_of(*sensor.scanner);
  } catch (const Error& error) {
    given.refuse("sensor.lidar", error.what());
  }
  if (given.mission.flight.is_flown()) mount_scanner(given);
  try {
    sensor.camera = planning_camera(sensor);
  } catch (const Error& error) {
    given.refuse("sensor.lidar", error.what());
  }
}

/// Reads the description of what flies. A path counts from the mission's folder, and is kept whole:
/// the package holds the mission elsewhere.
flight::Vehicle read_vehicle(const config::MissionFile& given, std::string& vehicle,
                             const char* key) {
  if (vehicle.ends_with(".yaml")) {
    const std::filesystem::path folder = std::filesystem::path(given.name).parent_path();
    vehicle = std::filesystem::absolute(config::named_from(folder, vehicle)).string();
  }
  try {
    return config::find_vehicle(vehicle);
  } catch (const Error& error) {
    given.refuse(key, error.what());
  }
}

/// Of a fleet, too.
void read_vehicles(config::MissionFile& given) {
  config::FlightConfig& flight = given.mission.flight;
  if (flight.is_flown()) {
    flight.described = read_vehicle(given, flight.vehicle, "flight.vehicle");
  }
  for (std::string& vehicle : flight.fleet.vehicles) {
    flight.fleet.described.push_back(read_vehicle(given, vehicle, "flight.vehicles"));
  }
  lead_fleet(given);
}

/// Where no more points fit in, one is within the spacing of every place of the surface: that is as
/// near as the registration distance asks, with a fifth of it left to the noise. Points nearer to
/// each other than a camera's rays no view could measure.
void derive_spacing(config::MissionFile& given) {
  if (given.gives("planner.spacing")) return;
  constexpr double share = 0.8;
  const config::SensorConfig& sensor = given.mission.sensor;
  survey::see::SeeConfig& see = given.mission.planner.see;
  double covering = share * given.mission.evaluation.registration_distance;
  if (!sensor.lidar) {
    const Eigen::Vector2d pixels = geometry::Camera(sensor.camera.camera).focal_length_px();
    covering = std::max(covering, view_distance_of(given.mission) / std::sqrt(pixels.prod()));
  }
  see.spacing = std::min(see.effective_spacing(), covering);
}

/// What the building preset derives from other values, where no key says otherwise.
///
/// At building scale the published psi looks at a small part of the sight line only, and targets
/// hidden by the building itself are taken for visible; it is therefore the whole line. One view
/// proposal within a twentieth of d keeps the number of proposals below tau. Smooth walls are
/// measured so evenly that by the published k they have no frontiers at their rims.
void derive_building_preset(config::MissionFile& given) {
  survey::see::SeeConfig& see = given.mission.planner.see;
  const double distance = view_distance_of(given.mission);
  if (!given.gives("planner.occlusion_search_distance")) see.occlusion_search_distance = distance;
  if (!given.gives("planner.frontier_spacing")) see.frontier_spacing = 0.05 * distance;
  if (!given.gives("planner.occluder_spacing")) see.occluder_spacing = 2.0 * see.resolution_radius;
  if (!given.gives("planner.core_threshold")) see.core_threshold = see.half_disc_threshold();
}

/// EGM96's undulation where a geoid is asked for and no key says it; nothing where PROJ does not
/// have it, which those who need it complain of.
void derive_undulation(config::Mission& mission) {
  config::Georeference& place = mission.georeference;
  const bool is_asked_for = mission.flight.is_flown() || !mission.prior.empty();
  if (place.geoid_undulation || !has_place(mission) || !is_asked_for) return;
  try {
    place.geoid_undulation = site_data::egm96_undulation(*place.latitude_deg, *place.longitude_deg);
  } catch (const Error&) {  // PROJ or its grid is not installed
  }
}

/// The least height of views where no key says it.
void derive_ground_clearance(config::Mission& mission) {
  std::optional<double>& clearance = mission.limits.ground_clearance;
  // A little more, so that a view at the limit can be proven.
  if (mission.flight.is_flown() && !clearance) clearance = mission.flight.clearance + 0.01;
  if (mission.scene.ground && !clearance) clearance = 0.0;
}

}  // namespace

config::Mission resolved(config::MissionFile given, const Report& report) {
  config::Mission& mission = given.mission;
  read_vehicles(given);
  // What flies is there to be done soon: the paper's planners are for comparison.
  if (mission.flight.is_flown() && !given.gives("planner.name")) {
    mission.planner.name = config::PlannerName::skycap;
  }
  if (mission.sensor.is_moving() && !given.gives("planner.goal")) {
    mission.planner.goal = config::PlannerGoal::minutes;
  }
  if (mission.sensor.lidar) read_lidar(given);
  check_scene(given);
  check_start(given);
  check_sensor(given);
  derive_spacing(given);
  derive_undulation(mission);
  read_priors(given, report);
  derive_scene_box(mission);
  derive_scanner_flight(given);
  check_flight(given);
  check_fleet(given);
  if (mission.planner.preset == config::PlannerPreset::building) derive_building_preset(given);
  derive_ground_clearance(mission);
  check_view_limits(given);
  check_planner(given);
  return std::move(given.mission);
}

config::Mission read_mission(const std::filesystem::path& file,
                             const std::vector<config::KeyOverride>& overrides,
                             const Report& report) {
  config::MissionFile given = config::read_mission_file(file, overrides);
  const bool has_target = config::has_target(given.mission);
  if (given.mission.scene.model.empty() && !is_truth_prior(given.mission)) {
    given.refuse(
        "scene.model",
        std::string("is missing; give a text, such as builtin:teapot") +
            (has_target ? ", or plan with --dry-run prior, where the targets stand in for it"
                        : "") +
            ". Without a scene a mission is for live surveys: skycap next, serve and finish");
  }
  return resolved(std::move(given), report);
}

config::Mission read_live_mission(const std::filesystem::path& file,
                                  const std::vector<config::KeyOverride>& overrides,
                                  const Report& report) {
  config::MissionFile given = config::read_mission_file(file, overrides);
  if (given.mission.scene.model.empty()) check_live(given);
  return resolved(std::move(given), report);
}

config::Mission parse_mission(const std::string& text, const std::string& name,
                              const std::vector<config::KeyOverride>& overrides) {
  return resolved(config::parse_mission_file(text, name, overrides));
}

}  // namespace skycap::missions::config
