#include "missions/comparison/flight_comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "flight/export/export.h"
#include "flight/interpreter/interpret.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/points/spatial_index.h"
#include "geometry/surfaces/mesh_distance.h"
#include "missions/config/photo_rules.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/coverage_map.h"
#include "missions/package/fleet/timetable_file.h"
#include "missions/package/inspection_summary.h"
#include "missions/package/package.h"
#include "missions/package/replanned_mission.h"
#include "missions/photo/photo_site.h"

namespace skycap::missions::comparison {
namespace {

using Eigen::Vector3d;
using session::ViewInFlight;

constexpr const char* cloud_name = "cloud.ply";

/// Returns the numbers in a file name, such as {2, 1} for "mission-2-1.plan".
std::vector<std::size_t> numbers_in(const std::string& name) {
  std::vector<std::size_t> numbers;
  bool is_number = false;
  for (const char c : name) {
    const bool is_digit = c >= '0' && c <= '9';
    if (is_digit && !is_number) numbers.push_back(0);
    if (is_digit) numbers.back() = 10 * numbers.back() + static_cast<std::size_t>(c - '0');
    is_number = is_digit;
  }
  return numbers;
}

/// Returns the route files of the mission's vehicle, in flight order.
std::vector<std::filesystem::path> find_routes(const std::filesystem::path& folder,
                                               const flight::FlightOptions& options) {
  if (options.is_fleet()) {
    throw Error(ErrorKind::bad_usage,
                folder.string() +
                    " is a mission of several vehicles; name the files of one vehicle with "
                    "--route");
  }
  const flight::Format own = package::own_format(options.required_vehicle());
  for (const flight::Format format : {own, flight::Format::csv}) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      if (package::is_flight_file(name, format) && !package::is_fleet_file(name)) {
        files.push_back(entry.path());
      }
    }
    std::ranges::sort(files, {}, [](const std::filesystem::path& file) {
      return std::pair(numbers_in(file.filename().string()), file.string());
    });
    if (!files.empty()) return files;
  }
  throw Error(ErrorKind::bad_file,
              folder.string() + " contains no route file; plan the mission again");
}

/// Flight of the vehicle that flew, which may be one of a fleet, and its take-off point.
struct OwnFlight {
  flight::FlightOptions options;
  Vector3d pad;
};

OwnFlight find_own_flight(const std::vector<std::filesystem::path>& routes,
                          const package::PackagedSurvey& survey) {
  const std::filesystem::path& first = routes.front();
  for (const std::filesystem::path& file : routes) {
    if (package::parse_vehicle_number(file.filename().string()) ==
        package::parse_vehicle_number(first.filename().string())) {
      continue;
    }
    throw Error(ErrorKind::bad_usage, file.string() + " belongs to another vehicle than " +
                                          first.string() +
                                          "; name the files of one vehicle with --route");
  }
  OwnFlight own{package::find_file_flight(first, survey.flight), survey.pad};
  if (survey.flight.is_fleet()) own.pad = own.options.takeoff.value_or(survey.pad);
  return own;
}

/// Returns the flight of a route file.
flight::PlannedFlight read_route(const std::filesystem::path& file, const OwnFlight& own) {
  flight::FlightFacts facts = own.options.facts();
  facts.pad = own.pad;
  facts.is_pad_known = true;
  facts.vehicle = own.options.required_vehicle();
  const flight::InterpretedRoute route = flight::interpret_file(file, facts);
  const flight::Motion motion(own.options.required_vehicle(),
                              own.options.route(facts.pad).conditions);
  return flight::make_planned_flight(route, motion);
}

/// Distance from which a log counts as that of another place [m].
constexpr double max_log_distance = 2000.0;

/// Throws Error{bad_file} if the track stays far from `positions`, those of the mission.
void require_near(const flight::FlownTrack& track, const std::vector<Vector3d>& positions,
                  const std::filesystem::path& log) {
  double min_distance = std::numeric_limits<double>::infinity();
  for (const flight::TrackState& state : track.states) {
    for (const Vector3d& position : positions) {
      min_distance = std::min(min_distance, (state.position - position).head<2>().norm());
    }
  }
  if (min_distance <= max_log_distance) return;
  throw Error(ErrorKind::bad_file,
              fmt::format("{}: the flight stays {:.1f} km away from the mission; use a log of this "
                          "mission, and check site.latitude_deg and site.longitude_deg",
                          log.string(), 1e-3 * min_distance));
}

flight::FlownTrack read_track(const CompareRequest& request, const flight::FlightOptions& options,
                              const Vector3d& pad, const std::vector<Vector3d>& positions) {
  flight::FlownTrack track;
  for (const std::filesystem::path& log : request.logs) {
    const flight::FlownLog content = flight::read_flown_log(log);
    flight::FlownTrack next;
    try {
      next = place_track(content, options.site, options.is_georeferenced, pad, request.heights);
    } catch (const Error& error) {
      throw Error(error.kind(), log.string() + ": " + error.what());
    }
    require_near(next, positions, log);
    append_track(track, std::move(next));
  }
  return track;
}

/// Returns whether a position is above the pad, where distances are not measured.
bool is_above_pad(const Vector3d& position, const std::optional<Vector3d>& pad, double climb) {
  constexpr double pad_radius = 3.0;
  if (!pad) return false;
  const Vector3d from_pad = position - *pad;
  return from_pad.head<2>().norm() < pad_radius && from_pad.z() < climb;
}

/// Returns the minimum of `distance` over the track, except above the pad. Sets the distances of
/// the states, unless they are known.
template <class Distance>
std::optional<SurfaceDistance> measure_track(const std::optional<Vector3d>& pad, double climb,
                                             const Distance& distance,
                                             FlightComparison& comparison) {
  constexpr double step = 0.1;
  SurfaceDistance nearest{std::numeric_limits<double>::infinity()};
  std::vector<double> distances;
  const std::vector<flight::TrackState>& states = comparison.track.states;
  const double begin = states.front().time;
  const auto measure = [&](const Vector3d& position, double time) {
    if (is_above_pad(position, pad, climb)) return flight::unspecified;
    const double found = distance(position);
    if (found < nearest.distance) nearest = {found, position, time};
    return found;
  };
  distances.push_back(measure(states.front().position, 0.0));
  for (std::size_t i = 1; i < states.size(); ++i) {
    const Vector3d displacement = states[i].position - states[i - 1].position;
    const double duration = states[i].time - states[i - 1].time;
    // The path in a gap is unknown.
    const bool is_known = duration <= flight::min_log_gap;
    const auto count =
        is_known ? static_cast<std::size_t>(std::max(1.0, std::ceil(displacement.norm() / step)))
                 : std::size_t{1};
    double last = flight::unspecified;
    for (std::size_t k = 1; k <= count; ++k) {
      const double t = static_cast<double>(k) / static_cast<double>(count);
      last = measure(states[i - 1].position + t * displacement,
                     states[i - 1].time + t * duration - begin);
    }
    distances.push_back(last);
  }
  if (std::isinf(nearest.distance)) return std::nullopt;
  if (comparison.distances.empty()) comparison.distances = std::move(distances);
  return nearest;
}

/// Measures the distance of the track from a cloud, except above the pad, and keeps a part of the
/// cloud.
void measure_cloud(const std::filesystem::path& file, const std::optional<Vector3d>& pad,
                   double climb, FlightComparison& comparison) {
  constexpr double typical_radius = 2.0;
  constexpr std::size_t max_kept = 200'000;
  const std::vector<Eigen::Vector3f> points = geometry::read_cloud(file).positions;
  if (points.empty()) return;
  geometry::SpatialIndex index(typical_radius);
  for (const Eigen::Vector3f& point : points) index.insert(point);
  comparison.cloud_distance = measure_track(
      pad, climb,
      [&](const Vector3d& position) {
        const auto found = index.nearest(position.cast<float>(), 1);
        return (index.point(found.front().index).cast<double>() - position).norm();
      },
      comparison);
  const std::size_t step = (points.size() + max_kept - 1) / max_kept;
  for (std::size_t i = 0; i < points.size(); i += step) comparison.cloud.push_back(points[i]);
}

geometry::View make_view(const Vector3d& position, double yaw_deg, double pitch_deg) {
  return {position, flight::compute_direction({geometry::radians_per_degree * yaw_deg,
                                               geometry::radians_per_degree * pitch_deg})};
}

double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Returns the index of the mission's view that a planned capture belongs to.
std::size_t find_view(const flight::PlannedCapture& capture,
                      const std::vector<geometry::View>& views) {
  const bool has_direction = std::isfinite(capture.yaw_deg) && std::isfinite(capture.pitch_deg);
  std::size_t nearest = 0;
  double min_cost = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < views.size(); ++i) {
    double cost = (views[i].position - capture.position).norm();
    if (has_direction) {
      const geometry::View view = make_view(capture.position, capture.yaw_deg, capture.pitch_deg);
      cost += angle_between(view.direction, views[i].direction);
    }
    if (cost < min_cost) min_cost = cost, nearest = i;
  }
  return nearest;
}

/// Marks the planned captures that must be repeated, and collects their views.
void find_missed(const package::PackagedSurvey& survey, FlightComparison& comparison) {
  const geometry::CameraConfig& camera = survey.flight.capture.camera;
  const double max_turn = 0.5 * std::min(camera.horizontal_fov, camera.vertical_fov);
  for (std::size_t i = 0; i < comparison.route.captures.size(); ++i) {
    const flight::CaptureComparison& capture = comparison.route.captures[i];
    const bool is_missed = !capture.is_made || capture.turned.value_or(0.0) > max_turn;
    comparison.is_missed.push_back(is_missed);
    if (is_missed && !survey.views.empty()) {
      comparison.missed_views.push_back(find_view(comparison.plan.captures[i], survey.views));
    }
  }
  std::ranges::sort(comparison.missed_views);
  comparison.missed_views.erase(
      std::unique(comparison.missed_views.begin(), comparison.missed_views.end()),
      comparison.missed_views.end());
}

/// Returns the capture points of some views. The path to each contains the paths to the views
/// before it that are left out.
std::vector<flight::CapturePoint> make_patch_points(const package::PackagedSurvey& survey,
                                                    const std::vector<std::size_t>& views) {
  std::vector<flight::CapturePoint> all =
      package::make_capture_points(survey.flight, survey.views, survey.paths);
  std::vector<flight::CapturePoint> kept;
  std::vector<Vector3d> path;
  bool is_known = true;
  for (flight::CapturePoint& capture_point : all) {
    if (capture_point.approach_path.empty()) is_known = false;
    // The first point of a path is the last one of the path before it.
    const std::vector<Vector3d>& approach = capture_point.approach_path;
    const bool is_joined = !path.empty() && !approach.empty() && path.back() == approach.front();
    path.insert(path.end(), approach.begin() + (is_joined ? 1 : 0), approach.end());
    if (!std::ranges::binary_search(views, capture_point.view_index)) continue;
    capture_point.approach_path = is_known ? std::move(path) : std::vector<Vector3d>();
    path.clear();
    is_known = true;
    kept.push_back(std::move(capture_point));
  }
  return kept;
}

package::SurveyMission plan_patch(const package::PackagedSurvey& survey, const OwnFlight& own,
                                  const std::vector<std::size_t>& views,
                                  geometry::OutputFolder& folder, const std::stop_token& stop) {
  package::SurveyMission mission;
  mission.image_motion = own.options.image_motion_bounds();
  std::vector<flight::CapturePoint> points = make_patch_points(survey, views);
  // The survey began at another take-off point.
  if (!points.empty() && own.pad != survey.pad) points.front().approach_path.clear();
  mission.route = package::plan_flight(own.options, survey.measured, own.pad, std::move(points),
                                       survey.landing_surfaces, stop);
  mission.files = package::stage_flight(
      survey.name + " " + patch_stem, own.options, mission.route, survey.measured,
      package::package_formats(own.options.required_vehicle()), folder, patch_stem);
  return mission;
}

/// Simulates captures in the scene of the mission.
class CoverageSimulation {
 public:
  /// Keeps a reference to the options. `folder` is the base of the scene's paths.
  CoverageSimulation(const evaluation::SimulationOptions& options, const session::RunOptions& run,
                     const std::filesystem::path& folder, const std::stop_token& stop)
      : options_(options), run_(run), scene_(options, folder, run.threads), stop_(stop) {
    figures_.truth = {scene_.samples(),
                      {},
                      scene_.visible(run.threads, stop),
                      {},
                      geometry::surface_area(scene_.model())};
  }

  simulation::CoveredAgain simulate(const std::vector<ViewInFlight>& views) const {
    return simulation::reflight_coverage(options_, scene_, views, run_.seed, run_.threads, {},
                                         stop_);
  }
  package::ReflightCoverage measure(const simulation::CoveredAgain& covered) const {
    return package::simulate_reflight(figures_, covered);
  }
  const evaluation::SurveyScene& scene() const { return scene_; }
  /// Sets the missing surface and the map of these captures.
  void map_surface(const simulation::CoveredAgain& covered, const std::vector<ViewInFlight>& views,
                   ComparedCoverage& coverage) const {
    std::vector<geometry::View> poses;
    for (const ViewInFlight& view : views) poses.push_back(view.view);
    const package::TrueCoverage& truth = *figures_.truth;
    const auto patches =
        package::true_patches(truth.samples, truth.area, covered.stored, truth.is_visible);
    coverage.missing = package::missing_surface(patches, poses);
    coverage.map = package::coverage_map(patches);
  }

 private:
  const evaluation::SimulationOptions& options_;
  session::RunOptions run_;
  evaluation::SurveyScene scene_;
  std::stop_token stop_;
  package::CoverageFigures figures_;
};

std::vector<ViewInFlight> planned_views(const flight::PlannedFlight& plan) {
  std::vector<ViewInFlight> views;
  for (const flight::PlannedCapture& capture : plan.captures) {
    if (std::isnan(capture.yaw_deg) || std::isnan(capture.pitch_deg)) continue;
    views.push_back({.view = make_view(capture.position, capture.yaw_deg, capture.pitch_deg),
                     .time = static_cast<double>(views.size())});
  }
  return views;
}

std::vector<ViewInFlight> flown_views(const FlightComparison& comparison) {
  std::vector<ViewInFlight> views;
  const auto add = [&](const flight::TrackState& state) {
    if (std::isnan(state.camera_yaw_deg) || std::isnan(state.camera_pitch_deg)) return;
    views.push_back(
        {.view = make_view(state.position, state.camera_yaw_deg, state.camera_pitch_deg),
         .velocity = flight::compute_velocity(comparison.track.states, state.time),
         .time = state.time});
  };
  for (const flight::CaptureComparison& capture : comparison.route.captures) {
    if (capture.is_made) add(capture.state);
  }
  for (const flight::TrackState& state : comparison.route.other_captures) add(state);
  std::ranges::stable_sort(views, {}, &ViewInFlight::time);
  return views;
}

/// Returns why the coverage cannot be simulated; empty if it can.
std::string find_obstacle(const evaluation::SimulationOptions& options,
                          const FlightComparison& comparison) {
  if (options.scene.model.empty() && !options.scene.is_truth_prior()) {
    return "the mission has no scene; name a mission with --truth";
  }
  if (options.survey.flight.capture.scans_in_flight())
    return "the laser scanner measures in flight";
  if (comparison.has_plan && comparison.plan.captures.empty()) {
    return "the route file commands no capture";
  }
  if (!comparison.has_plan && comparison.route.other_captures.empty()) {
    return comparison.route.num_other_captures == 0
               ? "the log contains no camera event"
               : "the log contains no viewing direction of the camera";
  }
  return "";
}

ComparedCoverage compute_coverage(const CoverageSimulation& simulation,
                                  const FlightComparison& comparison) {
  ComparedCoverage coverage;
  if (comparison.has_plan) {
    coverage.planned = simulation.measure(simulation.simulate(planned_views(comparison.plan)));
  }
  std::vector<ViewInFlight> views = flown_views(comparison);
  const simulation::CoveredAgain covered = simulation.simulate(views);
  coverage.flown = simulation.measure(covered);
  simulation.map_surface(covered, views, coverage);
  if (!comparison.patch) return coverage;
  double time = views.empty() ? 0.0 : views.back().time;
  for (const geometry::View& view : flight::photo_views(comparison.patch->route)) {
    views.push_back({.view = view, .time = time += 1.0});
  }
  coverage.patched = simulation.measure(simulation.simulate(views));
  return coverage;
}

/// Returns the expected reconstruction by the photos of a mission with a photo camera.
ComparedPhotos evaluate_photos(const config::MissionSetup& setup,
                               const FlightComparison& comparison, const std::stop_token& stop) {
  const config::PhotoSetup photo = config::photo_setup(*setup.document);
  const photo::PhotoAirspace airspace(setup, setup.run.threads);
  std::vector<std::vector<geometry::View>> sets(3);
  for (const ViewInFlight& view : planned_views(comparison.plan)) sets[0].push_back(view.view);
  for (const ViewInFlight& view : flown_views(comparison)) sets[1].push_back(view.view);
  sets[2] = sets[1];
  if (comparison.patch) {
    const auto patch = flight::photo_views(comparison.patch->route);
    sets[2].insert(sets[2].end(), patch.begin(), patch.end());
  }
  const std::vector<survey::photo::PhotoFigures> figures =
      survey::photo::evaluate_photos(photo.options, photo::photo_site(setup, airspace),
                                     {setup.run.seed, setup.run.threads, stop}, sets);
  ComparedPhotos photos;
  photos.flown = figures[1];
  if (comparison.has_plan) photos.planned = figures[0];
  if (comparison.patch) photos.patched = figures[2];
  return photos;
}

}  // namespace

std::size_t FlightComparison::num_flown_legs() const {
  return static_cast<std::size_t>(std::ranges::count_if(
      route.legs, [](const flight::LegComparison& leg) { return leg.is_flown; }));
}

std::size_t FlightComparison::num_missed_captures() const {
  return static_cast<std::size_t>(std::ranges::count(is_missed, true));
}

namespace {

/// Computes coverage and the distance from the model in the scene of the mission, or of
/// `request.truth`.
void simulate_coverage(const config::MissionSetup& setup, std::filesystem::path scene_folder,
                       const CompareRequest& request, const std::optional<Vector3d>& pad,
                       FlightComparison& comparison, const std::stop_token& stop) {
  if (setup.document->is_photo()) {
    comparison.photos = evaluate_photos(setup, comparison, stop);
    return;
  }
  // The scene may be that of another mission. Sensor, vehicle and evaluation are those of the plan.
  evaluation::SimulationOptions options = setup.simulation;
  if (request.truth) {
    options.scene = config::read_mission(*request.truth).scene();
    scene_folder = request.truth->parent_path();
  }
  comparison.no_coverage = find_obstacle(options, comparison);
  const bool has_scene = !options.scene.model.empty() || options.scene.is_truth_prior();
  if (!has_scene || (comparison.has_plan && !comparison.no_coverage.empty())) return;
  const CoverageSimulation simulation(options, setup.run, scene_folder, stop);
  if (!comparison.has_plan) {
    const geometry::MeshDistance model(simulation.scene().model(), setup.run.threads);
    comparison.model_distance = measure_track(
        pad, setup.flight().climb(),
        [&](const Vector3d& position) { return model.distance(position); }, comparison);
  }
  if (comparison.no_coverage.empty()) {
    comparison.coverage = compute_coverage(simulation, comparison);
  }
}

/// Returns the corners of the mission's target or unknown box, and its take-off point.
std::vector<Vector3d> mission_positions(const config::MissionSetup& setup) {
  std::vector<Vector3d> positions{setup.flight().takeoff.value_or(Vector3d::Zero())};
  const Eigen::AlignedBox3d box = setup.simulation.scene_box();
  if (!box.isEmpty()) positions.push_back(box.center());
  return positions;
}

FlightComparison compare_without_plan(const CompareRequest& request,
                                      const std::function<void(const std::string&)>& report,
                                      const std::stop_token& stop) {
  report("reading " + request.folder.string());
  const config::MissionSetup setup = config::read_mission(request.folder, request.overrides);
  const std::optional<Vector3d>& pad = setup.flight().takeoff;
  FlightComparison comparison;
  comparison.name = setup.name;
  comparison.has_plan = false;
  comparison.mission = setup;
  comparison.pad = pad;
  comparison.clearance = setup.flight().clearance;
  report("reading " + request.logs.front().string());
  comparison.track =
      read_track(request, setup.flight(), pad.value_or(Vector3d::Zero()), mission_positions(setup));
  comparison.route = flight::measure_flight(comparison.track);
  if (request.cloud) {
    measure_cloud(*request.cloud, pad, setup.flight().climb(), comparison);
  }
  report(setup.name + ": computing coverage");
  simulate_coverage(setup, request.folder.parent_path(), request, pad, comparison, stop);
  return comparison;
}

}  // namespace

FlightComparison compare_flight(const CompareRequest& request, geometry::OutputFolder& folder,
                                const std::function<void(const std::string&)>& report,
                                const std::stop_token& stop) {
  if (std::filesystem::is_regular_file(request.folder)) {
    return compare_without_plan(request, report, stop);
  }
  report("reading " + request.folder.string());
  if (package::read_inspection_summary(request.folder, {})) {
    throw Error(ErrorKind::bad_usage,
                request.folder.string() +
                    " is a continuous inspection flight without captures; evaluate its flown "
                    "trajectory with benchmark MISSION --also MISSION=FILE");
  }
  const config::MissionSetup setup =
      package::read_package_summary(request.folder, request.overrides).mission;
  const package::PackagedSurvey survey = package::read_package(request.folder, request.overrides);
  FlightComparison comparison;
  comparison.name = survey.name;
  comparison.mission = setup;
  comparison.clearance = survey.flight.clearance;
  const auto routes =
      request.routes.empty() ? find_routes(request.folder, survey.flight) : request.routes;
  const OwnFlight own = find_own_flight(routes, survey);
  comparison.pad = own.pad;
  for (const std::filesystem::path& file : routes) {
    comparison.files.push_back(file.filename().string());
    append_flight(comparison.plan, read_route(file, own));
  }
  report("reading " + request.logs.front().string());
  std::vector<Vector3d> positions{own.pad};
  for (const flight::PlannedLeg& leg : comparison.plan.legs) {
    positions.insert(positions.end(), leg.points.begin(), leg.points.end());
  }
  comparison.track = read_track(request, own.options, own.pad, positions);
  report(survey.name + ": comparing");
  comparison.route = flight::compare_route(comparison.plan, comparison.track, request.comparison);
  find_missed(survey, comparison);
  const std::filesystem::path cloud = request.cloud.value_or(request.folder / cloud_name);
  if (request.cloud || std::filesystem::exists(cloud)) {
    measure_cloud(cloud, own.pad, own.options.climb(), comparison);
  }
  if (!comparison.missed_views.empty()) {
    report(survey.name + ": planning the patch mission");
    comparison.patch = plan_patch(survey, own, comparison.missed_views, folder, stop);
  }
  report(survey.name + ": computing coverage");
  simulate_coverage(setup, {}, request, own.pad, comparison, stop);
  return comparison;
}

}  // namespace skycap::missions::comparison
