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
#include "missions/config/fleet.h"
#include "missions/config/mission_flight.h"
#include "missions/config/resolved_mission.h"
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

/// Flights are looked at up to this much farther than the clearance [m].
constexpr double surplus_of_interest = 5.0;

std::string name_of(Dialect dialect) {
  if (dialect == Dialect::dji) return "DJI";
  return dialect == Dialect::px4 ? "PX4" : "ArduPilot";
}

/// The route files that autopilots fly, by name.
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
  throw Error(ErrorKind::bad_file, folder.string() +
                                       " holds no mission that an autopilot flies; give the "
                                       "mission a vehicle and a place and plan it again");
}

/// What the package knows to be free, and what its flights are judged against.
class TestedPackage {
 public:
  TestedPackage(const FlyTestVerbOptions& options, package::PackagedSurvey survey)
      : survey_(std::move(survey)),
        rules_(config::flight_rules(survey_.mission)),
        space_({&survey_.measured, &rules_}),
        pad_space_(without_ground(config::flight_rules(survey_.mission))) {
    if (!options.truth) return;
    const config::Mission mission = config::read_mission(*options.truth);
    truth_ = package::true_space(survey_.mission,
                                 evaluation::placed_model(mission, options.truth->parent_path()),
                                 survey_.pad.z());
  }

  const config::Mission& mission() const { return survey_.mission; }
  const Eigen::Vector3d& pad() const { return survey_.pad; }

  flight::FlownMission read(const std::filesystem::path& file, Dialect dialect,
                            const std::optional<double>& return_height) const {
    const config::Mission own = package::mission_of_file(file, mission());
    const Eigen::Vector3d pad = pad_of(own);
    const flight::Vehicle vehicle = config::flown_by(config::vehicle_of(own), dialect);
    flight::FlightFacts facts = config::flight_facts(own);
    facts.pad = pad;
    facts.is_pad_known = true;
    facts.views = survey_.views;
    facts.vehicle = vehicle;
    const flight::FlownRoute route = flight::interpret_file(file, facts);
    if (!route.problems.empty()) {
      throw Error(ErrorKind::bad_file, file.string() + " is not flown: " + route.problems.front());
    }
    const flight::Motion motion(vehicle, config::route_options_of(own, pad).conditions);
    return {script_of(route, motion), motion, law_of(file, dialect, pad, return_height)};
  }

  /// Legs are certified at the clearance; vehicles may stray by the errors that are a part of it.
  std::vector<flight::Judge> judges(double position_error) const {
    const config::FlightConfig& config = mission().flight;
    const double certified = flight::return_clearance(config.clearance) - flight::rounding_bound;
    const double strayed = certified - config.tracking_error - position_error;
    std::vector<flight::Judge> judges{
        {"what is not measured free", space_, pad_space_, strayed, certified}};
    if (truth_) {
      judges.push_back({"the true scene", truth_->everywhere, truth_->over_pad,
                        strayed - config.map_error, certified - config.map_error});
    }
    return judges;
  }

 private:
  /// The pad of a fleet's vehicle, or the package's.
  Eigen::Vector3d pad_of(const config::Mission& own) const {
    return config::is_fleet(mission()) ? own.flight.takeoff.value_or(pad()) : pad();
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
                          .landing_climb = config::takeoff_climb_of(mission())};
    const std::vector<Eigen::Vector3d>& rally = mission().flight.rally;
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

/// What each judge's nearest flight came nearest to.
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
  const config::Mission own = package::mission_of_file(file, package.mission());
  const Dialect dialect = *package::dialect_of(file, config::vehicle_of(own));
  const flight::FlownMission mission = package.read(file, dialect, options.return_height);
  const config::FlightConfig& config = package.mission().flight;
  flight::FlyTestOptions test;
  test.flights = options.flights;
  test.returns = options.returns;
  test.wind_speed = options.wind_speed.value_or(std::max(config.wind_speed, test.wind_speed));
  test.position_error = options.position_error.value_or(config.position_error);
  test.up_to = config.clearance + surplus_of_interest;
  test.seed = package.mission().seed;
  test.threads = package.mission().threads;
  test.stop = console.stop;
  ProgressLine progress(console, options.is_quiet);
  test.report = [&](std::size_t flown) {
    progress.show(fmt::format("{}: flight {} of {}", name, flown, options.flights));
  };
  const std::vector<flight::Judge> judges = package.judges(config.position_error);
  TestedFile tested{
      name, name_of(dialect), judges, fly_test(mission, judges, test), battery_of(mission.motion),
      {}};
  tested.obstacles = nearest_obstacles(tested);
  return tested;
}

/// All vehicles of a fleet at once; nothing if the package holds none.
std::optional<flight::FleetFlightTest> test_fleet(const FlyTestVerbOptions& options,
                                                  const config::Mission& mission,
                                                  const Console& console) {
  const std::filesystem::path table = options.package / package::timetable_name;
  if (!config::is_fleet(mission) || !std::filesystem::exists(table)) return std::nullopt;
  const config::FlightConfig& config = mission.flight;
  flight::FlyTestOptions test;
  test.flights = options.flights;
  test.wind_speed = options.wind_speed.value_or(std::max(config.wind_speed, test.wind_speed));
  test.position_error = options.position_error.value_or(config.position_error);
  test.up_to = package::reported_distance;
  test.seed = mission.seed;
  test.threads = mission.threads;
  test.stop = console.stop;
  const double strays = 2.0 * (config.position_error + config.tracking_error);
  return fly_fleet(package::fleet_flights(table, mission), config::separation_of(mission), strays,
                   test);
}

/// Results that are not whole go beside whole ones instead of over them.
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
  nlohmann::ordered_json json{{"mission", package.mission().name},
                              {"seed", package.mission().seed},
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
  if (const auto test = test_fleet(options, package.mission(), console)) {
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
