#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "flight/export/export.h"
#include "flight/interpreter/interpret.h"
#include "flight/space/place_text.h"
#include "geometry/error.h"
#include "geometry/surfaces/mesh.h"
#include "missions/cli/verbs.h"
#include "missions/config/fleet.h"
#include "missions/config/mission_flight.h"
#include "missions/config/mission_priors.h"
#include "missions/config/pad_grounds.h"
#include "missions/config/planner_titles.h"
#include "missions/config/resolved_mission.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/fleet/timetable_proof.h"
#include "missions/package/fleet_mission.h"
#include "missions/package/package.h"
#include "missions/package/verification/check_returns.h"
#include "missions/package/verification/true_space.h"
#include "missions/simulation/expectation.h"
#include "missions/simulation/feasibility.h"
#include "missions/site_data/prior_text.h"
#include "missions/support/number_text.h"

namespace skycap::missions::cli {
namespace {

/// What the mission says of a file; the pad and the views are those of the package it lies in.
flight::FlightFacts facts_of(const config::Mission& mission, const std::filesystem::path& route) {
  flight::FlightFacts facts = config::flight_facts(mission);
  const std::filesystem::path folder = route.parent_path();
  if (!std::filesystem::exists(folder / package::summary_name)) return facts;
  package::PackageSummary summary = package::read_package_summary(folder, {});
  facts.views = summary.stations();
  if (!facts.is_pad_known && summary.pad) {
    facts.pad = *summary.pad;
    facts.is_pad_known = true;
  }
  return facts;
}

/// The corners of all that is flown beside the pad.
std::vector<Eigen::Vector3d> places_of(const flight::FlownRoute& route) {
  std::vector<Eigen::Vector3d> places;
  for (const flight::FlownPiece& piece : route.pieces) {
    if (piece.is_over_pad) continue;
    if (places.empty()) places.push_back(piece.start.to);
    places.push_back(piece.to);
  }
  return places;
}

/// Errors of the mission's model name the mission, too.
geometry::Mesh model_of(const config::Mission& mission, const std::filesystem::path& file) {
  try {
    return evaluation::placed_model(mission, file.parent_path());
  } catch (const Error& error) {
    throw Error(error.kind(), file.string() + ": " + error.what());
  }
}

/// Says what of the ground that the file takes off from and lands on is unfit; whether none is.
bool check_pads(const std::string& file, const config::Mission& mission,
                const geometry::Mesh& model, const Eigen::Vector3d& pad, const Console& console) {
  if (!mission.flight.is_flown()) return true;
  bool are_fit = true;
  for (const flight::PadGround& ground : package::true_grounds(mission, model, pad)) {
    const std::string why = why_unfit(ground, config::ground_limits_of(mission));
    if (why.empty()) continue;
    are_fit = false;
    console.out << file << ": not safe, the place to land at " << flight::place_text(ground.place)
                << " " << why << "\n";
  }
  return are_fit;
}

/// Proves from a fleet's timetable and the files that it names that its vehicles keep apart.
int check_timetable(const CheckOptions& options, const config::Mission& mission,
                    const Console& console) {
  if (!config::is_fleet(mission)) {
    throw Error(ErrorKind::bad_usage, "a timetable is for several vehicles; give flight.vehicles");
  }
  const std::string file = options.route->string();
  const flight::SeparationRule rule = config::separation_of(mission);
  const package::TimetableProof proof =
      package::prove_timetable(*options.route, mission, package::reported_distance);
  for (const std::string& problem : proof.problems) console.out << file << ": " << problem << "\n";
  console.out << file << ": "
              << fmt::format(
                     "{}, {} sorties of {} vehicles in {:.0f} s, apart by {:.2f} m at all times, "
                     "each up to {} s early or late; {} m is asked for\n",
                     proof.problems.empty() ? "fine" : "not safe", proof.sorties,
                     mission.flight.fleet.vehicles.size(), proof.makespan, proof.distance,
                     support::short_text(rule.tolerance), support::short_text(rule.distance))
              << std::flush;
  return proof.problems.empty() ? 0 : 1;
}

/// Proves what a route file's vehicle flies against the mission's scene as it truly is.
int check_route_file(const CheckOptions& options, const config::Mission& given,
                     const geometry::Mesh& model, const Console& console) {
  const std::string file = options.route->string();
  const config::Mission mission = package::mission_of_file(*options.route, given);
  const flight::FlightFacts facts = facts_of(mission, *options.route);
  const flight::FlownRoute route = flight::interpret_file(*options.route, facts);
  const package::TrueSpace space = package::true_space(mission, model, facts.pad.z());

  ProgressLine progress(console, false);
  progress.show(file + ": proving " + std::to_string(route.pieces.size()) + " legs");
  const double asked_for = mission.flight.clearance;
  const flight::FlownProof proof = prove(route, space.everywhere, space.over_pad,
                                         std::max(0.0, asked_for - flight::rounding_bound),
                                         asked_for + flight::reported_surplus);
  progress.clear();
  for (const flight::Problems& problems : {route.problems, proof.problems}) {
    for (const std::string& problem : problems) console.out << file << ": " << problem << "\n";
  }
  const bool is_fine = route.problems.empty() && proof.problems.empty();
  console.out << file << ": " << (is_fine ? "fine" : "not safe") << ", " << proof.problems.size()
              << " of " << route.pieces.size() << " legs come nearer than "
              << support::short_text(asked_for) << " m, the nearest "
              << support::short_text(proof.clearance) << " m; "
              << support::short_text(flight::length(route)) << " m long";
  if (!route.problems.empty()) console.out << "; " << route.problems.size() << " other problems";
  if (facts.views.empty() && !route.stops.empty()) {
    console.out << "; where its photographs look is not checked: it is not in its package";
  }
  console.out << "\n";
  const package::ReturnCheck returns = package::check_returns(
      *options.route, options.return_height, mission, space.everywhere, places_of(route));
  console.out << file << ": " << returns.text << "\n";
  Eigen::Vector3d pad = facts.pad;
  if (!facts.is_pad_known && !route.pieces.empty()) {
    pad.head<2>() = route.pieces.front().start.to.head<2>();
  }
  const bool are_pads_fit = check_pads(file, mission, model, pad, console);
  console.out << std::flush;
  return is_fine && returns.is_safe && are_pads_fit ? 0 : 1;
}

std::string scene_text(const config::Mission& mission, const evaluation::SurveyScene& scene) {
  const survey::see::SeeConfig& see = mission.planner.see;
  const Eigen::Vector3d size = geometry::bounding_box(scene.model()).sizes();
  return fmt::format(
      "  scene     {} triangles, {:.4g} x {:.4g} x {:.4g} m, {:.4g} m^2\n"
      "  planner   {}, view distance d {:.4g} m, spacing epsilon {:.4g} m, core threshold k {}\n",
      scene.model().triangles.size(), size.x(), size.y(), size.z(),
      geometry::surface_area(scene.model()), config::title_of(mission.planner.name).word,
      scene.view_distance(), see.effective_spacing(), see.effective_core_threshold());
}

/// An estimate: two digits, and zeros after them.
std::string rough_text(double number) {
  if (!(number > 0.0)) return "0";
  const double unit = std::pow(10.0, std::floor(std::log10(number)) - 1.0);
  return support::short_text(unit * std::round(number / unit));
}

/// "12 to 20", or one number where they are the same.
std::string range_text(double least, double most) {
  const std::string low = rough_text(least), high = rough_text(most);
  return low == high ? low : low + " to " + high;
}

std::string expectation_text(const simulation::Expectation& expected) {
  const std::string views =
      expected.least_views == expected.most_views
          ? std::to_string(expected.most_views)
          : fmt::format("{} to {}", expected.least_views, expected.most_views);
  return fmt::format(
      "  expected  {} views ({} for one who knows the scene), {} minutes of flight, {} MB\n"
      "  time      {} s on this machine, as the first view took\n",
      views, expected.known_views, range_text(expected.least_minutes, expected.most_minutes),
      rough_text(1e-6 * expected.memory), range_text(expected.least_time, expected.most_time));
}

/// Says whether a survey of the mission can work, and what it will take.
int check_survey(const CheckOptions& options, const config::Mission& mission,
                 ProgressLine& progress, const Console& console) {
  const std::string file = options.mission.string();
  try {
    const evaluation::SurveyScene scene(mission, options.mission.parent_path());
    const simulation::Feasibility found = simulation::feasibility(mission, scene, mission.threads);
    std::string text = file + (found.problems.empty() ? ": fine\n" : ": cannot work\n") +
                       scene_text(mission, scene) + site_data::text_of(config::priors_of(mission));
    for (const std::string& problem : found.problems) text += "  problem   " + problem + "\n";
    for (const std::string& warning : found.warnings) text += "  warning   " + warning + "\n";
    if (found.problems.empty()) {
      progress.show(mission.name + ": looking for views");
      text += expectation_text(simulation::expectation(mission, scene, mission.threads));
    }
    progress.clear();
    console.out << text << std::flush;
    return found.problems.empty() ? 0 : 1;
  } catch (const Error& error) {
    // What goes wrong with the model follows from the mission; say which.
    throw Error(error.kind(), file + ": " + error.what());
  }
}

}  // namespace

int check(const CheckOptions& options, const Console& console) {
  const config::Mission mission = read_shown(config::read_mission, options, console);
  if (options.route && options.route->filename() == package::timetable_name) {
    return check_timetable(options, mission, console);
  }
  ProgressLine progress(console, false);
  progress.show(mission.name + ": making the scene ready");
  if (!options.route) return check_survey(options, mission, progress, console);
  const geometry::Mesh model = model_of(mission, options.mission);
  progress.clear();
  return check_route_file(options, mission, model, console);
}

}  // namespace skycap::missions::cli
