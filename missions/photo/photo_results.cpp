#include "missions/photo/photo_results.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "flight/export/geodesy.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/surfaces/sight_lines.h"
#include "missions/config/mission_document.h"
#include "missions/package/field_sheet.h"
#include "missions/package/flight_report.h"
#include "missions/package/package.h"
#include "missions/package/profile_file.h"
#include "missions/package/settings.h"
#include "missions/photo/colmap_model.h"
#include "missions/photo/control_points.h"
#include "missions/photo/photo_summary.h"
#include "missions/photo/surface_map.h"
#include "missions/support/json_text.h"
#include "missions/support/number_text.h"
#include "missions/version.h"

namespace skycap::missions::photo {
namespace {

using support::to_json;
using Json = nlohmann::ordered_json;
using survey::photo::PhotoFigures;

/// Estimated standard deviation of the angles of a camera on a gimbal, with a compass heading
/// [rad].
constexpr double angle_sigma = geometry::radians_per_degree;

/// Returns counts and fractions of surface samples.
Json figures_json(const PhotoFigures& figures) {
  const auto share = [&](std::size_t count) {
    return Json{{"samples", count},
                {"of_exposed", figures.share(count)},
                {"of_attainable", figures.attainable_share(count)}};
  };
  Json partners = Json::object();
  for (std::size_t i = 0; i < figures.by_partners.size(); ++i) {
    const int k = static_cast<int>(i) - 2;
    partners[k == 6 ? "6_or_more" : std::to_string(k)] = figures.by_partners[i];
  }
  return {{"photos", figures.photos},
          {"expected_completeness", figures.completeness},
          {"expected_completeness_of_attainable",
           figures.attainable > 0 ? figures.completeness * static_cast<double>(figures.samples) /
                                        static_cast<double>(figures.attainable)
                                  : 0.0},
          {"expected_three_depths", figures.threefold},
          {"satisfied", share(figures.satisfied)},
          {"good", share(figures.good)},
          {"weak", share(figures.weak)},
          {"missing", share(figures.missing)},
          {"stereo_partners", partners}};
}

Json tour_json(const PhotoTour& tour) {
  return {{"length_m", tour.length}, {"duration_s", tour.duration}};
}

Json patterns_json(const PhotoMission& mission) {
  Json list = Json::array();
  for (std::size_t i = 0; i < mission.result.patterns.size(); ++i) {
    const survey::photo::PatternResult& pattern = mission.result.patterns[i];
    list.push_back({{"pattern", to_string(pattern.pattern)},
                    {"dropped_photos", pattern.dropped},
                    {"figures", figures_json(pattern.figures)},
                    {"tour", tour_json(mission.patterns[i].whole)},
                    {"pruned", figures_json(pattern.pruned)},
                    {"pruned_tour", tour_json(mission.patterns[i].pruned)}});
  }
  return list;
}

Json graph_json(const survey::photo::ViewGraph& graph) {
  return {
      {"parts", graph.parts}, {"edges", graph.edges.size()}, {"min_degree", graph.min_degree()}};
}

Json missing_json(const survey::photo::PhotoPlanResult& result) {
  Json reasons = Json::object();
  for (std::size_t i = 0; i < survey::photo::missing_reasons; ++i) {
    const double area = result.missing_area[i];
    reasons[to_string(static_cast<survey::photo::MissingReason>(i))] = {
        {"area_m2", area},
        {"of_exposed", result.exposed_area > 0.0 ? area / result.exposed_area : 0.0}};
  }
  return reasons;
}

Json curve_json(const survey::photo::PhotoPlanResult& result) {
  Json curve = Json::array();
  for (const survey::photo::CurvePoint& point : result.curve) {
    curve.push_back({{"photos", point.photos},
                     {"expected_completeness", point.completeness},
                     {"satisfied", point.satisfied}});
  }
  return curve;
}

Json time_curve_json(const PhotoMission& mission) {
  Json curve = Json::array();
  for (const TimeCurvePoint& point : mission.time_curve) {
    curve.push_back({{"photos", point.photos},
                     {"tour_m", point.tour.length},
                     {"tour_s", point.tour.duration},
                     {"expected_completeness", point.completeness}});
  }
  return curve;
}

/// Returns a sentence about the positions at which the files trigger photos.
std::string trigger_text(const config::MissionSetup& setup) {
  if (!setup.flight().has_vehicle()) return "No vehicle: photos.csv lists the positions.";
  return setup.flight().style == flight::FlightStyle::pass
             ? "Photos on straight legs with even spacing are taken in flight, all others at stops."
             : "The vehicle stops at each photo; the route file triggers the camera.";
}

double storage_bytes(const survey::photo::PhotoPlan& plan) {
  return jpeg_bytes_per_pixel * plan.camera.width * plan.camera.height *
         static_cast<double>(plan.photos.size());
}

double blur_speed(const survey::photo::PhotoPlan& plan) {
  return 0.5 * plan.gsd / plan.camera.exposure;
}

Json capture_json(const config::MissionSetup& setup, const survey::photo::PhotoPlan& plan) {
  return {{"trigger", trigger_text(setup)},
          {"exposure_s", plan.camera.exposure},
          {"min_interval_s", plan.camera.min_interval},
          {"blur_speed_m_s", blur_speed(plan)},
          {"storage_bytes", storage_bytes(plan)}};
}

Json bound_json(const survey::photo::PhotoPlanResult& result) {
  if (result.bound.photos == 0) return {};
  return {{"photos", result.bound.photos},
          {"relaxed", result.bound.relaxed},
          {"gap",
           static_cast<double>(result.repaired_photos) / static_cast<double>(result.bound.photos) -
               1.0}};
}

Json photo_json(const config::MissionSetup& setup, const PhotoMission& mission) {
  const survey::photo::PhotoPlanResult& result = mission.result;
  return {
      {"camera", mission.plan.camera.name},
      {"gsd_m", mission.plan.gsd},
      {"view_distance_m", result.view_distance},
      {"photos", mission.plan.photos.size()},
      {"greedy_photos", result.greedy_photos},
      {"photos_after_search", result.repaired_photos},
      {"connecting_photos", result.connecting},
      {"candidates", result.candidates},
      {"area_m2",
       {{"surface", result.surface_area},
        {"exposed", result.exposed_area},
        {"attainable", result.exposed_area * result.figures.share(result.figures.attainable)}}},
      {"samples", {{"exposed", result.figures.samples}, {"attainable", result.figures.attainable}}},
      {"figures", figures_json(result.figures)},
      {"not_satisfied", missing_json(result)},
      {"bound", bound_json(result)},
      {"view_graph", graph_json(result.graph)},
      {"tour", tour_json(mission.tour)},
      {"patterns", patterns_json(mission)},
      {"curve", curve_json(result)},
      {"time_curve", time_curve_json(mission)},
      {"capture", capture_json(setup, mission.plan)}};
}

/// Returns the lines of sight between photos and control points.
Blocked make_sights(const config::MissionSetup& setup, const PhotoAirspace& airspace) {
  const survey::photo::PhotoSite site = photo_site(setup, airspace);
  geometry::Mesh all = site.target;
  append(all, site.surroundings);
  const auto sights = std::make_shared<const geometry::SightLines>(all, setup.run.threads);
  return [sights, ground = site.ground](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    constexpr double whole = 1.0, buried = 0.2;
    return to.z() < ground(to.head<2>()) - buried || !sights->is_clear(from, to, whole);
  };
}

/// Returns the settings of the camera for the field sheet.
package::SheetList camera_list(const survey::photo::PhotoPlan& plan) {
  const geometry::PhotoCameraConfig& camera = plan.camera;
  package::SheetList list{"Camera: " + camera.name, {}};
  list.items.push_back(
      fmt::format("Focus at {:.1f} m, then switch autofocus off; GSD {:.2f} mm at this distance",
                  plan.view_distance, 1e3 * plan.gsd));
  list.items.push_back(fmt::format(
      "Exposure time at most 1/{:.0f} s, shutter {}; fixed white "
      "balance; JPEG, without lens correction",
      1.0 / camera.exposure,
      camera.shutter == geometry::ShutterKind::mechanical ? "mechanical" : "electronic"));
  list.items.push_back(
      fmt::format("At least {:g} s between photos; motion blur of half a pixel at "
                  "{:.1f} m/s",
                  camera.min_interval, blur_speed(plan)));
  list.items.push_back(fmt::format("{} photos, about {:.1f} GB as JPEG", plan.photos.size(),
                                   1e-9 * storage_bytes(plan)));
  list.items.emplace_back("Overcast sky or high sun; no rain, no wet or moving surfaces");
  return list;
}

package::SheetList missing_list(const survey::photo::PhotoPlanResult& result) {
  package::SheetList list{"Expected gaps", {}};
  for (std::size_t i = 0; i < survey::photo::missing_reasons; ++i) {
    const double area = result.missing_area[i];
    if (area <= 0.0) continue;
    list.items.push_back(fmt::format("{:.1f} m² ({:.1f} %): {}", area,
                                     100.0 * area / result.exposed_area,
                                     describe(static_cast<survey::photo::MissingReason>(i))));
  }
  list.items.emplace_back("Windows, glass, water, thin wires, vegetation and plain walls");
  return list;
}

package::SheetList control_list(const PhotoMission& mission, const Blocked& is_blocked) {
  package::SheetList list{"Ground control points", {}};
  for (const ControlPoint& point : mission.control_points) {
    std::vector<ControlObservation> observations =
        find_observations(point, mission.plan, is_blocked);
    std::ranges::stable_sort(observations, {}, &ControlObservation::distance);
    constexpr std::size_t max_names = 4;
    std::string names;
    for (std::size_t i = 0; i < std::min(max_names, observations.size()); ++i) {
      names += (i == 0 ? ": " : ", ") + mission.plan.photos[observations[i].photo].name;
    }
    list.items.push_back(point.name + ", " + support::counted(observations.size(), "photo") +
                         names + (observations.size() > max_names ? ", ..." : ""));
  }
  return list;
}

void stage_field_sheet(const config::MissionSetup& setup, const PhotoMission& mission,
                       const std::vector<SurfaceSample>& samples, const Blocked& is_blocked,
                       geometry::OutputFolder& folder) {
  std::vector<Eigen::Vector3f> positions;
  std::vector<std::uint8_t> is_good;
  for (const SurfaceSample& sample : samples) {
    positions.push_back(sample.position);
    is_good.push_back(sample.quality == SurfaceClass::missing ? 0 : 1);
  }
  package::FieldSheetSite sheet{.mission = setup.name,
                                .sensor = mission.plan.camera.name,
                                .survey_coverage = mission.result.figures.completeness,
                                .coverage_of = "expected completeness of the exposed surface",
                                .surface = positions,
                                .is_covered = is_good,
                                .lists = {camera_list(mission.plan), missing_list(mission.result)}};
  if (!mission.control_points.empty()) sheet.lists.push_back(control_list(mission, is_blocked));
  sheet.warnings = mission.warnings;
  folder.write(package::field_sheet_name, field_sheet(sheet, setup.flight(), *mission.flight));
}

}  // namespace

void add_control_points(const config::MissionSetup& setup, const PhotoAirspace& airspace,
                        const std::filesystem::path& file, PhotoMission& mission) {
  const flight::FlightOptions& options = setup.flight();
  try {
    mission.control_points =
        read_control_points(geometry::read_file(file),
                            options.is_georeferenced ? std::optional(options.site) : std::nullopt);
  } catch (const Error& error) {
    const std::string what = error.what();
    throw Error(error.kind(), what.starts_with("line ") ? file.string() + ": " + what : what);
  }
  for (std::string& warning :
       control_warnings(mission.control_points, mission.plan, make_sights(setup, airspace))) {
    mission.warnings.push_back(std::move(warning));
  }
}

PoseSigmas pose_sigmas(const config::MissionSetup& setup) {
  const flight::FlightOptions& options = setup.flight();
  return {.position = options.has_vehicle() ? options.position_error : 0.0, .angle = angle_sigma};
}

void write_colmap_model(const config::MissionSetup& setup, const PhotoMission& mission,
                        const std::filesystem::path& folder) {
  photo::write_colmap(mission.plan, mission.pairs, pose_sigmas(setup), folder);
}

std::string summary_json(const config::MissionSetup& setup, const PhotoMission& mission) {
  Json summary{{"mission", setup.name},
               {"kind", "photos"},
               {"seed", setup.run.seed},
               {"version", version},
               {"complete", true},
               {"warnings", mission.warnings},
               {"views", mission.result.views.size()},
               {"photo", photo_json(setup, mission)}};
  if (mission.flight) {
    summary["route_length_m"] = mission.flight->route.length;
    summary["min_clearance_m"] = mission.flight->route.min_clearance;
    summary["flight"] = package::route_json(*mission.flight, mission.pad);
  }
  summary["settings"] = package::settings_json(setup);
  summary["per_view"] = Json::array();
  for (std::size_t i = 0; i < mission.result.views.size(); ++i) {
    const geometry::View& view = mission.result.views[i];
    summary["per_view"].push_back({{"view", i},
                                   {"position", to_json(view.position)},
                                   {"direction", to_json(view.direction)},
                                   {"observed_samples", mission.result.observed[i]},
                                   {"gsd_m", mission.result.gsd[i]}});
  }
  return support::json_text(summary);
}

void stage_photo_mission(const config::MissionSetup& setup, const PhotoAirspace& airspace,
                         PhotoMission& mission, geometry::OutputFolder& folder) {
  folder.replace([](std::string_view name) {
    return name == package::free_space_name || name == package::report_name ||
           name == surface_map_name || name == control_table_name ||
           name == package::field_sheet_name || name == package::fly_test_name ||
           name == package::profile_name || package::is_flight_file(name);
  });
  if (mission.flight) {
    std::ostringstream free_space;
    free_space.exceptions(std::ios::badbit);
    airspace.measured().write(free_space);
    folder.write(package::free_space_name, free_space.str());
    mission.flight->files = package::stage_flight(
        setup.name, setup.flight(), mission.flight->route, airspace.measured(),
        package::package_formats(setup.flight().required_vehicle()), folder);
    package::stage_profile(setup.flight(), mission.flight->route, airspace.measured(), folder);
  }
  const flight::FlightOptions& options = setup.flight();
  photo::stage_photo_tables(mission.plan,
                            options.is_georeferenced ? std::optional(options.site) : std::nullopt,
                            pose_sigmas(setup), folder);
  const std::vector<SurfaceSample> samples = evaluate_surface(setup, airspace, mission.plan);
  folder.write(surface_map_name, surface_table(samples));
  const Blocked is_blocked =
      mission.control_points.empty() ? Blocked() : make_sights(setup, airspace);
  if (!mission.control_points.empty()) {
    folder.write(control_table_name,
                 control_table(mission.control_points, mission.plan, is_blocked));
  }
  if (mission.flight) stage_field_sheet(setup, mission, samples, is_blocked, folder);
  folder.write(package::summary_name, summary_json(setup, mission));
}

}  // namespace skycap::missions::photo
