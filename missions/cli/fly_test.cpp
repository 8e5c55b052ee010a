#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "flight/export/export.h"
#include "flight/interpreter/interpret.h"
#include "flight/monte_carlo/monte_carlo.h"
#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/cli/commands.h"
#include "missions/cli/fly_test_report.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/inspection/inspection_flight.h"
#include "missions/inspection/inspection_package.h"
#include "missions/package/fleet/timetable_verification.h"
#include "missions/package/fleet_mission.h"
#include "missions/package/package.h"
#include "missions/package/verification/stated_return.h"
#include "missions/package/verification/true_space.h"
#include "missions/support/json_text.h"

namespace skycap::missions::cli {
namespace {

using flight::AutopilotType;

/// Distances are evaluated up to this value above the clearance [m].
constexpr double clearance_search_margin = 5.0;

std::string to_string(AutopilotType autopilot) {
  if (autopilot == AutopilotType::dji) return "DJI";
  return autopilot == AutopilotType::px4 ? "PX4" : "ArduPilot";
}

/// Returns the route files for autopilots, ordered by name.
std::vector<std::filesystem::path> route_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    for (const flight::FormatInfo& info : flight::formats()) {
      if (flight::captures_images(info.format) && package::is_flight_file(name, info.format)) {
        files.push_back(entry.path());
      }
    }
  }
  std::ranges::sort(files);
  if (!files.empty()) return files;
  throw Error(ErrorKind::bad_file, folder.string() +
                                       " contains no autopilot mission; plan the mission again "
                                       "with flight.vehicle and a georeference");
}

/// Flight of a survey or an inspection, with the space in which its files are verified.
struct TestedMission {
  std::string name;
  flight::FlightOptions flight;
  session::RunOptions run;
  std::vector<geometry::View> views;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  std::shared_ptr<const flight::FreeSpace> space;
};

TestedMission read_mission_package(const FlyTestCommandOptions& options) {
  const auto inspected = inspection::read_inspection(options.package, options.overrides);
  if (!inspected) {
    package::PackagedSurvey survey = package::read_package(options.package, options.overrides);
    return {std::move(survey.name),
            std::move(survey.flight),
            survey.run,
            std::move(survey.views),
            survey.pad,
            std::make_shared<const flight::MeasuredSpace>(std::move(survey.measured))};
  }
  if (!inspected->pad) {
    throw Error(ErrorKind::bad_file,
                (options.package / package::summary_name).string() +
                    " is an inspection without route files; see inspection.formats_not_written in "
                    "this file for the reason");
  }
  // Without views: the waypoints of an inspection take no photos.
  return {inspected->setup.name, inspection::inspection_flight_options(*inspected->space),
          inspected->setup.run,  {},
          *inspected->pad,       {inspected->space, &inspected->space->space()}};
}

/// Package to be tested, with its free space and the spaces that flights are evaluated against.
class TestedPackage {
 public:
  TestedPackage(const FlyTestCommandOptions& options, TestedMission mission)
      : mission_(std::move(mission)),
        rules_(mission_.flight.rules()),
        space_({mission_.space.get(), &rules_}),
        pad_space_(without_ground(mission_.flight.rules())) {
    if (!options.truth) return;
    const config::MissionSetup truth = config::read_mission(*options.truth);
    truth_ = package::true_space(
        mission_.flight, evaluation::placed_model(truth.scene(), options.truth->parent_path()),
        mission_.pad.z());
  }

  const std::string& name() const { return mission_.name; }
  const flight::FlightOptions& flight() const { return mission_.flight; }
  const session::RunOptions& run() const { return mission_.run; }
  const Eigen::Vector3d& pad() const { return mission_.pad; }

  flight::SimulatedMission read(const std::filesystem::path& file, AutopilotType autopilot,
                                const std::optional<double>& return_height) const {
    const flight::FlightOptions own = package::find_file_flight(file, flight());
    const Eigen::Vector3d pad = find_pad(own);
    const flight::Vehicle vehicle = own.vehicle_for(own.required_vehicle(), autopilot);
    flight::FlightFacts facts = own.facts();
    facts.pad = pad;
    facts.is_pad_known = true;
    facts.views = mission_.views;
    facts.vehicle = vehicle;
    const flight::InterpretedRoute route = flight::interpret_file(file, facts);
    if (!route.problems.empty()) {
      throw Error(ErrorKind::bad_file,
                  file.string() + " cannot be flown: " + route.problems.front());
    }
    const flight::Motion motion(vehicle, own.route(pad).conditions);
    return {make_flight_script(route, motion), motion,
            make_rtl_profile(file, autopilot, pad, return_height)};
  }

  /// Returns the clearance criteria. Legs are verified with the full clearance; flown paths may
  /// deviate by the errors included in it, and those of interrupted flights by `overshoot`.
  std::vector<flight::ClearanceCriterion> criteria(double position_error, double overshoot) const {
    const double verified_clearance =
        flight::return_clearance(flight().clearance) - flight::rounding_bound;
    const double strayed = verified_clearance - flight().tracking_error - position_error;
    std::vector<flight::ClearanceCriterion> criteria{
        {"unknown or occupied space", space_, pad_space_, strayed, verified_clearance, overshoot}};
    if (truth_) {
      criteria.push_back({"the scene (ground truth)", truth_->everywhere, truth_->over_pad,
                          strayed - flight().map_error, verified_clearance - flight().map_error,
                          overshoot});
    }
    return criteria;
  }

 private:
  /// Returns the pad of a fleet vehicle, or the package's pad.
  Eigen::Vector3d find_pad(const flight::FlightOptions& own) const {
    return flight().is_fleet() ? own.takeoff.value_or(pad()) : pad();
  }

  std::optional<flight::RtlProfile> make_rtl_profile(
      const std::filesystem::path& file, AutopilotType autopilot, const Eigen::Vector3d& pad,
      const std::optional<double>& return_height) const {
    const auto stated = package::stated_height(file, return_height, autopilot);
    if (!stated) return std::nullopt;
    if (!stated->problems.empty()) {
      throw Error(ErrorKind::bad_file, stated->by + ": " + stated->problems.front());
    }
    flight::RtlProfile rtl_profile{.autopilots = {autopilot},
                                   .level = pad.z() + stated->height,
                                   .landings = {pad},
                                   .landing_climb = flight().climb(),
                                   .braking = flight().braking_before_return()};
    const std::vector<Eigen::Vector3d>& rally = flight().rally;
    if (autopilot != AutopilotType::dji)
      rtl_profile.landings.insert(rtl_profile.landings.end(), rally.begin(), rally.end());
    return rtl_profile;
  }

  TestedMission mission_;
  flight::KnownSpace rules_;
  flight::JointSpace space_;
  flight::KnownSpace pad_space_;
  std::optional<package::TrueSpace> truth_;
};

/// Returns the obstacle nearest to any flight, for each judge.
std::vector<std::string> nearest_obstacles(const TestedFile& file) {
  std::vector<std::string> names;
  for (std::size_t j = 0; j < file.criteria.size(); ++j) {
    flight::Closest nearest{1e9};
    for (const flight::TestFlight& flight : file.test.flights) {
      const flight::Closest& closest = flight.simulated.nearest[j].closest;
      if (closest.distance < nearest.distance) nearest = closest;
    }
    std::string name = file.criteria[j].space.name(nearest);
    names.push_back(name.empty() ? file.criteria[j].pad_space.name(nearest) : name);
  }
  return names;
}

double compute_battery_energy(const flight::Motion& motion) {
  return motion.usable_energy() * (1.0 + motion.vehicle().energy_error) /
         (1.0 - motion.conditions().reserve);
}

TestedFile test_file(const FlyTestCommandOptions& options, const TestedPackage& package,
                     const std::filesystem::path& file, const Console& console) {
  const std::string name = file.filename().string();
  const flight::FlightOptions& flight_options = package.flight();
  const AutopilotType autopilot = *package::autopilot_for_file(
      file, package::find_file_flight(file, flight_options).required_vehicle());
  const flight::SimulatedMission mission = package.read(file, autopilot, options.return_height);
  flight::FlyTestOptions test;
  test.flights = options.flights;
  test.returns = options.returns;
  test.wind_speed =
      options.wind_speed.value_or(std::max(flight_options.wind_speed, test.wind_speed));
  test.position_error = options.position_error.value_or(flight_options.position_error);
  test.up_to = flight_options.clearance + clearance_search_margin;
  test.seed = package.run().seed;
  test.threads = package.run().threads;
  test.stop = console.stop;
  ProgressLine progress(console, options.is_quiet);
  test.report = [&](std::size_t count) {
    progress.show(fmt::format("{}: flight {} of {}", name, count, options.flights));
  };
  const std::vector<flight::ClearanceCriterion> criteria =
      package.criteria(flight_options.position_error, stop_overshoot(mission.motion.vehicle()));
  TestedFile tested{name,
                    to_string(autopilot),
                    criteria,
                    fly_test(mission, criteria, test),
                    compute_battery_energy(mission.motion),
                    {}};
  tested.obstacles = nearest_obstacles(tested);
  return tested;
}

/// Tests the joint flight of a fleet. Returns nullopt if the package has no fleet.
std::optional<flight::FleetFlightTest> test_fleet(const FlyTestCommandOptions& options,
                                                  const TestedPackage& package,
                                                  const Console& console) {
  const flight::FlightOptions& flight_options = package.flight();
  const std::filesystem::path table = options.package / package::timetable_name;
  if (!flight_options.is_fleet() || !std::filesystem::exists(table)) return std::nullopt;
  flight::FlyTestOptions test;
  test.flights = options.flights;
  test.wind_speed =
      options.wind_speed.value_or(std::max(flight_options.wind_speed, test.wind_speed));
  test.position_error = options.position_error.value_or(flight_options.position_error);
  test.up_to = package::reported_distance;
  test.seed = package.run().seed;
  test.threads = package.run().threads;
  test.stop = console.stop;
  const double strays = 2.0 * (flight_options.position_error + flight_options.tracking_error);
  return fly_fleet(package::fleet_flights(table, flight_options), flight_options.fleet.rule(),
                   strays, test);
}

/// Commits the results. Incomplete results do not overwrite complete ones.
void commit(geometry::OutputFolder& folder, bool is_complete) {
  if (!is_complete && package::is_complete_result(folder.path() / package::fly_test_name)) {
    folder.move_to("interrupted");
  }
  folder.commit();
}

}  // namespace

int fly_test(const FlyTestCommandOptions& options, const Console& console) {
  const TestedPackage package(options, read_mission_package(options));
  const std::vector<std::filesystem::path> files = route_files(options.package);
  geometry::OutputFolder folder(options.out.value_or(options.package));
  const PendingResultsGuard results(console);
  nlohmann::ordered_json json{{"mission", package.name()},
                              {"seed", package.run().seed},
                              {"complete", true},
                              {"files", nlohmann::ordered_json::array()}};
  std::size_t failed = 0;
  for (const std::filesystem::path& file : files) {
    const TestedFile tested = test_file(options, package, file, console);
    failed += failures(tested);
    json["files"].push_back(to_json(tested));
    if (!options.is_quiet) console.out << format_report(tested) << std::flush;
    if (console.stop.stop_requested()) break;
  }
  if (const auto test = test_fleet(options, package, console)) {
    failed += test->nearer;
    json["fleet"] = to_json(*test);
    if (!options.is_quiet) console.out << format_report(*test) << std::flush;
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
