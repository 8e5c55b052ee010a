#include "flight/export/export.h"

#include <algorithm>
#include <span>
#include <string_view>

#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/cli/command_options.h"
#include "missions/cli/commands.h"
#include "missions/inspection/inspection_package.h"
#include "missions/package/fleet/timetable_verification.h"
#include "missions/package/fleet_mission.h"
#include "missions/package/flight_report.h"
#include "missions/package/package.h"
#include "missions/package/pilot_text.h"

namespace skycap::missions::cli {
namespace {

/// Waypoints of a survey, with the vehicle and pad of the flight.
struct Task {
  flight::FlightOptions flight;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  std::vector<flight::CapturePoint> capture_points;
};

/// Returns the waypoints not yet visited by a lost fleet vehicle, as a task for the remaining
/// vehicles.
Task remaining_task(const ExportOptions& options, const package::PackagedSurvey& survey,
                    Task task) {
  const flight::FlightOptions& flight = survey.flight;
  const std::size_t lost = *options.lost - 1, count = flight.fleet.vehicles.size();
  if (!flight.is_fleet() || lost >= count) {
    throw Error(ErrorKind::bad_usage, "--lost " + std::to_string(*options.lost) +
                                          ": the number of vehicles in the package is " +
                                          std::to_string(count));
  }
  const std::filesystem::path table = options.package / package::timetable_name;
  std::vector<Eigen::Vector3d> pads = flight.fleet_pads(survey.pad);
  for (const package::TimetableRow& row : package::read_timetable(table, flight)) {
    pads[row.vehicle] = row.pad;
  }
  const std::vector<Eigen::Vector3d> left =
      package::left_by(table, flight, lost, options.after.value_or(0.0));
  std::erase_if(task.capture_points, [&](const flight::CapturePoint& capture_point) {
    return std::ranges::none_of(left, [&](const Eigen::Vector3d& position) {
      return (capture_point.view.position - position).norm() <= flight::rounding_bound;
    });
  });
  if (task.capture_points.empty()) {
    throw Error(ErrorKind::bad_usage,
                "--lost " + std::to_string(*options.lost) +
                    ": the vehicle has captured all of its views by this time");
  }
  std::vector<std::size_t> kept;
  for (std::size_t v = 0; v < count; ++v) {
    if (v != lost) kept.push_back(v);
  }
  task.flight = flight.with_vehicles(kept, pads);
  task.pad = *task.flight.takeoff;
  return task;
}

Task make_task(const ExportOptions& options, const package::PackagedSurvey& survey) {
  Task task{survey.flight, survey.pad,
            package::make_capture_points(survey.flight, survey.views, survey.paths)};
  return options.lost ? remaining_task(options, survey, std::move(task)) : task;
}

void check_lost(const ExportOptions& options) {
  if (options.after && !options.lost) {
    throw Error(ErrorKind::bad_usage, "--after requires --lost");
  }
  if (options.lost && !options.out) {
    throw Error(
        ErrorKind::bad_usage,
        "--lost requires --out, because the other vehicles still use the files of the package");
  }
}

int export_inspection(const ExportOptions& options, std::span<const flight::Format> formats,
                      const inspection::InspectionPackage& package, const Console& console,
                      ProgressLine& progress) {
  if (options.lost) {
    throw Error(ErrorKind::bad_usage, "--lost requires a fleet, and " + options.package.string() +
                                          " is the inspection of one vehicle; remove the option");
  }
  geometry::OutputFolder folder(options.out.value_or(options.package));
  progress.show(package.setup.name + ": planning the flight");
  inspection::InspectionExport exported;
  try {
    exported = inspection::export_inspection(package, formats, console.stop, folder);
  } catch (const Error& error) {
    throw Error(error.kind(), options.package.string() + ": " + error.what());
  }
  folder.replace([&](std::string_view name) {
    return std::ranges::any_of(
        formats, [&](flight::Format format) { return package::is_flight_file(name, format); });
  });
  folder.commit();
  progress.clear();
  console.out << inspection::export_text(package, exported) << "  results   "
              << folder.path().string() << "\n";
  if (exported.flight) {
    console.out << package::pilot_text(package.setup.flight(), exported.flight->mission,
                                       exported.warnings);
  }
  console.out << std::flush;
  return 0;
}

}  // namespace

int export_package(const ExportOptions& options, const Console& console) {
  if (options.route) return export_route(options, console);
  if (options.simplify || options.repairs || options.heights != "auto" ||
      options.captures != "file") {
    throw Error(ErrorKind::bad_usage,
                "--simplify, --repair, --heights and --captures require --route");
  }
  if (options.formats.empty()) throw Error(ErrorKind::bad_usage, "--format is required");
  std::vector<flight::Format> formats;
  for (const std::string& name : options.formats) formats.push_back(flight::format_named(name));
  check_lost(options);

  ProgressLine progress(console, false);
  progress.show("reading " + options.package.string());
  if (const auto package = inspection::read_inspection(options.package, options.overrides)) {
    return export_inspection(options, formats, *package, console, progress);
  }
  const package::PackagedSurvey survey = package::read_package(options.package, options.overrides);
  const Task task = make_task(options, survey);
  geometry::OutputFolder folder(options.out.value_or(options.package));
  progress.show(survey.name + ": planning the flight");
  package::SurveyMission flight;
  flight.image_motion = task.flight.image_motion_bounds();
  flight.route = package::plan_flight(task.flight, survey.measured, task.pad, task.capture_points,
                                      survey.landing_surfaces, console.stop);
  const bool is_fleet = task.flight.is_fleet();
  if (is_fleet) {
    flight.fleet = package::staged_fleet(survey.name, task.flight, survey.measured, flight.route,
                                         survey.landing_surfaces, formats, folder,
                                         survey.run.threads, console.stop);
  } else {
    flight.files = package::stage_flight(survey.name, task.flight, flight.route, survey.measured,
                                         formats, folder);
  }
  folder.replace([&](std::string_view name) {
    if (is_fleet != package::is_fleet_file(name)) return false;
    return is_fleet || std::ranges::any_of(formats, [&](flight::Format format) {
             return package::is_flight_file(name, format);
           });
  });
  folder.commit();
  progress.clear();
  console.out << package::flight_text(flight) << "  results   " << folder.path().string() << "\n"
              << package::pilot_text(task.flight, flight) << std::flush;
  return flight.route.sorties.empty() ? 1 : 0;
}

void add_export(CLI::App& app, const Console& console, Action& action) {
  CLI::App* command = app.add_subcommand(
      "export", "Export a flight or your own route in another format or for another vehicle");
  const auto options = std::make_shared<ExportOptions>();
  const auto keys = std::make_shared<KeyOptions>();
  command
      ->add_option("package", options->package,
                   "Results folder of plan; with --route, a mission file or a results folder")
      ->required();
  command
      ->add_option("--format", options->formats,
                   "Format: plan, waypoints, kmz, kml, geojson, litchi, csv, ned-csv or tum; "
                   "repeatable (default with --route: those of the vehicle)")
      ->type_size(1)
      ->allow_extra_args(false);
  command->add_option("--out", options->out, "Folder for the files (default: the package)");
  command
      ->add_option("--lost", options->lost,
                   "Number of the lost vehicle. Its remaining views are distributed among the "
                   "other vehicles")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--after", options->after,
                   "Time of loss in the timetable, in seconds (default: before the first take-off)")
      ->check(number_between(0.0, 1e9));
  command->add_option("--route", options->route,
                      "Route or track to verify and export instead: waypoint table .csv, .kml, a "
                      "route file, or a flight log (.bin, .ulg, .gpx, .srt, .tum)");
  command
      ->add_option("--simplify", options->simplify,
                   "Maximum distance in metres of the route's positions from the simplified route "
                   "(default for tracks and logs: 0.5, or less if required by the clearance; "
                   "waypoints are not simplified)")
      ->check(number_between(0.01, 100.0));
  command->add_flag("--repair", options->repairs,
                    "Lead legs that are not free round the obstacles, and skip waypoints that are "
                    "not free");
  command
      ->add_option("--heights", options->heights,
                   "Heights of the route to use: auto, takeoff or absolute (default: auto)")
      ->check(CLI::IsMember({"auto", "takeoff", "absolute"}));
  command
      ->add_option("--captures", options->captures,
                   "Waypoints of the route with a photo: file (as in the file), all or none "
                   "(default: file)")
      ->check(CLI::IsMember({"file", "all", "none"}));
  add_set_option(*command, *keys);
  run_with_keys(*command, options, keys, export_package, console, action);
}

}  // namespace skycap::missions::cli
