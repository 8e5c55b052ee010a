#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "flight/clearance/position_text.h"
#include "flight/export/export.h"
#include "flight/interpreter/interpret.h"
#include "geometry/error.h"
#include "geometry/surfaces/mesh.h"
#include "missions/cli/check_live.h"
#include "missions/cli/commands.h"
#include "missions/config/inspection_rules.h"
#include "missions/config/mission_document.h"
#include "missions/config/photo_rules.h"
#include "missions/config/resolve.h"
#include "missions/config/setup_text.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/inspection/inspection_site.h"
#include "missions/package/fleet/timetable_verification.h"
#include "missions/package/fleet_mission.h"
#include "missions/package/inspection_summary.h"
#include "missions/package/package.h"
#include "missions/package/settings.h"
#include "missions/package/verification/check_returns.h"
#include "missions/package/verification/true_space.h"
#include "missions/simulation/expectation.h"
#include "missions/simulation/feasibility.h"
#include "missions/site_data/prior_text.h"
#include "missions/site_data/site_priors.h"
#include "missions/support/number_text.h"
#include "survey/planners/planner_names.h"
#include "survey/see/see_config.h"

namespace skycap::missions::cli {
namespace {

/// Returns the facts for checking a file. The pad and the views are taken from its package.
flight::FlightFacts make_flight_facts(const flight::FlightOptions& flight,
                                      const std::filesystem::path& route) {
  flight::FlightFacts facts = flight.facts();
  const std::filesystem::path folder = route.parent_path();
  if (!std::filesystem::exists(folder / package::summary_name)) return facts;
  if (const auto inspection = package::read_inspection_summary(folder, {})) {
    if (facts.is_pad_known || !inspection->pad) return facts;
    facts.pad = *inspection->pad;
    facts.is_pad_known = true;
    return facts;
  }
  package::PackageSummary summary = package::read_package_summary(folder, {});
  facts.views = summary.capture_points();
  if (!facts.is_pad_known && summary.pad) {
    facts.pad = *summary.pad;
    facts.is_pad_known = true;
  }
  return facts;
}

/// Returns the corners of all pieces that are not flown over the pad.
std::vector<Eigen::Vector3d> read_positions(const flight::InterpretedRoute& route) {
  std::vector<Eigen::Vector3d> positions;
  for (const flight::InterpretedSegment& segment : route.segments) {
    if (segment.is_over_pad) continue;
    if (positions.empty()) positions.push_back(segment.start.to);
    positions.push_back(segment.to);
  }
  return positions;
}

/// Loads the mission's model. Errors are prefixed with the mission file.
geometry::Mesh load_scene_model(const scene::SceneOptions& scene,
                                const std::filesystem::path& file) {
  try {
    return evaluation::placed_model(scene, file.parent_path());
  } catch (const Error& error) {
    throw Error(error.kind(), file.string() + ": " + error.what());
  }
}

/// Prints unsuitable ground at the take-off and landing points. Returns whether all are suitable.
bool check_pads(const std::string& file, const flight::FlightOptions& flight,
                const geometry::Mesh& model, const Eigen::Vector3d& pad, const Console& console) {
  if (!flight.has_vehicle()) return true;
  bool are_fit = true;
  for (const flight::LandingSurface& ground : package::true_landing_surfaces(flight, model, pad)) {
    const std::string reason = unfit_reason(ground, flight.ground_limits());
    if (reason.empty()) continue;
    are_fit = false;
    console.out << file << ": not verified: the landing point at "
                << flight::position_text(ground.position) << " " << reason << "\n";
  }
  return are_fit;
}

/// Verifies the separation of a fleet's vehicles from its timetable and the route files named
/// there.
int check_timetable(const CheckOptions& options, const flight::FlightOptions& flight,
                    const Console& console) {
  if (!flight.is_fleet()) {
    throw Error(ErrorKind::bad_usage, "a timetable requires flight.vehicles");
  }
  const std::string file = options.route->string();
  const flight::SeparationRule rule = flight.fleet.rule();
  const package::TimetableVerification verification =
      package::verify_timetable(*options.route, flight, package::reported_distance);
  for (const std::string& problem : verification.problems)
    console.out << file << ": " << problem << "\n";
  console.out << file << ": "
              << fmt::format(
                     "{}, {} sorties of {} vehicles in {:.0f} s, minimum separation {:.2f} m with "
                     "each vehicle up to {} s early or late, required {} m\n",
                     verification.problems.empty() ? "verified" : "not verified",
                     verification.sorties, flight.fleet.vehicles.size(), verification.makespan,
                     verification.distance, support::short_text(rule.tolerance),
                     support::short_text(rule.distance))
              << std::flush;
  return verification.problems.empty() ? 0 : 1;
}

/// Verifies the flight of a route file against the mission's ground-truth scene.
int check_route_file(const CheckOptions& options, const flight::FlightOptions& given,
                     const geometry::Mesh& model, const Console& console) {
  const std::string file = options.route->string();
  const flight::FlightOptions flight = package::find_file_flight(*options.route, given);
  const flight::FlightFacts facts = make_flight_facts(flight, *options.route);
  const flight::InterpretedRoute route = flight::interpret_file(*options.route, facts);
  const package::TrueSpace space = package::true_space(flight, model, facts.pad.z());

  ProgressLine progress(console, false);
  progress.show(file + ": verifying " + std::to_string(route.segments.size()) + " legs");
  const double asked_for = flight.clearance;
  const flight::RouteVerification verification = verify(
      route, space.everywhere, space.over_pad, std::max(0.0, asked_for - flight::rounding_bound),
      asked_for + flight::reported_surplus);
  progress.clear();
  for (const flight::Problems& problems : {route.problems, verification.problems}) {
    for (const std::string& problem : problems) console.out << file << ": " << problem << "\n";
  }
  const bool is_fine = route.problems.empty() && verification.problems.empty();
  console.out << file << ": " << (is_fine ? "verified" : "not verified") << ", "
              << verification.problems.size() << " of " << route.segments.size()
              << " legs violate the clearance of " << support::short_text(asked_for)
              << " m, minimum " << support::short_text(verification.clearance) << " m; "
              << support::short_text(flight::length(route)) << " m long";
  if (!route.problems.empty()) console.out << "; " << route.problems.size() << " other problems";
  if (facts.views.empty() && !route.stops.empty()) {
    console.out << "; photo directions not checked, because the file is outside its package";
  }
  console.out << "\n";
  const package::ReturnCheck returns = package::check_returns(
      *options.route, options.return_height, flight, space.everywhere, read_positions(route));
  console.out << file << ": " << returns.text << "\n";
  Eigen::Vector3d pad = facts.pad;
  if (!facts.is_pad_known && !route.segments.empty()) {
    pad.head<2>() = route.segments.front().start.to.head<2>();
  }
  const bool are_pads_fit = check_pads(file, flight, model, pad, console);
  console.out << std::flush;
  return is_fine && returns.is_safe && are_pads_fit ? 0 : 1;
}

/// Returns k from the values of all keys, also for planners that do not use it.
int core_threshold(const nlohmann::ordered_json& keys) {
  survey::see::SeeConfig see{.density = keys.at("planner.density"),
                             .resolution_radius = keys.at("planner.resolution_radius")};
  const auto given = keys.find("planner.core_threshold");
  if (given != keys.end()) see.core_threshold = *given;
  return see.effective_core_threshold();
}

std::string scene_text(const survey::PlannerOptions& planner, int core_threshold,
                       const evaluation::SurveyScene& scene) {
  const Eigen::Vector3d size = geometry::bounding_box(scene.model()).sizes();
  return fmt::format(
      "  scene     {} triangles, {:.4g} x {:.4g} x {:.4g} m, {:.4g} m^2\n"
      "  planner   {}, view distance d {:.4g} m, spacing epsilon {:.4g} m, core threshold k {}\n",
      scene.model().triangles.size(), size.x(), size.y(), size.z(),
      geometry::surface_area(scene.model()), survey::find_title(planner.name).word,
      scene.view_distance(), planner.spacing, core_threshold);
}

/// Formats an estimate with two significant digits.
std::string rough_text(double number) {
  if (!(number > 0.0)) return "0";
  const double unit = std::pow(10.0, std::floor(std::log10(number)) - 1.0);
  return support::short_text(unit * std::round(number / unit));
}

/// Returns "12 to 20", or one number if both are equal.
std::string range_text(double min, double max) {
  const std::string low = rough_text(min), high = rough_text(max);
  return low == high ? low : low + " to " + high;
}

std::string expectation_text(const simulation::Expectation& expected) {
  const std::string views = expected.min_views == expected.max_views
                                ? std::to_string(expected.max_views)
                                : fmt::format("{} to {}", expected.min_views, expected.max_views);
  return fmt::format(
      "  expected  {} views (oracle: {}), {} minutes of flight, {} MB\n  time      {} s for skycap "
      "plan on this machine, estimated from the first views\n",
      views, expected.known_views, range_text(expected.min_minutes, expected.max_minutes),
      rough_text(1e-6 * expected.memory), range_text(expected.min_time, expected.max_time));
}

/// Prints whether a survey of the mission is possible, and its estimated effort.
/// `begun` is the start of the command.
int check_survey(const CheckOptions& options, const config::MissionSetup& setup,
                 std::chrono::steady_clock::time_point begun, ProgressLine& progress,
                 const Console& console) {
  const std::string file = options.mission.string();
  try {
    const evaluation::SurveyScene scene(setup.simulation, options.mission.parent_path(),
                                        setup.run.threads);
    const simulation::Feasibility found =
        simulation::feasibility(setup.simulation, scene, setup.run);
    std::string text =
        file + (found.problems.empty() ? ": no problems found\n" : ": cannot be surveyed\n");
    text +=
        scene_text(setup.survey().planner, core_threshold(package::settings_json(setup)), scene);
    if (setup.scene().priors) text += site_data::format_priors(*setup.scene().priors);
    for (const std::string& problem : found.problems) text += "  problem   " + problem + "\n";
    if (found.problems.empty()) {
      progress.show(setup.name + ": searching for views");
      // plan begins with the same steps as check, and reads the same files.
      const double loading =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
      simulation::Expectation expected =
          simulation::expectation(setup.simulation, scene, setup.run);
      expected.min_time += loading;
      expected.max_time += loading;
      text += expectation_text(expected);
    }
    for (const std::string& warning : found.warnings) text += "  Warning: " + warning + "\n";
    const std::string range = range_warning(setup, scene.view_distance());
    if (!range.empty()) text += "  Warning: " + range + "\n";
    progress.clear();
    console.out << text << std::flush;
    return found.problems.empty() ? 0 : 1;
  } catch (const Error& error) {
    // Errors of the model are reported with the mission file.
    throw Error(error.kind(), file + ": " + error.what());
  }
}

/// Says what photos of a mission are planned for; skycap plan does the rest in seconds.
int check_photos(const CheckOptions& options, const config::MissionSetup& setup,
                 const Console& console) {
  const config::PhotoSetup photo = config::photo_setup(*setup.document);
  console.out << fmt::format(
                     "{}: no problems found\n  photos    {}, GSD {:.4g} mm at {:.4g} m, {} stereo "
                     "partners\n",
                     options.mission.string(), photo.options.camera.name, 1e3 * photo.options.gsd,
                     setup.survey().planner.view_distance, photo.options.rule.min_partners)
              << site_data::format_priors(*setup.scene().priors) << std::flush;
  return 0;
}

/// Prints what an inspection is planned for, after reading the structure.
int check_inspection(const CheckOptions& options, const config::MissionSetup& setup,
                     const Console& console) {
  if (options.route) {
    throw Error(ErrorKind::bad_usage,
                "--route conflicts with inspection.range; use skycap evaluate --flight " +
                    options.route->string() + " --model " + options.mission.string());
  }
  const survey::inspection::InspectionOptions inspection =
      config::inspection_options(*setup.document);
  inspection.validate();
  const inspection::InspectionSpace space(setup);
  console.out << fmt::format(
                     "{}: no problems found\n  inspection {} points, views from at most {:.4g} m, "
                     "clearance {:.4g} m, {:.4g} m/s\n",
                     options.mission.string(), space.site().points.size(), inspection.camera.range,
                     inspection.clearance, inspection.limits.speed)
              << std::flush;
  return 0;
}

}  // namespace

int check(const CheckOptions& options, const Console& console) {
  if (options.prints_setup) {  // also for missions without a scene
    console.out << config::setup_text(read_shown(config::read_live_mission, options, console));
    return 0;
  }
  const auto begun = std::chrono::steady_clock::now();
  const config::MissionSetup setup = read_shown(config::read_live_mission, options, console);
  if (setup.document->is_inspection()) return check_inspection(options, setup, console);
  if (setup.document->is_photo()) {
    if (!options.route) return check_photos(options, setup, console);
    const geometry::Mesh targets =
        site_data::make_surfaces(*setup.scene().priors, site_data::Role::target);
    return check_route_file(options, setup.flight(), targets, console);
  }
  if (setup.is_live()) {
    if (options.route) {
      throw Error(ErrorKind::bad_usage, options.mission.string() +
                                            ": --route requires a mission with a scene, against "
                                            "which the route is verified");
    }
    return check_live(options.mission.string(), setup, console);
  }
  if (options.route && options.route->filename() == package::timetable_name) {
    return check_timetable(options, setup.flight(), console);
  }
  ProgressLine progress(console, false);
  progress.show(setup.name + ": loading scene");
  if (!options.route) return check_survey(options, setup, begun, progress, console);
  const geometry::Mesh model = load_scene_model(setup.scene(), options.mission);
  progress.clear();
  return check_route_file(options, setup.flight(), model, console);
}

}  // namespace skycap::missions::cli
