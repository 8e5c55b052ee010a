#include "missions/package/package.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "geometry/interrupted.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/file.h"
#include "geometry/io/json.h"
#include "geometry/parallel.h"
#include "geometry/pose/pose.h"
#include "geometry/pose/world.h"
#include "geometry/surfaces/mesh.h"
#include "missions/evaluation/coverage.h"
#include "missions/package/cloud_normals.h"
#include "missions/package/coverage_map.h"
#include "missions/package/field_sheet.h"
#include "missions/package/fleet_mission.h"
#include "missions/package/former_fields.h"
#include "missions/package/ground_json.h"
#include "missions/package/holes.h"
#include "missions/package/profile_file.h"
#include "missions/package/replanned_mission.h"
#include "missions/package/settings.h"
#include "missions/package/written_mission.h"
#include "missions/session/en_route_frames.h"
#include "missions/simulation/measurement.h"
#include "missions/simulation/survey_journal.h"
#include "missions/support/json_text.h"
#include "missions/support/number_text.h"

namespace skycap::missions::package {
namespace {

using support::to_vector;
using Json = nlohmann::ordered_json;

constexpr const char* coverage_name = "coverage.ply";
constexpr const char* true_coverage_name = "true_coverage.ply";

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
  throw Error(ErrorKind::bad_file, file.string() + ": " + what);
}

/// Throws Error{bad_file}.
Json parse_summary(const std::string& text, const std::string& name) {
  Json summary = geometry::parse_json<Json>(text);
  use_current_fields(summary);
  if (summary.is_object()) return summary;
  fail(name,
       "is not the summary of a package (not JSON or nested too deeply); specify the folder of a "
       "mission package");
}

/// Returns the path to a view from its entry in the summary of a flown survey.
Polyline path_from_json(const Json& view, const std::string& what) {
  Polyline path;
  if (!view.contains("way")) return path;
  for (const Json& point : view["way"]) {
    path.push_back(to_vector(point));
    geometry::require_valid_position(path.back(), what);
  }
  return path;
}

std::vector<Polyline> flown_paths(const session::FlightRecord& flight_record) {
  std::vector<Polyline> paths;
  for (const session::ExecutedLeg& leg : flight_record.legs) paths.push_back(leg.points);
  return paths;
}

/// Returns the sensor positions by scan number.
std::vector<Eigen::Vector3d> sensor_positions(const session::SurveyRecord& record) {
  std::vector<Eigen::Vector3d> positions;
  for (const session::RecordedScan& scan : record.scans) positions.push_back(scan.position);
  if (!positions.empty()) return positions;
  for (const session::EvaluatedView& evaluated : record.views) {
    positions.push_back(evaluated.surveyed.view.position);
  }
  return positions;
}

/// Returns, for each point of the cloud, the view at which or on the path to which it was measured.
std::vector<std::uint32_t> collect_point_views(const session::SurveyRecord& record) {
  std::vector<std::uint32_t> views = record.cloud.views;
  if (record.scans.empty()) return views;
  for (std::uint32_t& view : views) view = record.scans[view].view;
  return views;
}

/// Plans the route of a flown survey, including replanning.
void plan_route(const evaluation::SimulationOptions& simulation, const session::RunOptions& run,
                const session::SurveyRecord& record, std::span<const Eigen::Vector3f> normals,
                const CoverageFigures& coverage, const std::stop_token& stop,
                SurveyMission& flight) {
  const session::FlightRecord& flight_record = *record.flight_record;
  const flight::FlightOptions& options = simulation.survey.flight;
  const bool scans_in_flight = options.capture.scans_in_flight();
  flight.image_motion = options.image_motion_bounds();
  // A scanner's en-route measurements are valid only for the paths of the survey.
  flight.route = plan_flight(scans_in_flight ? with_fixed_order(options) : options,
                             *flight_record.measured, flight_record.pad, collect_views(record),
                             flown_paths(flight_record), flight_record.landing_surfaces, stop);
  if (flight.route.sorties.empty() && !flight.route.unreached.empty()) {
    const flight::Unreached& first = flight.route.unreached.front();
    throw Error(ErrorKind::bad_config, "no view can be included in the flight; view " +
                                           std::to_string(first.capture_point.view_index) + ": " +
                                           first.reason);
  }
  if (flight.route.capture_points.empty()) return;
  if (!record.surface) return;
  ChoiceOptions choice = choice_options(simulation.sensor, run);
  std::optional<MeasuredSurface> measured;
  if (!scans_in_flight && !normals.empty()) {
    measured.emplace(simulation.survey.planner.spacing, record.cloud, normals, run.threads);
    choice.measured = &*measured;
    choice.keeps_reflight = options.views == flight::MissionViews::fastest;
  }
  flight.replanned =
      replan_mission(simulation.survey, choice, record, coverage, std::move(flight.route), stop);
  flight.route = std::move(flight.replanned->choice.route);
}

/// Runs a part of the flight planning. Errors are stored in `flight.failure`, so that the survey
/// itself is not lost.
template <typename Work>
void attempt(SurveyMission& flight, Work work) {
  if (!flight.failure.empty()) return;
  try {
    work();
  } catch (const Interrupted&) {
    flight.failure = "interrupted; run skycap export to create it";
  } catch (const Error& error) {
    flight.failure = error.what();
  }
}

/// Returns an empty value for a survey without a vehicle.
std::optional<SurveyMission> planned_mission(const evaluation::SimulationOptions& simulation,
                                             const session::RunOptions& run,
                                             const session::SurveyRecord& record,
                                             std::span<const Eigen::Vector3f> normals,
                                             const CoverageFigures& coverage,
                                             const std::stop_token& stop) {
  if (!record.flight_record) return std::nullopt;
  SurveyMission flight;
  attempt(flight, [&] { plan_route(simulation, run, record, normals, coverage, stop, flight); });
  return flight;
}

/// Stages the free space and the files of the flight.
void stage_mission(const std::string& name, const flight::FlightOptions& options, unsigned threads,
                   const session::SurveyRecord& record, SurveyMission& flight,
                   geometry::OutputFolder& folder, const std::stop_token& stop) {
  std::ostringstream free_space;
  free_space.exceptions(
      std::ios::badbit);  // Without this, text is silently lost when memory is exhausted.
  record.flight_record->measured->write(free_space);
  folder.write(free_space_name, free_space.str());
  attempt(flight, [&] {
    const flight::MeasuredSpace& measured = *record.flight_record->measured;
    flight.files = stage_flight(name, options, flight.route, measured,
                                package_formats(options.required_vehicle()), folder);
    stage_profile(options, flight.route, measured, folder, stop);
    if (!options.is_fleet()) return;
    flight.fleet = staged_fleet(name, options, measured, flight.route,
                                record.flight_record->landing_surfaces, {}, folder, threads, stop);
  });
}

void stage_coverage(const session::SurveyRecord& record, const CoverageFigures& coverage,
                    geometry::OutputFolder& folder) {
  if (const auto patches = known_surface(record, coverage); !patches.empty()) {
    geometry::write_cloud(folder.stage(coverage_name), make_columns(coverage_map(patches)));
  }
  if (coverage.truth) write_true_coverage(folder.stage(true_coverage_name), *coverage.truth);
}

/// For the crew: on the true surface of a simulated survey, else on the cloud.
std::string sheet_of(const config::MissionSetup& setup, const session::SurveyRecord& record,
                     const CoverageFigures& coverage, const SurveyMission& flight) {
  const geometry::CameraConfig& camera = setup.flight().capture.camera;
  FieldSheetSite site{
      .mission = setup.name,
      .sensor = setup.lidar.value_or("camera of " + std::to_string(camera.width) + " x " +
                                     std::to_string(camera.height) + " pixels"),
      .survey_coverage = coverage.all,
      .surface = record.cloud.positions};
  if (coverage.truth) {
    site.surface = coverage.truth->samples.points;
    site.is_covered = coverage.truth->is_covered;
  }
  return field_sheet(site, setup.flight(), flight);
}

}  // namespace

std::vector<geometry::View> collect_views(const session::SurveyRecord& record) {
  std::vector<geometry::View> views;
  for (const session::EvaluatedView& evaluated : record.views)
    views.push_back(evaluated.surveyed.view);
  return views;
}

std::span<const survey::surfel::EstimatedPatch> known_surface(const session::SurveyRecord& record,
                                                              const CoverageFigures& coverage) {
  return record.estimate ? record.estimate->patches : coverage.patches;
}

std::string views_csv(const session::SurveyRecord& record) {
  std::string csv =
      "view,x,y,z,direction_x,direction_y,direction_z,returns,points_new,points,frontiers,"
      "coverage,distance_m\n";
  for (std::size_t i = 0; i < record.views.size(); ++i) {
    const session::EvaluatedView& evaluated = record.views[i];
    const survey::SurveyedView& view = evaluated.surveyed;
    csv += std::to_string(i);
    for (const Eigen::Vector3d& vector : {view.view.position, view.view.direction}) {
      for (int axis = 0; axis < 3; ++axis)
        csv.append(",").append(support::exact_text(vector[axis]));
    }
    for (const std::size_t count :
         {view.returns, view.step.points_new, view.points, view.step.frontiers}) {
      csv.append(",").append(std::to_string(count));
    }
    csv.append(",").append(support::exact_text(evaluated.coverage));
    csv.append(",").append(support::exact_text(view.distance)).append("\n");
  }
  return csv;
}

std::string trajectory_tum(const session::SurveyRecord& record) {
  std::string tum = "# timestamp tx ty tz qx qy qz qw\n";
  for (std::size_t i = 0; i < record.views.size(); ++i) {
    const Eigen::Isometry3d world_from_camera =
        geometry::camera_pose(record.views[i].surveyed.view);
    const Eigen::Vector3d& position = world_from_camera.translation();
    const Eigen::Quaterniond turn(world_from_camera.linear());
    tum += std::to_string(i);
    for (const double number :
         {position.x(), position.y(), position.z(), turn.x(), turn.y(), turn.z(), turn.w()}) {
      tum.append(" ").append(support::exact_text(number));
    }
    tum += "\n";
  }
  return tum;
}

CoverageFigures coverage_figures(const evaluation::SimulationOptions& options,
                                 const session::SurveyRecord& record,
                                 const evaluation::SurveyScene& scene, unsigned threads,
                                 const std::stop_token& stop) {
  CoverageFigures figures{record.coverage(), {}, {}};
  std::vector<std::uint8_t> is_visible, is_attainable;
  // Skipped after an interruption because the user wants to exit.
  if (record.stop_reason != survey::StopReason::interrupted) {
    is_visible = scene.visible(threads, stop);
    const auto marks = scene.attainable(is_visible, threads, stop);
    if (stop.stop_requested()) {
      is_visible.clear();
    } else {
      figures.visible = evaluation::covered_share(record.is_covered, is_visible);
      if (marks) figures.attainable_coverage = evaluation::marked_share(*marks);
      is_attainable = marks.value_or(is_attainable);
    }
    figures.fly_again = [&options, &scene, seed = record.seed, threads](
                            const std::vector<session::ViewInFlight>& views,
                            const simulation::VisitScan& visit, const std::stop_token& asked) {
      return simulation::reflight_coverage(options, scene, views, seed, threads, visit, asked);
    };
  }
  const double area = geometry::surface_area(scene.model());
  if (!record.estimate) {
    figures.patches = true_patches(scene.samples(), area, record.is_covered, is_visible);
  }
  figures.truth = {scene.samples(), record.is_covered, std::move(is_visible),
                   std::move(is_attainable), area};
  return figures;
}

void commit_package(const session::SurveyRecord& record, geometry::OutputFolder& folder) {
  if (record.stop_reason != survey::StopReason::interrupted) {
    folder.replace([](std::string_view name) {
      return name == simulation::journal_name || name == simulation::preview_name;
    });
  } else if (is_complete_result(folder.path() / summary_name)) {
    folder.move_to("interrupted");
  }
  folder.commit();
}

std::optional<SurveyMission> stage_package(const config::MissionSetup& setup,
                                           const session::SurveyRecord& record,
                                           const CoverageFigures& coverage, unsigned threads,
                                           geometry::OutputFolder& folder, std::stop_token stop) {
  folder.replace([](std::string_view name) {
    return name == free_space_name || name == coverage_name || name == true_coverage_name ||
           name == fly_test_name || name == report_name || name == field_sheet_name ||
           name == profile_name || is_flight_file(name);
  });
  const std::vector<Eigen::Vector3f> normals =
      cloud_normals(record.cloud, sensor_positions(record),
                    2.0 * setup.survey().planner.resolution_radius, threads, stop);
  std::optional<SurveyMission> flight =
      planned_mission(setup.simulation, setup.run, record, normals, coverage, stop);
  if (flight) {
    stage_mission(setup.name, setup.flight(), setup.run.threads, record, *flight, folder, stop);
    flight->written = written_mission(setup.simulation, coverage, *flight, stop);
  }
  if (flight && flight->failure.empty() && !flight->route.sorties.empty()) {
    folder.write(field_sheet_name, sheet_of(setup, record, coverage, *flight));
  }
  const std::filesystem::path cloud_file = folder.stage("cloud.ply");
  geometry::parallel_for(2, threads, [&](std::size_t part) {
    if (part == 0) {
      const std::vector<std::uint32_t> views = collect_point_views(record);
      geometry::write_cloud(
          cloud_file,
          {.positions = record.cloud.positions, .normals = normals, .views = views, .colours = {}});
    } else {
      stage_coverage(record, coverage, folder);
      folder.write("views.csv", views_csv(record));
      folder.write("trajectory.tum", trajectory_tum(record));
    }
  });
  // The summary is written last, so that its existence implies that of the other files.
  folder.write(summary_name, summary_json(setup, record, coverage, flight));
  return flight;
}

PackageSummary read_package_summary(const std::filesystem::path& folder,
                                    const std::vector<config::KeyOverride>& overrides) {
  const std::filesystem::path file = folder / summary_name;
  geometry::finish_commit(folder);
  return parse_package_summary(geometry::read_file(file, geometry::largest_json), file.string(),
                               overrides);
}

PackageSummary parse_package_summary(const std::string& text, const std::string& name,
                                     const std::vector<config::KeyOverride>& overrides) {
  try {
    const Json json = parse_summary(text, name);
    if (json.value("kind", Json()) == "inspection") {
      fail(name, "describes an inspection, which has no views to stop at");
    }
    PackageSummary summary;
    summary.mission = mission_from_settings(json.at("settings"), name, overrides);
    if (json.contains("flight")) {
      summary.pad = summary.mission.flight().takeoff.value_or(to_vector(json["flight"].at("pad")));
      geometry::require_valid_position(*summary.pad, name + ": flight.pad");
      if (json["flight"].contains("grounds")) {
        summary.landing_surfaces = measured_landing_surfaces(json["flight"]["grounds"], name);
      }
      summary.has_choice = json["flight"].contains("replanned");
      if (summary.has_choice && summary.mission.flight().views != flight::MissionViews::survey) {
        summary.replanned = replanned_capture_points(json["flight"]["replanned"], name);
      }
    }
    for (const Json& view : json.at("per_view")) {
      summary.views.push_back({to_vector(view.at("position")), to_vector(view.at("direction"))});
      const std::string location =
          name + ": per_view[" + std::to_string(summary.views.size() - 1) + "].";
      geometry::require_valid_position(summary.views.back().position, location + "position");
      geometry::require_direction(summary.views.back().direction, location + "direction");
      summary.paths.push_back(path_from_json(view, location + "way"));
    }
    return summary;
  } catch (const Json::exception& error) {
    fail(name, std::string("is not the summary of a package (") + error.what() + ")");
  }
}

bool is_complete_result(const std::filesystem::path& json_file) {
  try {
    const Json json =
        geometry::parse_json<Json>(geometry::read_file(json_file, geometry::largest_json));
    return json.is_object() && json.value("complete", Json()) == Json(true);
  } catch (const Error&) {
    return false;  // File does not exist.
  }
}

PackagedSurvey read_package(const std::filesystem::path& folder,
                            const std::vector<config::KeyOverride>& overrides) {
  PackageSummary summary = read_package_summary(folder, overrides);
  if (!summary.pad) {
    fail(folder / summary_name,
         "is a survey without a vehicle; plan the survey with flight.vehicle");
  }
  if (summary.mission.flight().views == flight::MissionViews::replanned && !summary.has_choice) {
    fail(folder / summary_name,
         "contains no replanned views; plan the mission again, or set flight.views=survey");
  }
  const std::filesystem::path space_file = folder / free_space_name;
  std::ifstream space;
  if (std::filesystem::exists(space_file)) {
    geometry::require_regular_file(space_file);
    space = geometry::open_stream(space_file);
  }
  if (!space.is_open()) fail(space_file, "cannot be read; plan the mission again");
  flight::FlightOptions options = summary.mission.flight();
  if (summary.replanned) {
    options = with_fixed_order(std::move(options));
    summary.views = std::move(summary.replanned->views);
    summary.paths = std::move(summary.replanned->paths);
  }
  return {.name = summary.mission.name,
          .flight = std::move(options),
          .run = summary.mission.run,
          .views = std::move(summary.views),
          .paths = std::move(summary.paths),
          .pad = *summary.pad,
          .landing_surfaces = std::move(summary.landing_surfaces),
          .measured = flight::MeasuredSpace::read(space, space_file.string())};
}

}  // namespace skycap::missions::package
