#include "missions/photo/photo_files.h"

#include <optional>
#include <sstream>

#include <nlohmann/json.hpp>

#include "flight/export/geodesy.h"
#include "geometry/angle.h"
#include "missions/config/mission_document.h"
#include "missions/package/flight_report.h"
#include "missions/package/package.h"
#include "missions/package/settings.h"
#include "missions/photos/colmap_model.h"
#include "missions/photos/photo_files.h"
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

Json bound_json(const survey::photo::PhotoPlanResult& result) {
  if (result.bound.photos == 0) return {};
  return {{"photos", result.bound.photos},
          {"relaxed", result.bound.relaxed},
          {"gap",
           static_cast<double>(result.repaired_photos) / static_cast<double>(result.bound.photos) -
               1.0}};
}

Json photo_json(const PhotoMission& mission) {
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
      {"curve", curve_json(result)}};
}

}  // namespace

photos::PoseSigmas pose_sigmas(const config::MissionSetup& setup) {
  const flight::FlightOptions& options = setup.flight();
  return {.position = options.has_vehicle() ? options.position_error : 0.0, .angle = angle_sigma};
}

void write_colmap_model(const config::MissionSetup& setup, const PhotoMission& mission,
                        const std::filesystem::path& folder) {
  photos::write_colmap(mission.plan, mission.pairs, pose_sigmas(setup), folder);
}

std::string summary_json(const config::MissionSetup& setup, const PhotoMission& mission) {
  Json summary{{"mission", setup.name},
               {"kind", "photos"},
               {"seed", setup.run.seed},
               {"version", version},
               {"complete", true},
               {"warnings", mission.warnings},
               {"views", mission.result.views.size()},
               {"photo", photo_json(mission)}};
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
           name == package::fly_test_name || package::is_flight_file(name);
  });
  if (mission.flight) {
    std::ostringstream free_space;
    free_space.exceptions(std::ios::badbit);
    airspace.measured().write(free_space);
    folder.write(package::free_space_name, free_space.str());
    mission.flight->files = package::stage_flight(
        setup.name, setup.flight(), mission.flight->route, airspace.measured(),
        package::package_formats(setup.flight().required_vehicle().autopilot), folder);
  }
  const flight::FlightOptions& options = setup.flight();
  photos::stage_photo_tables(mission.plan,
                             options.is_georeferenced ? std::optional(options.site) : std::nullopt,
                             pose_sigmas(setup), folder);
  folder.write(package::summary_name, summary_json(setup, mission));
}

}  // namespace skycap::missions::photo
