#include "flight/fly_test/fly_test.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "flight/export/export.h"
#include "flight/interpreter/interpret.h"
#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/cli/fly_test_report.h"
#include "missions/cli/verbs.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/fleet/timetable_proof.h"
#include "missions/package/fleet_mission.h"
#include "missions/package/package.h"
#include "missions/package/verification/stated_return.h"
#include "missions/package/verification/true_space.h"
#include "missions/support/json_text.h"

namespace skycap::missions::cli {
namespace {

using flight::Dialect;

/// Distances are evaluated up to this value above the clearance [m].
constexpr double surplus_of_interest = 5.0;

std::string name_of(Dialect dialect) {
  if (dialect == Dialect::dji) return "DJI";
  return dialect == Dialect::px4 ? "PX4" : "ArduPilot";
}

/// Returns the route files for autopilots, ordered by name.
std::vector<std::filesystem::path> flown_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    for (const auto format :
         {flight::Format::plan, flight::Format::waypoints, flight::Format::kmz}) {
      if (package::is_flight_file(name, format)) files.push_back(entry.path());
    }
  }
  std::ranges::sort(files);
  if (!files.empty()) return files;
  throw Error(ErrorKind::bad_file,
              folder.string() +
                  " contains no autopilot mission; plan it with flight.vehicle and a georeference");
}

/// Package to be tested, with its free space and the spaces that flights are evaluated against.
class TestedPackage {
 public:
  TestedPackage(const FlyTestVerbOptions& options, package::PackagedSurvey survey)
      : survey_(std::move(survey)),
        rules_(survey_.flight.rules()),
        space_({&survey_.measured, &rules_}),
        pad_space_(without_ground(survey_.flight.rules())) {
    if (!options.truth) return;
    const config::MissionSetup truth = config::read_mission(*options.truth);
    truth_ = package::true_space(
        survey_.flight, evaluation::placed_model(truth.scene(), options.truth->parent_path()),
        survey_.pad.z());
  }

  const std::string& name() const { return survey_.name; }
  const flight::FlightOptions& flight() const { return survey_.flight; }
  const session::RunOptions& run() const { return survey_.run; }
  const Eigen::Vector3d& pad() const { return survey_.pad; }

  flight::FlownMission read(const std::filesystem::path& file, Dialect dialect,
                            const std::optional<double>& return_height) const {
    const flight::FlightOptions own = package::flight_of_file(file, flight());
    const Eigen::Vector3d pad = pad_of(own);
    const flight::Vehicle vehicle = own.flown_by(own.flown(), dialect);
    flight::FlightFacts facts = own.facts();
    facts.pad = pad;
    facts.is_pad_known = true;
    facts.views = survey_.views;
    facts.vehicle = vehicle;
    const flight::FlownRoute route = flight::interpret_file(file, facts);
    if (!route.problems.empty()) {
      throw Error(ErrorKind::bad_file,
                  file.string() + " cannot be flown: " + route.problems.front());
    }
    const flight::Motion motion(vehicle, own.route(pad).conditions);
    return {script_of(route, motion), motion, law_of(file, dialect, pad, return_height)};
  }

  /// Returns the clearance criteria. Legs are verified with the full clearance; flown paths may
  /// deviate by the errors included in it.
  std::vector<flight::Judge> judges(double position_error) const {
    const double certified = flight::return_clearance(flight().clearance) - flight::rounding_bound;
    const double strayed = certified - flight().tracking_error - position_error;
    std::vector<flight::Judge> judges{
        {"unknown or occupied space", space_, pad_space_, strayed, certified}};
    if (truth_) {
      judges.push_back({"the scene (ground truth)", truth_->everywhere, truth_->over_pad,
                        strayed - flight().map_error, certified - flight().map_error});
    }
    return judges;
  }

 private:
  /// Returns the pad of a fleet vehicle, or the package's pad.
  Eigen::Vector3d pad_of(const flight::FlightOptions& own) const {
    return flight().is_fleet() ? own.takeoff.value_or(pad()) : pad();
  }

  std::optional<flight::ReturnLaw> law_of(const std::filesystem::path& file, Dialect dialect,
                                          const Eigen::Vector3d& pad,
                                          const std::optional<double>& return_height) const {
    const auto stated = package::stated_height(file, return_height, dialect);
    if (!stated) return std::nullopt;
    if (!stated->problems.empty()) {
      throw Error(ErrorKind::bad_file, stated->by + ": " + stated->problems.front());
    }
    flight::ReturnLaw law{.dialects = {dialect},
                          .level = pad.z() + stated->height,
                          .landings = {pad},
                          .landing_climb = flight().climb()};
    const std::vector<Eigen::Vector3d>& rally = flight().rally;
    if (dialect != Dialect::dji)
      law.landings.insert(law.landings.end(), rally.begin(), rally.end());
    return law;
  }

  package::PackagedSurvey survey_;
  flight::KnownSpace rules_;
  flight::JointSpace space_;
  flight::KnownSpace pad_space_;
  std::optional<package::TrueSpace> truth_;
};

/// Returns the obstacle nearest to any flight, for each judge.
std::vector<std::string> nearest_obstacles(const TestedFile& file) {
  std::vector<std::string> names;
  for (std::size_t j = 0; j < file.judges.size(); ++j) {
    flight::Closest nearest{1e9};
    for (const flight::TestFlight& flight : file.test.flights) {
      const flight::Closest& closest = flight.flown.nearest[j].closest;
      if (closest.distance < nearest.distance) nearest = closest;
    }
    std::string name = file.judges[j].space.name(nearest);
    names.push_back(name.empty() ? file.judges[j].pad_space.name(nearest) : name);
  }
  return names;
}

double battery_of(const flight::Motion& motion) {
  return motion.usable_energy() * (1.0 + motion.vehicle().energy_error) /
         (1.0 - motion.conditions().reserve);
}

TestedFile test_file(const FlyTestVerbOptions& options, const TestedPackage& package,
                     const std::filesystem::path& file, const Console& console) {
  const std::string name = file.filename().string();
  const flight::FlightOptions& flown = package.flight();
  const Dialect dialect = *package::dialect_of(file, package::flight_of_file(file, flown).flown());
  const flight::FlownMission mission = package.read(file, dialect, options.return_height);
  flight::FlyTestOptions test;
  test.flights = options.flights;
  test.returns = options.returns;
  test.wind_speed = options.wind_speed.value_or(std::max(flown.wind_speed, test.wind_speed));
  test.position_error = options.position_error.value_or(flown.position_error);
  test.up_to = flown.clearance + surplus_of_interest;
  test.seed = package.run().seed;
  test.threads = package.run().threads;
  test.stop = console.stop;
  ProgressLine progress(console, options.is_quiet);
  test.report = [&](std::size_t count) {
    progress.show(fmt::format("{}: flight {} of {}", name, count, options.flights));
  };
  const std::vector<flight::Judge> judges = package.judges(flown.position_error);
  TestedFile tested{
      name, name_of(dialect), judges, fly_test(mission, judges, test), battery_of(mission.motion),
      {}};
  tested.obstacles = nearest_obstacles(tested);
  return tested;
}

/// Tests the joint flight of a fleet. Returns nullopt if the package has no fleet.
std::optional<flight::FleetFlightTest> test_fleet(const FlyTestVerbOptions& options,
                                                  const TestedPackage& package,
                                                  const Console& console) {
  const flight::FlightOptions& flown = package.flight();
  const std::filesystem::path table = options.package / package::timetable_name;
  if (!flown.is_fleet() || !std::filesystem::exists(table)) return std::nullopt;
  flight::FlyTestOptions test;
  test.flights = options.flights;
  test.wind_speed = options.wind_speed.value_or(std::max(flown.wind_speed, test.wind_speed));
  test.position_error = options.position_error.value_or(flown.position_error);
  test.up_to = package::reported_distance;
  test.seed = package.run().seed;
  test.threads = package.run().threads;
  test.stop = console.stop;
  const double strays = 2.0 * (flown.position_error + flown.tracking_error);
  return fly_fleet(package::fleet_flights(table, flown), flown.fleet.rule(), strays, test);
}

/// Commits the results. Incomplete results do not overwrite complete ones.
void commit(geometry::OutputFolder& folder, bool is_complete) {
  if (!is_complete && package::is_complete_result(folder.path() / package::fly_test_name)) {
    folder.move_to("interrupted");
  }
  folder.commit();
}

}  // namespace

int fly_test(const FlyTestVerbOptions& options, const Console& console) {
  const TestedPackage package(options, package::read_package(options.package, options.overrides));
  const std::vector<std::filesystem::path> files = flown_files(options.package);
  geometry::OutputFolder folder(options.out.value_or(options.package));
  const HoldsResults results(console);
  nlohmann::ordered_json json{{"mission", package.name()},
                              {"seed", package.run().seed},
                              {"complete", true},
                              {"files", nlohmann::ordered_json::array()}};
  std::size_t failed = 0;
  for (const std::filesystem::path& file : files) {
    const TestedFile tested = test_file(options, package, file, console);
    failed += failures(tested);
    json["files"].push_back(json_of(tested));
    if (!options.is_quiet) console.out << text_of(tested) << std::flush;
    if (console.stop.stop_requested()) break;
  }
  if (const auto test = test_fleet(options, package, console)) {
    failed += test->nearer;
    json["fleet"] = json_of(*test);
    if (!options.is_quiet) console.out << text_of(*test) << std::flush;
  }
  const bool is_complete = !console.stop.stop_requested();
  json["complete"] = is_complete;
  folder.write(package::fly_test_name, support::json_text(json));
  commit(folder, is_complete);
  if (!options.is_quiet) {
    console.out << (is_complete ? "" : "interrupted\n") << "  results   "
                << (folder.path() / package::fly_test_name).string() << "\n"
                << std::flush;
  }
  return is_complete && failed == 0 ? 0 : 1;
}

}  // namespace skycap::missions::cli
