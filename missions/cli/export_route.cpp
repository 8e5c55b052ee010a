#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "flight/clearance/measured_space.h"
#include "flight/export/export.h"
#include "flight/flown/imported_route.h"
#include "geometry/error.h"
#include "geometry/io/output_folder.h"
#include "missions/cli/commands.h"
#include "missions/cli/write_page.h"
#include "missions/config/mission_document.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/inspection/flight_file.h"
#include "missions/inspection/inspection_flight.h"
#include "missions/inspection/inspection_mission.h"
#include "missions/inspection/inspection_package.h"
#include "missions/inspection/inspection_results.h"
#include "missions/inspection/inspection_site.h"
#include "missions/package/flight_report.h"
#include "missions/package/imported_flight.h"
#include "missions/package/package.h"
#include "missions/package/pilot_text.h"
#include "missions/package/profile_file.h"
#include "missions/package/verification/true_space.h"
#include "missions/photo/photo_site.h"
#include "missions/support/number_text.h"
#include "missions/wizard/takeoff_point.h"

namespace skycap::missions::cli {
namespace {

using Eigen::Vector3d;

/// Tolerances of the simplification [m] for tracks that the default tolerance leads too close to
/// an obstacle.
constexpr std::array finer_tolerances{0.2, 0.1, 0.05};

/// Site of a route: the flight options of a mission and the space in which its routes are verified.
class RouteSite {
 public:
  explicit RouteSite(const ExportOptions& options, const Console& console) {
    if (std::filesystem::is_directory(options.package)) {
      read_folder(options);
    } else {
      read_mission(options, console);
    }
    if (!flight_.has_vehicle()) {
      throw Error(ErrorKind::bad_usage,
                  options.package.string() + ": --route requires a vehicle; set flight.vehicle");
    }
    if (flight_.is_fleet() && !measured_) {
      throw Error(ErrorKind::bad_usage,
                  options.package.string() +
                      ": --route with flight.vehicles requires the results folder of plan; plan "
                      "the mission, or set flight.vehicle instead");
    }
  }

  const std::string& name() const { return name_; }
  const flight::FlightOptions& flight() const { return flight_; }
  unsigned threads() const { return threads_; }

  /// Returns the take-off point, or std::nullopt if the mission does not set one.
  std::optional<Vector3d> pad() const { return pad_ ? pad_ : flight_.takeoff; }

  /// Returns the space of a flight from `pad`. This object must outlive it.
  package::ImportSpace space(const Vector3d& pad) {
    if (photo_) return {&photo_->measured(), nullptr, {}};
    if (inspection_) return {&inspection_->space(), nullptr, {}};
    if (measured_) return {measured_.get(), nullptr, landing_surfaces_};
    truth_.emplace(package::true_space(flight_, model_, pad.z()));
    landing_surfaces_ = package::true_landing_surfaces(flight_, model_, pad);
    return {&truth_->everywhere, &truth_->over_pad, landing_surfaces_};
  }

 private:
  void read_folder(const ExportOptions& options) {
    if (auto inspected = inspection::read_inspection(options.package, options.overrides)) {
      name_ = inspected->setup.name;
      inspection_ = inspected->space;
      flight_ = inspection::inspection_flight_options(*inspection_);
      pad_ = inspected->pad;
      return;
    }
    package::PackagedSurvey survey = package::read_package(options.package, options.overrides);
    name_ = std::move(survey.name);
    flight_ = std::move(survey.flight);
    threads_ = survey.run.threads;
    pad_ = survey.pad;
    landing_surfaces_ = std::move(survey.landing_surfaces);
    measured_ = std::make_unique<const flight::MeasuredSpace>(std::move(survey.measured));
  }

  void read_mission(const ExportOptions& options, const Console& console) {
    ProgressLine progress(console, false);
    setup_ = std::make_unique<const config::MissionSetup>(config::read_live_mission(
        options.package, options.overrides, progress.progress_callback()));
    progress.show(setup_->name + ": loading scene");
    name_ = setup_->name;
    flight_ = setup_->flight();
    try {
      if (setup_->document->is_inspection()) {
        inspection_ = std::make_shared<const inspection::InspectionSpace>(*setup_);
        flight_ = inspection::inspection_flight_options(*inspection_);
      } else if (setup_->document->is_photo()) {
        photo_ = std::make_unique<const photo::PhotoAirspace>(*setup_, setup_->run.threads);
      } else if (setup_->is_live()) {
        measured_ = std::make_unique<const flight::MeasuredSpace>(flight_.measured_space());
      } else {
        model_ = evaluation::placed_model(setup_->scene(), options.package.parent_path());
      }
    } catch (const Error& error) {
      throw Error(error.kind(), options.package.string() + ": " + error.what());
    }
  }

  std::string name_;
  flight::FlightOptions flight_;
  unsigned threads_ = 0;
  std::optional<Vector3d> pad_;
  std::unique_ptr<const config::MissionSetup> setup_;
  std::vector<flight::LandingSurface> landing_surfaces_;
  // One of these is set: space of a photo mission, of an inspection, measured or unknown space, or
  // the scene.
  std::unique_ptr<const photo::PhotoAirspace> photo_;
  std::shared_ptr<const inspection::InspectionSpace> inspection_;
  std::unique_ptr<const flight::MeasuredSpace> measured_;
  geometry::Mesh model_;
  std::optional<package::TrueSpace> truth_;
};

package::ImportOptions import_options(const ExportOptions& options) {
  package::ImportOptions import;
  import.tolerance = options.simplify;
  import.repairs = options.repairs;
  if (options.captures == "all") import.captures = package::ImportedCaptures::all;
  if (options.captures == "none") import.captures = package::ImportedCaptures::none;
  return import;
}

flight::TrackHeights track_heights(const std::string& heights) {
  if (heights == "takeoff") return flight::TrackHeights::takeoff;
  return heights == "absolute" ? flight::TrackHeights::absolute : flight::TrackHeights::automatic;
}

/// Returns the take-off point of the flight.
Vector3d find_pad(const RouteSite& site, const flight::ImportedRoute& route,
                  const std::string& file) {
  if (const auto pad = site.pad()) return *pad;
  if (route.is_above_takeoff) {
    throw Error(ErrorKind::bad_config,
                file +
                    ": the heights are above take-off, but the take-off point is unknown; set "
                    "flight.takeoff");
  }
  std::vector<geometry::View> views;
  for (const flight::ImportedPoint& point : route.points) {
    views.push_back({point.position, Vector3d::UnitY()});
  }
  return wizard::choose_takeoff(site.flight(), views);
}

int reject(const package::ImportedFlight& flight, const std::string& file, double clearance,
           const package::ImportOptions& import, const Console& console) {
  for (const std::string& problem : flight.problems) {
    console.out << file << ": " << problem << "\n";
  }
  const std::size_t legs = flight.route.points.size() - 1;
  console.out << file << ": not verified, "
              << (flight.unverified_legs > 0
                      ? fmt::format("{} of {} legs violate the clearance of {} m",
                                    flight.unverified_legs, legs, support::short_text(clearance))
                      : support::counted(flight.problems.size(), "problem"))
              << (import.repairs ? "" : "; move the waypoints or use --repair")
              << "; no file written\n"
              << std::flush;
  return 1;
}

/// Returns a problem of the flight along a corner file, whose first corner is in line 2.
std::string problem_text(const survey::inspection::FlightProblem& problem) {
  if (!problem.leg) return problem.what;
  const std::size_t leg = *problem.leg;
  return fmt::format("leg {} (line {} to line {}): {}", leg + 1, leg + 2, leg + 3, problem.what);
}

/// Verifies the flight along the corners of a file and writes the results of the inspection with
/// it.
int export_corners(const ExportOptions& options, const Console& console) {
  const std::string file = options.route->string();
  if (options.simplify || options.repairs || options.heights != "auto" ||
      options.captures != "file" || !options.formats.empty()) {
    throw Error(ErrorKind::bad_usage,
                "--simplify, --repair, --heights, --captures and --format conflict with " + file +
                    ", which contains the corners of an inspection flight; remove them");
  }
  std::optional<inspection::InspectionPackage> package;
  if (std::filesystem::is_directory(options.package)) {
    package = inspection::read_inspection(options.package, options.overrides);
  }
  if (!package) {
    throw Error(ErrorKind::bad_usage, file + " contains the corners of an inspection flight, and " +
                                          options.package.string() +
                                          " is not the results folder of an inspection");
  }
  const config::MissionSetup& setup = package->setup;
  ProgressLine progress(console, false);
  const auto report = [&](const std::string& what) { progress.show(setup.name + ": " + what); };
  report("verifying the flight");
  auto corners = inspection::read_corners_csv(file);
  inspection::EditedInspection edited;
  try {
    edited = inspection::plan_edited_inspection(*package, std::move(corners), console.stop, report);
  } catch (const Error& error) {
    throw Error(error.kind(), file + ": " + error.what());
  }
  if (!edited.problems.empty()) {
    progress.clear();
    for (const survey::inspection::FlightProblem& problem : edited.problems) {
      console.out << file << ": " << problem_text(problem) << "\n";
    }
    console.out << file << ": not verified, " << support::counted(edited.problems.size(), "problem")
                << "; move the corners; no file written\n"
                << std::flush;
    return 1;
  }
  geometry::OutputFolder folder(*options.out);
  report("writing " + folder.path().string());
  inspection::stage_inspection_mission(setup, *package->space, edited.mission, folder);
  write_page(package::summary_name, true, folder, console);
  folder.commit();
  progress.clear();
  console.out << setup.name << ": verified\n"
              << fmt::format("  route     {}: {}\n", file,
                             support::counted(edited.mission.plan.vertices.size(), "corner"));
  if (edited.slowed_legs > 0) {
    console.out << fmt::format("  slowed    {}, {:.1f} s in total, to keep the motion limits\n",
                               support::counted(edited.slowed_legs, "leg"), edited.added_delay);
  }
  console.out << inspection::plan_text(setup, edited.mission) << "  results   "
              << folder.path().string() << "\n"
              << inspection::warnings_text(setup, edited.mission) << std::flush;
  return 0;
}

}  // namespace

int export_route(const ExportOptions& options, const Console& console) {
  if (!options.out) {
    throw Error(ErrorKind::bad_usage, "--route requires --out, because the files of " +
                                          options.package.string() + " belong to another flight");
  }
  if (options.lost) throw Error(ErrorKind::bad_usage, "--lost conflicts with --route");
  if (inspection::is_corner_file(*options.route)) return export_corners(options, console);
  const std::string file = options.route->string();
  std::vector<flight::Format> formats;
  for (const std::string& name : options.formats) formats.push_back(flight::format_named(name));
  RouteSite site(options, console);
  const flight::FlightOptions& flight_options = site.flight();

  ProgressLine progress(console, false);
  progress.show("reading " + file);
  flight::FlightFacts facts = flight_options.facts();
  facts.vehicle.reset();  // The file may be for another vehicle.
  if (const auto pad = site.pad()) facts.pad = *pad;
  facts.is_pad_known = site.pad().has_value();
  flight::ImportedRoute route = flight::read_imported_route(
      *options.route, facts, flight_options.is_georeferenced, track_heights(options.heights));
  const Vector3d pad = find_pad(site, route, file);
  const package::ImportOptions import = import_options(options);
  package::ImportedFlight flight;
  const package::ImportSpace space = site.space(pad);
  const auto verify = [&](const package::ImportOptions& settings) {
    package::ImportedFlight attempt =
        package::simplify_import(route, flight_options, pad, settings);
    progress.show(site.name() + ": verifying " +
                  support::counted(attempt.route.points.size(), "waypoint"));
    if (flight_options.is_fleet()) {
      package::plan_fleet_import(attempt, flight_options, space, pad, settings, site.threads(),
                                 console.stop);
    } else {
      package::plan_import(attempt, flight_options, space, pad, settings, console.stop);
    }
    return attempt;
  };
  try {
    flight = verify(import);
    if (route.is_track && !import.tolerance) {
      for (const double tolerance : finer_tolerances) {
        if (flight.problems.empty()) break;
        package::ImportOptions finer = import;
        finer.tolerance = tolerance;
        package::ImportedFlight attempt = verify(finer);
        if (attempt.problems.empty()) flight = std::move(attempt);
      }
    }
  } catch (const Error& error) {
    throw Error(error.kind(), file + ": " + error.what());
  }
  progress.clear();
  if (!flight.problems.empty()) {
    return reject(flight, file, flight_options.budget().total(), import, console);
  }

  geometry::OutputFolder folder(*options.out);
  progress.show(site.name() + ": writing " + folder.path().string());
  package::SurveyMission& mission = *flight.mission;
  if (flight.fleet) {
    package::stage_fleet(site.name(), *flight.fleet, *space.space, formats, folder);
    mission.fleet = flight.fleet;
  } else {
    if (formats.empty()) {
      const auto own = package::package_formats(flight_options.required_vehicle());
      formats.assign(own.begin(), own.end());
    }
    mission.files = package::stage_flight(site.name(), flight_options, mission.route, *space.space,
                                          formats, folder);
    package::stage_profile(flight_options, mission.route, *space.space, folder, console.stop);
  }
  folder.replace([](std::string_view name) {
    return package::is_flight_file(name) || name == package::profile_name;
  });
  folder.commit();
  progress.clear();
  console.out << site.name() << ": verified\n"
              << package::import_text(flight, file, flight_options)
              << (flight.fleet ? "" : package::flight_text(mission)) << "  results   "
              << folder.path().string() << "\n"
              << package::pilot_text(flight_options, mission) << std::flush;
  return 0;
}

}  // namespace skycap::missions::cli
