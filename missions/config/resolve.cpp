#include "missions/config/resolve.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/record_log.h"
#include "geometry/place/camera.h"
#include "missions/config/derived_values.h"
#include "missions/config/key_texts.h"
#include "missions/config/mission_keys.h"
#include "missions/config/mission_rules.h"
#include "missions/config/preset_files.h"
#include "missions/config/prior_sources.h"
#include "missions/config/sensor_reader.h"
#include "missions/config/vehicle_reader.h"
#include "sim/sensors/scanner_field.h"

namespace skycap::missions::config {
namespace {

using Eigen::Vector3d;
using sim::ScannerKind;

/// How far beside its place on a map a target is looked for, unless it may be off by more [m].
constexpr double most_beside_targets = 3.0;

std::filesystem::path folder_of(const MissionDocument& document) {
  return std::filesystem::path(document.file).parent_path();
}

/// What a vehicle is called in results. A path counts from the mission's folder, and is kept whole:
/// the package holds the mission elsewhere.
std::string vehicle_name(const MissionDocument& document, const std::string& given) {
  if (!given.ends_with(".yaml")) return given;
  return std::filesystem::absolute(named_from(folder_of(document), given)).string();
}

flight::Vehicle read_vehicle_of(const MissionDocument& document, const std::string& given,
                                const char* key) {
  try {
    return find_vehicle(vehicle_name(document, given));
  } catch (const Error& error) {
    document.refuse(key, error.what());
  }
}

/// CRC-32 of the description of a vehicle that is given as a file; nothing for a preset.
std::optional<std::uint32_t> checksum_of_vehicle(const MissionDocument& document,
                                                 const std::string& given) {
  constexpr std::size_t max_bytes = 1 << 20;
  const std::string file = vehicle_name(document, given);
  if (!file.ends_with(".yaml")) return std::nullopt;
  return geometry::crc32_of(geometry::read_file(file, max_bytes));
}

/// The scanner that `sensor.lidar` names.
sim::LidarConfig read_scanner(const MissionDocument& document) {
  const SensorDescription description =
      find_sensor(named_from(folder_of(document), *document.sensor.lidar));
  const auto* lidar = std::get_if<sim::LidarConfig>(&description.sensor);
  if (lidar == nullptr) {
    throw Error(ErrorKind::bad_config,
                description.name + " is a camera; set its values with the other keys of sensor");
  }
  return *lidar;
}

/// Fixes the scanner to the vehicle. Where no key says otherwise the axis of one that spins lies
/// along the flight, so that it sees both sides of the way, what is below and what is above; one
/// that looks one way looks to the left and down. It measures all the way.
void mount_scanner(MissionDocument& document) {
  sim::SurveySensorOptions& sensor = document.sensor.options;
  const sim::LidarConfig& lidar = *sensor.scanner;
  const bool spins = kind_of(lidar) != ScannerKind::rosette;
  if (!document.gives("scan.mount.rotation_deg")) {
    constexpr double right_angle = 0.5 * std::numbers::pi;
    document.scan.mount_rotation =
        spins ? Vector3d(0.0, right_angle, 0.0) : Vector3d(0.0, right_angle / 3.0, right_angle);
  }
  const Eigen::Isometry3d mount = document.scan.mount();
  constexpr double level = 0.02;
  if (spins && std::abs(mount.linear()(2, 2)) > level) {
    document.refuse("scan.mount.rotation_deg",
                    "the scanner's axis must be level for planned flights; remove the key, or "
                    "set [0, 90, 0] (along the flight direction)");
  }
  constexpr double steepest = 75.0 * std::numbers::pi / 180.0;
  if (!spins && std::abs(mount.linear()(2, 0)) > std::sin(steepest)) {
    document.refuse("scan.mount.rotation_deg",
                    "the scanner must not look up or down by more than 75 degrees in planned "
                    "flights; remove the key, or set [0, 30, 90] (to the left, 30 degrees down)");
  }
  sensor.mount = scanner_mount(lidar, mount);
  if (kind_of(lidar) == ScannerKind::line && document.gives("sensor.capture") &&
      !sensor.is_moving()) {
    document.refuse("sensor.capture",
                    "stops conflicts with a single-line LiDAR, which measures next to nothing at "
                    "a stop; remove it");
  }
  if (!document.gives("sensor.capture")) sensor.capture = sim::Capture::moving;
  if (!document.gives("sensor.frame_period")) sensor.frame_period = sim::scanner_period;
}

/// Puts the scanner in the camera's place.
void complete_scanner(MissionDocument& document, const Profiles& profiles) {
  if (!document.sensor.lidar) return;
  document.sensor.options.scanner = profiles.scanner;
  if (document.flight.is_flown()) mount_scanner(document);
  try {
    document.sensor.rosette = flown_rosette(document.sensor.options);
    document.sensor.options.camera =
        planning_camera(document.sensor.options, document.sensor.rosette);
  } catch (const Error& error) {
    document.refuse("sensor.lidar", error.what());
  }
}

/// How far aside a rosette's points are displaced, whose directions are far less exact than those
/// of turning lasers: also those of the ground at the pad, which is seen from all over the box.
double noise_aside(const MissionDocument& document) {
  const sim::LidarConfig& scanner = *document.sensor.options.scanner;
  const Eigen::AlignedBox3d box = unknown_box_of(document);
  if (kind_of(scanner) != ScannerKind::rosette || box.isEmpty()) return 0.0;
  return scanner.errors.angle_sigma * box.sizes().head<2>().norm();
}

/// A line's camera is as wide as it flies in a period.
void derive_line_camera(MissionDocument& document) {
  sim::SurveySensorOptions& sensor = document.sensor.options;
  if (kind_of(*sensor.scanner) != ScannerKind::line) return;
  const double distance = view_distance_of(document);
  document.planner.sampling.view_distance = distance;
  sensor.camera =
      line_camera(*sensor.scanner, sensor.frame_period,
                  document.flight.options.cruise_speed * sensor.frame_period / distance);
}

/// What follows from the scanner for the flight, where no key says otherwise.
void derive_scanner_flight(MissionDocument& document) {
  const sim::SurveySensorOptions& sensor = document.sensor.options;
  if (!sensor.mount) return;
  flight::FlightOptions& flight = document.flight.options;
  if (!document.gives("flight.initial_pattern")) {
    document.flight.opening = session::usual_opening(unknown_box_of(document));
  }
  // What is measured on the ways is measured on those of the survey.
  const bool keeps_views = flight.views == flight::MissionViews::survey;
  if (!document.gives("flight.order") && keeps_views) flight.order = flight::VisitOrder::survey;
  if (!document.gives("flight.cruise_speed")) {
    flight.cruise_speed = scanning_speed(sensor, view_distance_of(document), spacing_of(document),
                                         flight.flown().max_speed);
  }
  derive_line_camera(document);
  if (!document.gives("flight.map_error")) {
    // What is farther off than five deviations is rare among a hundred million points. Twice the
    // view distance is as far as what is flown near to is measured from.
    constexpr double deviations = 5.0;
    const double noise = range_noise(*sensor.scanner, 2.0 * view_distance_of(document));
    flight.map_error =
        std::max(flight.map_error, deviations * std::hypot(noise, noise_aside(document)));
  }
  if (!document.gives("scan.sensor")) document.scan.sensor = *document.sensor.lidar;
}

/// Where no more points fit in, one is within the spacing of every place of the surface: that is as
/// near as the registration distance asks, with a fifth of it left to the noise. Points nearer to
/// each other than a camera's rays no view could measure.
void derive_spacing(MissionDocument& document) {
  if (document.gives("planner.spacing")) return;
  constexpr double share = 0.8;
  double covering = share * document.evaluation.registration_distance;
  if (!document.sensor.lidar) {
    const Eigen::Vector2d pixels =
        geometry::Camera(document.sensor.options.camera.camera).focal_length_px();
    covering = std::max(covering, view_distance_of(document) / std::sqrt(pixels.prod()));
  }
  document.planner.sampling.spacing = std::min(spacing_of(document), covering);
}

/// What the building preset derives from other values, where no key says otherwise.
///
/// At building scale the published psi looks at a small part of the sight line only, and targets
/// hidden by the building itself are taken for visible; it is therefore the whole line. One view
/// proposal within a twentieth of d keeps the number of proposals below tau. Smooth walls are
/// measured so evenly that by the published k they have no frontiers at their rims.
void derive_building_preset(MissionDocument& document) {
  if (document.planner.preset != PlannerPreset::building) return;
  survey::see::SeeConfig& see = document.planner.see;
  const double distance = view_distance_of(document);
  if (!document.gives("planner.occlusion_search_distance")) {
    see.occlusion_search_distance = distance;
  }
  if (!document.gives("planner.frontier_spacing")) see.frontier_spacing = 0.05 * distance;
  if (!document.gives("planner.occluder_spacing")) {
    see.occluder_spacing = 2.0 * document.planner.sampling.resolution_radius;
  }
  if (!document.gives("planner.core_threshold")) {
    see.core_threshold = see_config(document).half_disc_threshold();
  }
}

/// The least height of views where no key says it.
void derive_ground_clearance(MissionDocument& document) {
  std::optional<double>& clearance = document.limits.ground_clearance;
  // A little more, so that a view at the limit can be proven.
  if (document.flight.is_flown() && !clearance) {
    clearance = document.flight.options.clearance + 0.01;
  }
  if (document.scene.ground && !clearance) clearance = 0.0;
}

/// So far beside targets their surface is looked for: not where neighbours are that the sensor will
/// see.
double beside_targets_of(const MissionDocument& document, const Eigen::AlignedBox3d& targets) {
  const site_data::SitePriors& site = *document.scene.priors;
  double beside = most_beside_targets;
  if (document.scene.neighbours || document.scene.model.empty()) {
    for (const geometry::Mesh* neighbour : scene::neighbours_of(site)) {
      beside = std::min(beside, 0.5 * targets.exteriorDistance(geometry::bounding_box(*neighbour)));
    }
  }
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    if (site.sources[i].role != site_data::Role::target) continue;
    beside = std::max(beside, site.priors[i].uncertainty);
  }
  return beside;
}

/// planner.scene_box where the mission has none but targets: around them, with 3 m on every side,
/// or half of the way to the nearest neighbour that the sensor sees, if that is less, or what they
/// may be off, if that is more. Where views are taken from must not be in it: there nothing is free
/// before it is measured.
void derive_scene_box(MissionDocument& document) {
  std::optional<Eigen::AlignedBox3d>& scene_box = document.planner.sampling.scene_box;
  if (scene_box || !document.scene.priors) return;
  const geometry::Mesh targets = surfaces_of(*document.scene.priors, site_data::Role::target);
  if (targets.triangles.empty()) return;
  Eigen::AlignedBox3d box = geometry::bounding_box(targets);
  const double beside = beside_targets_of(document, box);
  box.min().array() -= beside;
  box.max().array() += beside;
  if (document.scene.ground || document.flight.is_flown()) {
    // The ground is no target: what is so near to it counts as the ground.
    const double ground =
        document.scene.position.z() + 2.0 * document.evaluation.registration_distance;
    if (ground < box.max().z()) box.min().z() = std::max(box.min().z(), ground);
  }
  scene_box = box;
}

/// Everything that prior data is not needed for, and the checks of it.
void complete_own_keys(MissionDocument& document, const Profiles& profiles) {
  flight::FlightOptions& flight = document.flight.options;
  flight.vehicle_name = vehicle_name(document, flight.vehicle_name);
  flight.vehicle = profiles.vehicle;
  flight.stand_ins = profiles.stand_ins;
  for (std::string& name : flight.fleet.names) name = vehicle_name(document, name);
  flight.fleet.vehicles = profiles.fleet;
  lead_fleet(document);
  if (document.flight.is_flown() && !document.gives("flight.position_error")) {
    flight.position_error = flight.flown().position_error;
    for (const flight::Vehicle& vehicle : flight.fleet.vehicles) {
      flight.position_error = std::max(flight.position_error, vehicle.position_error);
    }
  }
  // What flies is there to be done soon: the paper's planners are for comparison.
  if (document.flight.is_flown() && !document.gives("planner.name")) {
    document.planner.name = survey::PlannerName::skycap;
  }
  // A scanner that captures in motion without being asked to leaves the goal as it is.
  if (document.gives("sensor.capture") && document.sensor.options.is_moving() &&
      !document.gives("planner.goal")) {
    document.planner.goal = PlannerGoal::minutes;
  }
  complete_scanner(document, profiles);
  check_scene(document);
  check_start(document);
  check_sensor(document);
  derive_spacing(document);
}

/// The rest, once prior data is known.
void complete_with_priors(MissionDocument& document,
                          std::shared_ptr<const site_data::SitePriors> priors) {
  make_sources_absolute(document);
  document.scene.priors = std::move(priors);
  document.scene.truth = truth_role(document);
  if (document.scene.priors) check_truth(document);
  derive_scene_box(document);
  derive_scanner_flight(document);
  check_flight(document);
  check_fleet(document);
  derive_building_preset(document);
  derive_ground_clearance(document);
  check_view_limits(document);
  check_planner(document);
}

survey::SurveyLimits survey_limits(const MissionDocument& document) {
  constexpr double seconds_per_minute = 60.0;
  survey::SurveyLimits limits = document.limits.options;
  limits.max_views = view_limit(document);
  if (document.limits.max_minutes) {
    limits.max_time = seconds_per_minute * *document.limits.max_minutes;
  }
  return limits;
}

scan::FlownScanOptions scan_options(const MissionDocument& document) {
  scan::FlownScanOptions options = document.scan;
  if (has_place(document)) options.site = site_of(document);
  options.pad = document.flight.options.takeoff.value_or(Vector3d::Zero());
  return options;
}

/// The options of all libraries from a document that is complete.
MissionSetup setup_of(const MissionDocument& document,
                      const std::optional<std::uint32_t>& vehicle_checksum) {
  MissionSetup setup{.name = document.name};
  evaluation::SimulationOptions& simulation = setup.simulation;
  simulation.scene = document.scene;
  simulation.sensor = document.sensor.options;
  simulation.sensor.navigation = document.scan.navigation;
  simulation.survey.flight = flight_options(document);
  simulation.survey.planner = planner_options(document, simulation.survey.flight);
  simulation.survey.limits = survey_limits(document);
  simulation.survey.start = start_options(document, simulation.survey.flight);
  simulation.evaluation = document.evaluation;
  simulation.oracle = {.max_views = document.limits.options.max_views,
                       .least_gain = document.planner.skycap_stop.least_gain};
  simulation.attainable_inputs = attainable_inputs(document);
  setup.lidar = document.sensor.lidar;
  setup.scan = scan_options(document);
  setup.live = document.live;
  setup.reference = {document.paper.views, document.paper.coverage, document.paper.planning_time,
                     document.paper.distance};
  setup.run = {document.seed, document.threads};
  setup.settings = survey_settings(document, vehicle_checksum);
  return setup;
}

}  // namespace

/// A document with all that it was resolved with, so that it can be resolved again.
struct MissionSetup::Source {
  MissionDocument document;
  Profiles profiles;
  std::shared_ptr<const site_data::SitePriors> priors;
  std::optional<double> geoid;
};

Profiles read_profiles(const MissionDocument& document) {
  Profiles profiles;
  const flight::FlightOptions& flight = document.flight.options;
  if (document.flight.is_flown()) {
    profiles.vehicle = read_vehicle_of(document, flight.vehicle_name, "flight.vehicle");
    profiles.vehicle_checksum = checksum_of_vehicle(document, flight.vehicle_name);
  }
  for (const std::string& name : flight.fleet.names) {
    profiles.fleet.push_back(read_vehicle_of(document, name, "flight.vehicles"));
  }
  if (!flight.fleet.names.empty()) {
    profiles.vehicle_checksum = checksum_of_vehicle(document, flight.fleet.names.front());
  }
  for (const char* name : {"generic", "generic_ardupilot", "m350_rtk"}) {  // one of each dialect
    profiles.stand_ins.push_back(find_vehicle(name));
  }
  MissionDocument led = document;  // whose contradictions come before those of its sensor
  led.flight.options.fleet.vehicles = profiles.fleet;
  lead_fleet(led);
  if (!document.sensor.lidar) return profiles;
  for (const auto& [path, place] : document.places) {
    if (path.starts_with("sensor.") && path != "sensor.lidar" && path != "sensor.capture" &&
        path != "sensor.frame_period") {
      document.refuse(path, "conflicts with sensor.lidar; remove one of the two");
    }
  }
  try {
    profiles.scanner = read_scanner(document);
    kind_of(*profiles.scanner);
  } catch (const Error& error) {
    document.refuse("sensor.lidar", error.what());
  }
  return profiles;
}

std::optional<double> geoid_undulation(const MissionDocument& document) {
  const Georeference& place = document.georeference;
  const bool is_flown = document.flight.is_flown() || !document.flight.options.fleet.names.empty();
  const bool is_asked_for = is_flown || !document.prior.empty();
  if (place.geoid_undulation || !has_place(document) || !is_asked_for) return std::nullopt;
  try {
    return site_data::egm96_undulation(*place.latitude_deg, *place.longitude_deg);
  } catch (const Error&) {  // PROJ or its grid is not installed
    return std::nullopt;
  }
}

MissionSetup resolve(MissionDocument document, const Profiles& profiles,
                     std::shared_ptr<const site_data::SitePriors> priors,
                     std::optional<double> geoid) {
  auto source = std::make_shared<MissionSetup::Source>(
      MissionSetup::Source{document, profiles, priors, geoid});
  complete_own_keys(document, profiles);
  std::optional<double>& undulation = document.georeference.geoid_undulation;
  if (!undulation) undulation = geoid;
  complete_with_priors(document, std::move(priors));
  MissionSetup setup = setup_of(document, profiles.vehicle_checksum);
  setup.source = std::move(source);
  setup.document = std::make_shared<const MissionDocument>(std::move(document));
  return setup;
}

MissionSetup resolve(MissionDocument document, const Report& report) {
  const Profiles profiles = read_profiles(document);
  if (document.prior.empty()) {
    const std::optional<double> geoid = geoid_undulation(document);
    return resolve(std::move(document), profiles, nullptr, geoid);
  }
  MissionDocument checked = document;  // errors in its keys are reported before files are read
  complete_own_keys(checked, profiles);
  const std::optional<double> geoid = geoid_undulation(checked);
  auto priors = read_priors(checked, site_frame(checked, geoid), report);
  return resolve(std::move(document), profiles, std::move(priors), geoid);
}

MissionSetup with_keys(const MissionSetup& setup, const std::vector<KeyOverride>& changes) {
  const MissionSetup::Source& source = *setup.source;
  MissionDocument document = source.document;
  override_keys(document, changes);
  MissionSetup changed = resolve(std::move(document), source.profiles, source.priors, source.geoid);
  changed.name = setup.name;
  changed.run = setup.run;
  return changed;
}

std::string MissionSetup::text(std::string_view key) const {
  const Key* const known = find_key(key);
  if (known == nullptr) throw std::out_of_range(std::string(key));
  const auto value = known->get(*document);
  return value ? to_text(*value) : "-";
}

MissionSetup read_mission(const std::filesystem::path& file,
                          const std::vector<KeyOverride>& overrides, const Report& report) {
  MissionDocument document = read_mission_document(file, overrides);
  if (document.scene.model.empty() && !truth_role(document)) {
    document.refuse(
        "scene.model",
        std::string("is missing; set a model, for example builtin:teapot") +
            (has_target(document)
                 ? ", or plan with --use-prior-as-truth, which uses the targets as ground truth"
                 : "") +
            ". A mission without a scene is a live survey: skycap next, serve and finish");
  }
  return resolve(std::move(document), report);
}

MissionSetup read_live_mission(const std::filesystem::path& file,
                               const std::vector<KeyOverride>& overrides, const Report& report) {
  MissionDocument document = read_mission_document(file, overrides);
  if (document.scene.model.empty()) check_live(document);
  return resolve(std::move(document), report);
}

MissionSetup parse_mission(const std::string& text, const std::string& name,
                           const std::vector<KeyOverride>& overrides) {
  return resolve(parse_mission_document(text, name, overrides));
}

}  // namespace skycap::missions::config
