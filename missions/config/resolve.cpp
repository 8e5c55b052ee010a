#include "missions/config/resolve.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include "flight/export/scanner_commands.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/io/record_log.h"
#include "geometry/pose/camera.h"
#include "missions/config/derived_values.h"
#include "missions/config/inspection_rules.h"
#include "missions/config/key_texts.h"
#include "missions/config/mission_keys.h"
#include "missions/config/mission_rules.h"
#include "missions/config/photo_camera_reader.h"
#include "missions/config/photo_rules.h"
#include "missions/config/preset_files.h"
#include "missions/config/prior_sources.h"
#include "missions/config/sensor_reader.h"
#include "missions/config/vehicle_reader.h"
#include "sim/sensors/scanner_field.h"

namespace skycap::missions::config {
namespace {

using Eigen::Vector3d;
using sim::ScannerKind;

/// Default margin around targets in the scene box, unless their uncertainty is larger [m].
constexpr double max_target_offset = 3.0;

std::filesystem::path find_folder(const MissionDocument& document) {
  return std::filesystem::path(document.file).parent_path();
}

/// Returns the vehicle name in results. Paths relative to the mission's folder are made absolute,
/// because a package stores the mission in another folder.
std::string vehicle_name(const MissionDocument& document, const std::string& requested) {
  if (!requested.ends_with(".yaml")) return requested;
  return std::filesystem::absolute(named_from(find_folder(document), requested)).string();
}

flight::Vehicle read_mission_vehicle(const MissionDocument& document, const std::string& requested,
                                     const char* key) {
  try {
    return find_vehicle(vehicle_name(document, requested));
  } catch (const Error& error) {
    document.reject(key, error.what());
  }
}

/// Returns the CRC-32 of a vehicle description file, or nullopt for a preset.
std::optional<std::uint32_t> compute_vehicle_checksum(const MissionDocument& document,
                                                      const std::string& requested) {
  constexpr std::size_t max_bytes = 1 << 20;
  const std::string file = vehicle_name(document, requested);
  if (!file.ends_with(".yaml")) return std::nullopt;
  return geometry::compute_crc32(geometry::read_file(file, max_bytes));
}

/// Reads the scanner named by `sensor.lidar`.
sim::LidarConfig read_scanner(const MissionDocument& document, int& wpml_payload) {
  const SensorDescription description =
      find_sensor(named_from(find_folder(document), *document.sensor.lidar));
  wpml_payload = description.wpml_payload;
  const auto* lidar = std::get_if<sim::LidarConfig>(&description.sensor);
  if (lidar == nullptr) {
    throw Error(ErrorKind::bad_config,
                *document.sensor.lidar +
                    " is a camera, but sensor.lidar requires a LiDAR; remove sensor.lidar and set "
                    "sensor.preset or the other keys of sensor");
  }
  return *lidar;
}

/// Mounts the scanner on the vehicle. By default, the axis of a rotating scanner is along the
/// flight direction, so that it observes both sides, the ground and the sky. A scanner with a
/// limited field of view faces left and down by default. The scanner measures continuously.
void mount_scanner(MissionDocument& document) {
  sim::SurveySensorOptions& sensor = document.sensor.options;
  const sim::LidarConfig& lidar = *sensor.scanner;
  const bool spins = find_scanner_kind(lidar) != ScannerKind::rosette;
  if (!document.has("scan.mount.rotation_deg")) {
    constexpr double right_angle = 0.5 * std::numbers::pi;
    document.scan.mount_rotation =
        spins ? Vector3d(0.0, right_angle, 0.0) : Vector3d(0.0, right_angle / 3.0, right_angle);
  }
  const Eigen::Isometry3d mount = document.scan.mount();
  constexpr double level = 0.02;
  if (spins && std::abs(mount.linear()(2, 2)) > level) {
    document.reject("scan.mount.rotation_deg",
                    "the scanner's axis must be level for planned flights; remove the key, or "
                    "set [0, 90, 0] (along the flight direction)");
  }
  constexpr double max_slope = 75.0 * std::numbers::pi / 180.0;
  if (!spins && std::abs(mount.linear()(2, 0)) > std::sin(max_slope)) {
    document.reject("scan.mount.rotation_deg",
                    "the scanner must not point up or down by more than 75 degrees in planned "
                    "flights; remove the key, or set [0, 30, 90] (to the left, 30 degrees down)");
  }
  sensor.mount = scanner_mount(lidar, mount);
  if (find_scanner_kind(lidar) == ScannerKind::line && document.has("sensor.capture") &&
      !sensor.is_moving()) {
    document.reject("sensor.capture",
                    "stops conflicts with a single-line LiDAR, which measures almost nothing when "
                    "stationary; remove it");
  }
  if (!document.has("sensor.capture")) sensor.capture = sim::Capture::moving;
  if (!document.has("sensor.frame_period")) sensor.frame_period = sim::scanner_period;
}

/// Replaces the camera by the scanner.
void complete_scanner(MissionDocument& document, const Profiles& profiles) {
  if (!document.sensor.lidar) return;
  document.sensor.options.scanner = profiles.scanner;
  if (document.flight.has_vehicle()) mount_scanner(document);
  try {
    document.sensor.rosette = compute_rosette_field(document.sensor.options);
    document.sensor.options.camera =
        planning_camera(document.sensor.options, document.sensor.rosette);
  } catch (const Error& error) {
    document.reject("sensor.lidar", error.what());
  }
}

/// Returns the lateral standard deviation of a rosette's points [m], whose angular errors are much
/// larger than those of rotating scanners. The distance is the horizontal diagonal of the unknown
/// box, because the ground at the pad is observed from its far side as well.
double noise_aside(const MissionDocument& document) {
  const sim::LidarConfig& scanner = *document.sensor.options.scanner;
  const Eigen::AlignedBox3d box = compute_unknown_box(document);
  if (find_scanner_kind(scanner) != ScannerKind::rosette || box.isEmpty()) return 0.0;
  return scanner.errors.angle_sigma * box.sizes().head<2>().norm();
}

/// Sets the camera model of a single-line scanner. Its width is the distance flown in a frame
/// period.
void derive_line_camera(MissionDocument& document) {
  sim::SurveySensorOptions& sensor = document.sensor.options;
  if (find_scanner_kind(*sensor.scanner) != ScannerKind::line) return;
  const double distance = compute_view_distance(document);
  document.planner.sampling.view_distance = distance;
  sensor.camera =
      line_camera(*sensor.scanner, sensor.frame_period,
                  document.flight.options.cruise_speed * sensor.frame_period / distance);
}

/// Derives flight options from the scanner for keys that are not set.
void derive_scanner_flight(MissionDocument& document) {
  const sim::SurveySensorOptions& sensor = document.sensor.options;
  if (!sensor.mount) return;
  flight::FlightOptions& flight = document.flight.options;
  if (!document.has("flight.initial_pattern") && !survey::pattern_of(document.planner.name)) {
    document.flight.initial_pattern =
        session::default_initial_pattern(compute_unknown_box(document));
  }
  // En-route measurements are made on the legs of the survey, so that its order is kept.
  const bool keeps_views = flight.views != flight::MissionViews::replanned;
  if (!document.has("flight.order") && keeps_views) flight.order = flight::VisitOrder::survey;
  if (!document.has("flight.cruise_speed")) {
    flight.cruise_speed =
        scanning_speed(sensor, compute_view_distance(document), compute_spacing(document),
                       flight.required_vehicle().max_speed);
  }
  derive_line_camera(document);
  if (!document.has("flight.map_error")) {
    // Points with errors above five standard deviations are rare among 100 million points. Surfaces
    // near the path are measured from up to twice the view distance.
    constexpr double deviations = 5.0;
    const double noise = range_noise(*sensor.scanner, 2.0 * compute_view_distance(document));
    flight.map_error =
        std::max(flight.map_error, deviations * std::hypot(noise, noise_aside(document)));
  }
  if (!document.has("scan.sensor")) document.scan.sensor = *document.sensor.lidar;
}

/// Keeps the order of a pattern's rows in the route if the key is not set.
void derive_pattern_order(MissionDocument& document) {
  if (survey::pattern_of(document.planner.name) && !document.has("flight.order")) {
    document.flight.options.order = flight::VisitOrder::survey;
  }
}

/// Selects the survey's views for missions without a choice: other planners have no surface model,
/// an order belongs to its views, the time of a fleet is not that of one vehicle, and a flying
/// scanner measures on the survey's own paths.
void derive_mission_views(MissionDocument& document) {
  flight::FlightOptions& flight = document.flight.options;
  if (flight.views != flight::MissionViews::fastest) return;
  const bool has_choice = document.flight.has_vehicle() && !document.is_for_known_target() &&
                          document.planner.name == survey::PlannerName::skycap &&
                          flight.order == flight::VisitOrder::shortest && !flight.is_fleet() &&
                          !document.sensor.options.scans_in_flight();
  if (!has_choice) flight.views = flight::MissionViews::survey;
}

/// Derives the sampling from planner.density_per_m2 for keys that are not set. The neighbourhood of
/// SEE and SEE++ is a disc with 4 pi points. At the default view distance, the rays on a wall are
/// half the planned distance apart, which is also the default of the planner skycap.
void derive_density(MissionDocument& document) {
  SamplingSection& sampling = document.planner.sampling;
  if (!sampling.density_per_m2) return;
  if (!document.has("planner.resolution_radius")) {
    sampling.resolution_radius = 2.0 / std::sqrt(*sampling.density_per_m2);
  }
  if (!document.has("planner.density")) sampling.density = compute_volume_density(document);
  if (!document.has("planner.view_distance") && !document.sensor.lidar) {
    const Eigen::Vector2d pixels =
        geometry::Camera(document.sensor.options.camera.camera).focal_length_px();
    sampling.view_distance = 0.5 * compute_density_distance(document) * std::sqrt(pixels.prod());
  }
}

/// Derives the point spacing. If no further point fits, every surface position is within the
/// spacing of a stored point. The spacing is 80% of the coverage distance; the rest is a margin for
/// noise. It is not smaller than the distance between camera rays, because no view could provide
/// such points.
void derive_spacing(MissionDocument& document) {
  if (document.has("planner.spacing")) return;
  constexpr double share = 0.8;
  double covering = share * compute_planned_distance(document);
  if (document.planner.sampling.density_per_m2) {  // Several views reach the density together.
    document.planner.sampling.spacing = covering;
    return;
  }
  if (!document.sensor.lidar) {
    const Eigen::Vector2d pixels =
        geometry::Camera(document.sensor.options.camera.camera).focal_length_px();
    covering = std::max(covering, compute_view_distance(document) / std::sqrt(pixels.prod()));
  }
  document.planner.sampling.spacing = std::min(compute_spacing(document), covering);
}

/// Derives values of the building preset for keys that are not set.
///
/// At building scale, the published psi covers only a small part of the sight line, so that targets
/// hidden by the building appear visible. Therefore psi is the whole sight line. Proposing one view
/// per d/20 keeps the number of proposals below tau. Smooth walls are measured so evenly that the
/// published k yields no frontiers at their edges.
void derive_building_preset(MissionDocument& document) {
  if (document.planner.preset != PlannerPreset::building) return;
  survey::see::SeeConfig& see = document.planner.see;
  const double distance = compute_view_distance(document);
  if (!document.has("planner.occlusion_search_distance")) {
    see.occlusion_search_distance = distance;
  }
  if (!document.has("planner.frontier_spacing")) see.frontier_spacing = 0.05 * distance;
  if (!document.has("planner.occluder_spacing")) {
    see.occluder_spacing = 2.0 * document.planner.sampling.resolution_radius;
  }
  if (!document.has("planner.core_threshold")) {
    see.core_threshold = see_config(document).half_disc_threshold();
  }
}

/// Derives the minimum height of views if the key is not set.
void derive_ground_clearance(MissionDocument& document) {
  std::optional<double>& clearance = document.limits.ground_clearance;
  // A small margin, so that paths to a view at the limit can be verified.
  if (document.flight.has_vehicle() && !clearance) {
    clearance = document.flight.options.clearance + 0.01;
  }
  if (document.scene.ground && !clearance) clearance = 0.0;
}

/// Returns the margin around targets within which their surface is expected [m]. It does not extend
/// to neighbours that the sensor observes.
double margin_around_targets(const MissionDocument& document, const Eigen::AlignedBox3d& targets) {
  const site_data::SitePriors& site = *document.scene.priors;
  double margin = max_target_offset;
  if (document.scene.neighbours || document.scene.model.empty()) {
    for (const geometry::Mesh* neighbour : scene::find_neighbours(site)) {
      margin = std::min(margin, 0.5 * targets.exteriorDistance(geometry::bounding_box(*neighbour)));
    }
  }
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    if (site.sources[i].role != site_data::Role::target) continue;
    margin = std::max(margin, site.priors[i].uncertainty);
  }
  return margin;
}

/// Derives planner.scene_box from the targets. The margin is 3 m, or half the distance to the
/// nearest observable neighbour if that is smaller. It is at least the targets' uncertainty. Views
/// must be outside the box, because space inside it is unobserved before the survey.
void derive_scene_box(MissionDocument& document) {
  std::optional<Eigen::AlignedBox3d>& scene_box = document.planner.sampling.scene_box;
  if (scene_box || !document.scene.priors) return;
  const geometry::Mesh targets = make_surfaces(*document.scene.priors, site_data::Role::target);
  if (targets.triangles.empty()) return;
  Eigen::AlignedBox3d box = geometry::bounding_box(targets);
  const double margin = margin_around_targets(document, box);
  box.min().array() -= margin;
  box.max().array() += margin;
  const bool has_ground =
      document.scene.ground || (document.flight.has_vehicle() && !has_outline_as_truth(document));
  if (has_ground) {
    // Points close to the ground count as ground, which is not a target.
    const double ground =
        document.scene.position.z() + 2.0 * document.evaluation.registration_distance;
    if (ground < box.max().z()) box.min().z() = std::max(box.min().z(), ground);
  }
  scene_box = box;
}

/// Completes and checks all keys that do not depend on prior data.
void complete_own_keys(MissionDocument& document, const Profiles& profiles) {
  flight::FlightOptions& flight = document.flight.options;
  flight.vehicle_name = vehicle_name(document, flight.vehicle_name);
  flight.vehicle = profiles.vehicle;
  flight.substitutes = profiles.substitutes;
  for (std::string& name : flight.fleet.names) name = vehicle_name(document, name);
  flight.fleet.vehicles = profiles.fleet;
  lead_fleet(document);
  if (document.flight.has_vehicle() && !document.has("flight.position_error")) {
    flight.position_error = flight.required_vehicle().position_error;
    for (const flight::Vehicle& vehicle : flight.fleet.vehicles) {
      flight.position_error = std::max(flight.position_error, vehicle.position_error);
    }
  }
  // Flown missions use the planner skycap by default; the paper's planners serve for comparison.
  if (document.flight.has_vehicle() && !document.has("planner.name")) {
    document.planner.name = survey::PlannerName::skycap;
  }
  if (document.flight.has_vehicle() && !document.has("planner.goal")) {
    document.planner.goal = PlannerGoal::minutes;
  }
  if (document.planner.file) {  // absolute, because a package stores the mission in another folder
    document.planner.file =
        std::filesystem::absolute(find_folder(document) / *document.planner.file).string();
  }
  complete_scanner(document, profiles);
  check_photo(document);
  check_inspection(document);
  if (profiles.photo_camera) {
    std::string& name = *document.sensor.photo_camera;
    name = vehicle_name(document, name);  // a path is kept whole, as a vehicle's
    complete_photo(document, *profiles.photo_camera);
  }
  complete_inspection(document);
  check_scene(document);
  check_start(document);
  check_sensor(document);
  derive_density(document);
  derive_spacing(document);
  check_density(document);
}

/// Completes the keys that depend on prior data.
void complete_with_priors(MissionDocument& document,
                          std::shared_ptr<const site_data::SitePriors> priors) {
  make_sources_absolute(document);
  document.scene.priors = priors ? std::move(priors) : make_outline_priors(document);
  document.scene.truth = truth_role(document);
  if (document.scene.priors && !document.is_for_known_target()) check_truth(document);
  derive_scene_box(document);
  derive_scanner_flight(document);
  derive_pattern_order(document);
  derive_mission_views(document);
  check_flight(document);
  check_fleet(document);
  derive_building_preset(document);
  derive_ground_clearance(document);
  check_view_limits(document);
  if (!document.is_for_known_target()) check_planner(document);
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

scan::ScanFlightOptions scan_options(const MissionDocument& document) {
  scan::ScanFlightOptions options = document.scan;
  if (is_georeferenced(document)) options.site = make_site(document);
  options.pad = document.flight.options.takeoff.value_or(Vector3d::Zero());
  return options;
}

/// Adds targets to what is in the way of a flight: photos are planned for surfaces that are known,
/// and nothing measures them on the flight.
void keep_off_targets(const MissionDocument& document, flight::FlightOptions& flight) {
  if (!document.flight.has_vehicle() || !document.scene.priors) return;
  const site_data::SitePriors& site = *document.scene.priors;
  for (std::size_t i = 0; i < site.priors.size(); ++i) {
    if (site.sources[i].role != site_data::Role::target) continue;
    flight.airspace.priors.push_back(std::make_shared<const flight::PriorObstacle>(
        site_data::make_obstacle(site.sources[i], site.priors[i])));
  }
}

/// Returns the options of all modules for a completed document.
MissionSetup make_setup(const MissionDocument& document,
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
                       .min_gain = document.planner.surfel_stop.min_gain};
  simulation.attainable_inputs = attainable_inputs(document);
  setup.lidar = document.sensor.lidar;
  setup.scan = scan_options(document);
  setup.live = document.live;
  setup.reference = {document.paper.views, document.paper.coverage, document.paper.planning_time,
                     document.paper.distance};
  setup.run = {document.seed, document.threads};
  setup.settings = survey_settings(document, vehicle_checksum);
  if (document.is_for_known_target()) keep_off_targets(document, simulation.survey.flight);
  return setup;
}

/// The vehicles carry the scanner instead of their own camera.
void carry(int payload, Profiles& profiles) {
  if (profiles.vehicle) profiles.vehicle->wpml.payload = payload;
  for (flight::Vehicle& vehicle : profiles.fleet) vehicle.wpml.payload = payload;
  for (flight::Vehicle& vehicle : profiles.substitutes) vehicle.wpml.payload = payload;
}

}  // namespace

/// Inputs of resolve(), stored to resolve the mission again with other keys.
struct MissionSetup::Source {
  MissionDocument document;
  Profiles profiles;
  std::shared_ptr<const site_data::SitePriors> priors;
  std::optional<double> geoid;
};

Profiles read_profiles(const MissionDocument& document) {
  check_photo(document);
  Profiles profiles;
  const flight::FlightOptions& flight = document.flight.options;
  if (document.flight.has_vehicle()) {
    profiles.vehicle = read_mission_vehicle(document, flight.vehicle_name, "flight.vehicle");
    profiles.vehicle_checksum = compute_vehicle_checksum(document, flight.vehicle_name);
  }
  for (const std::string& name : flight.fleet.names) {
    profiles.fleet.push_back(read_mission_vehicle(document, name, "flight.vehicles"));
  }
  if (!flight.fleet.names.empty()) {
    profiles.vehicle_checksum = compute_vehicle_checksum(document, flight.fleet.names.front());
  }
  for (const char* name : {"generic", "generic_ardupilot", "m350_rtk"}) {  // one per dialect
    profiles.substitutes.push_back(find_vehicle(name));
  }
  MissionDocument led = document;  // reports conflicts of fleet keys before those of the sensor
  led.flight.options.fleet.vehicles = profiles.fleet;
  lead_fleet(led);
  if (document.is_photo()) {
    try {
      profiles.photo_camera =
          find_photo_camera(named_from(find_folder(document), *document.sensor.photo_camera));
    } catch (const Error& error) {
      document.reject("sensor.photo_camera", error.what());
    }
  }
  if (!document.sensor.lidar) return profiles;
  for (const auto& [path, location] : document.locations) {
    if (path.starts_with("sensor.") && path != "sensor.lidar" && path != "sensor.capture" &&
        path != "sensor.frame_period") {
      document.reject(path, "conflicts with sensor.lidar; remove one of the two");
    }
  }
  try {
    int payload = 0;
    profiles.scanner = read_scanner(document, payload);
    carry(payload != 0 ? payload : flight::psdk_payload, profiles);
    find_scanner_kind(*profiles.scanner);
  } catch (const Error& error) {
    document.reject("sensor.lidar", error.what());
  }
  return profiles;
}

std::optional<double> geoid_undulation(const MissionDocument& document) {
  const Georeference& location = document.georeference;
  const bool has_vehicle =
      document.flight.has_vehicle() || !document.flight.options.fleet.names.empty();
  const bool is_asked_for = has_vehicle || !document.prior.empty();
  if (location.geoid_undulation || !is_georeferenced(document) || !is_asked_for)
    return std::nullopt;
  try {
    return site_data::egm96_undulation(*location.latitude_deg, *location.longitude_deg);
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
  MissionSetup setup = make_setup(document, profiles.vehicle_checksum);
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
  MissionDocument checked = document;  // reports errors of keys before prior data is read
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
  if (document.scene.model.empty() && !truth_role(document) && !document.is_for_known_target()) {
    document.reject(
        "scene.model",
        std::string("is missing; set a model, for example builtin:teapot") +
            (has_target(document) || document.planner.patterns.top
                 ? ", or plan with --use-prior-as-truth, which uses the targets as ground truth"
                 : "") +
            ". A mission without a scene is a live survey, which uses skycap next, serve and "
            "finish");
  }
  return resolve(std::move(document), report);
}

MissionSetup read_live_mission(const std::filesystem::path& file,
                               const std::vector<KeyOverride>& overrides, const Report& report) {
  MissionDocument document = read_mission_document(file, overrides);
  if (document.scene.model.empty() && !document.is_for_known_target()) check_live(document);
  return resolve(std::move(document), report);
}

MissionSetup parse_mission(const std::string& text, const std::string& name,
                           const std::vector<KeyOverride>& overrides) {
  return resolve(parse_mission_document(text, name, overrides));
}

}  // namespace skycap::missions::config
