/// Contents of summary.json.

#include <algorithm>
#include <utility>

#include <nlohmann/json.hpp>

#include "missions/evaluation/reliability.h"
#include "missions/package/fleet_report.h"
#include "missions/package/flight_report.h"
#include "missions/package/ground_json.h"
#include "missions/package/holes.h"
#include "missions/package/package.h"
#include "missions/package/replanned_mission.h"
#include "missions/package/route_json.h"
#include "missions/package/settings.h"
#include "missions/package/surface_json.h"
#include "missions/package/target_coverage.h"
#include "missions/package/written_mission.h"
#include "missions/site_data/site_priors.h"
#include "missions/support/json_text.h"
#include "missions/version.h"

namespace skycap::missions::package {
namespace {

using support::to_json;
using Json = nlohmann::ordered_json;

Json to_json(const std::optional<double>& number) { return number ? Json(*number) : Json(); }

Json to_json(const std::vector<survey::PartTime>& times) {
  Json parts = Json::object();
  for (const auto& [part, seconds] : times) parts[part] = seconds;
  return parts;
}

/// Compares the planner's estimated coverage with the ground truth on the visible surface.
Json reliability_summary(const survey::surfel::SurveyEstimate& estimate,
                         const std::optional<TrueCoverage>& truth, double resolution_radius) {
  // Empty after an interruption or if it was not computed.
  if (!truth || truth->is_visible.empty()) return {};
  const double reach = 2.0 * resolution_radius;
  const evaluation::Reliability found = evaluation::reliability(
      estimate.patches, truth->samples, truth->is_covered, truth->is_visible, reach);
  Json bands = Json::array();
  for (const evaluation::Reliability::Band& band : found.bands) {
    bands.push_back(
        {{"estimated", band.estimated}, {"covered", band.covered}, {"share", band.share}});
  }
  return {{"error", found.error},
          {"bands", bands},
          {"unknown", {{"covered", found.unknown_covered}, {"share", found.unknown_share}}}};
}

/// Returns the planner's final estimate. Fractions refer to the observed and predicted surface.
Json estimate_summary(const session::SurveyRecord& record, const CoverageFigures& coverage,
                      double resolution_radius) {
  if (!record.estimate) return {};
  const survey::surfel::SurveyEstimate& estimate = *record.estimate;
  // Contains either the completion rule or the reason for an early end, so that there is only one
  // reason.
  const std::string stop =
      record.is_complete() ? record.stop_rule : session::to_string(record.stop_reason);
  return {{"stop", stop},
          {"estimated_coverage", estimate.coverage},
          {"area_m2", estimate.area},
          {"missing",
           {{"undersampled", estimate.seen_too_thinly},
            {"unobserved", estimate.never_seen},
            {"unreachable", estimate.unreachable}}},
          {"next_gain", estimate.next_gain},
          {"noise_m", estimate.noise},
          {"growing_noise", estimate.growing_noise},
          {"reliability", reliability_summary(estimate, coverage.truth, resolution_radius)}};
}

/// Lists the missing surface in connected pieces, from the planner's estimate or the ground truth.
Json surface_summary(const session::SurveyRecord& record, const CoverageFigures& coverage) {
  const auto patches = known_surface(record, coverage);
  if (patches.empty()) return {};
  return missing_json(missing_surface(patches, collect_views(record)),
                      record.estimate ? "planner" : "simulator");
}

/// Returns the numbers of a pattern's views and the positions that were not flown.
Json pattern_summary(const survey::PatternRecord& pattern) {
  Json dropped = Json::array();
  for (const geometry::View& view : pattern.dropped) {
    dropped.push_back(
        {{"position", to_json(view.position)}, {"direction", to_json(view.direction)}});
  }
  return {{"planned", pattern.planned},
          {"flown", pattern.flown},
          {"moved", pattern.moved},
          {"dropped", dropped}};
}

bool has_target(const scene::SceneOptions& scene) {
  return scene.priors &&
         std::ranges::any_of(scene.priors->sources, [](const site_data::Source& source) {
           return source.role == site_data::Role::target;
         });
}

/// Returns the data of the vehicle's return after link loss, low battery or a recall.
Json return_summary(const SurveyMission& flight) {
  if (!flight.route.returns) return {};
  const flight::Returns& returns = *flight.route.returns;
  return {{"height_m", returns.height},
          {"clearance_m", returns.clearance},
          {"nearest",
           {{"from", to_json(returns.nearest.from)},
            {"part", to_string(returns.nearest.segment.part)},
            {"obstacle", returns.obstacle}}},
          {"landings", to_json(returns.rtl_profile.landings)},
          {"energy_wh", returns.energy / 3600.0},
          {"parameters", flight.files.parameters}};
}

Json image_motion_summary(const SurveyMission& flight) {
  if (!flight.image_motion) return {};
  return {{"blur_px", flight.image_motion->blur_px},
          {"shear_px", flight.image_motion->shear_px},
          {"distance_m", flight.image_motion->distance}};
}

/// Returns the limit of an app that needs one waypoint per photo.
Json waypoint_limit_summary(const flight::Vehicle& vehicle) {
  if (!vehicle.needs_waypoint_per_photo()) return {};
  return {{"app", to_string(vehicle.app)}, {"max_waypoints", vehicle.max_waypoints}};
}

/// Returns the flight of the survey in metres, seconds and watt hours.
Json survey_flight_summary(const session::FlightRecord& flight_record) {
  return {{"length_m", flight_record.length()},
          {"duration_s", flight_record.time()},
          {"min_clearance_m", flight_record.min_clearance()},
          {"views_refused", flight_record.rejected},
          {"free_volume_m3", flight_record.measured->free_volume()}};
}

}  // namespace

Json route_json(const SurveyMission& flight, const Eigen::Vector3d& pad) {
  const flight::Route& route = flight.route;
  const flight::ClearanceBudget& clearance = route.options.clearance;
  Json files = Json::array();
  for (const FlightFile& file : flight.files.written) {
    files.push_back({{"name", file.name},
                     {"heights", file.heights},
                     {"min_clearance_m", file.min_clearance},
                     {"duration_s", file.duration}});
  }
  return {{"vehicle", route.vehicle.name},
          {"clearance_m",
           {{"total", clearance.total()},
            {"vehicle_radius", clearance.vehicle_radius},
            {"position_error", clearance.position_error},
            {"tracking_error", clearance.tracking_error},
            {"map_error", clearance.map_error},
            {"margin", clearance.margin}}},
          {"pad", to_json(pad)},
          {"route",
           {{"stations", route.capture_points.size()},
            {"order", order_json(route)},
            {"length_m", route.length},
            {"station_length_m", route.capture_leg_length},
            {"straight_length_m", route.straight_length},
            {"order_length_m", route.order_length},
            {"order_bound_m", route.order_bound},
            {"duration_s", route.duration},
            {"duration_bound_s", route.duration_bound},
            {"energy_wh", route.energy / 3600.0},
            {"min_clearance_m", route.min_clearance},
            {"sorties", sorties_json(route)},
            {"skipped_views", unreached_json(route.unreached)}}},
          {"waypoint_limit", waypoint_limit_summary(route.vehicle)},
          {"return", return_summary(flight)},
          {"pictures", image_motion_summary(flight)},
          {"files", files},
          {"notes", flight.files.notes}};
}

namespace {

/// The same with the survey's own flight, before the route.
Json flight_summary(const session::FlightRecord& flight_record, const SurveyMission& flight) {
  const Json route = route_json(flight, flight_record.pad);
  Json summary = Json::object();
  for (const auto& [key, value] : route.items()) {
    if (key == "route") summary["survey"] = survey_flight_summary(flight_record);
    summary[key] = value;
  }
  return summary;
}

Json view_summary(std::size_t number, const session::EvaluatedView& evaluated) {
  const survey::SurveyedView& view = evaluated.surveyed;
  return {{"view", number},
          {"position", to_json(view.view.position)},
          {"direction", to_json(view.view.direction)},
          {"en_route_frames", view.en_route.views.size()},
          {"returns", view.returns},
          {"points_new", view.step.points_new},
          {"points", view.points},
          {"frontiers", view.step.frontiers},
          {"coverage", evaluated.coverage},
          {"planning_time_s", view.planning_time},
          {"planning_time_parts_s", to_json(view.step.times)},
          {"sensing_time_s", view.sensing_time},
          {"distance_m", view.distance}};
}

}  // namespace

std::vector<survey::PartTime> planning_time_by_part(const session::SurveyRecord& record) {
  std::vector<survey::PartTime> sums;
  for (const session::EvaluatedView& evaluated : record.views) {
    for (const auto& [part, seconds] : evaluated.surveyed.step.times) {
      const auto sum = std::ranges::find(sums, part, &survey::PartTime::part);
      if (sum == sums.end()) {
        sums.push_back({part, seconds});
      } else {
        sum->seconds += seconds;
      }
    }
  }
  return sums;
}

std::string summary_json(const config::MissionSetup& setup, const session::SurveyRecord& record,
                         const CoverageFigures& coverage,
                         const std::optional<SurveyMission>& flight) {
  Json summary{
      {"mission", setup.name},
      {"planner", setup.text("planner.name")},
      {"preset", setup.text("planner.preset")},
      {"seed", record.seed},
      {"threads", record.threads},
      {"version", version},
      {"complete", record.is_complete()},
      {"stop_reason", session::to_string(record.stop_reason)},
      {"views", record.views.size()},
      {"points", record.cloud.size()},
      {"coverage", coverage.all},
      {"coverage_visible", to_json(coverage.visible)},
      {"attainable_coverage", to_json(coverage.attainable_coverage)},
      {"planning_time_s", record.planning_time()},
      {"planning_time_parts_s", to_json(planning_time_by_part(record))},
      {"sensing_time_s", record.sensing_time()},
      {"distance_m", record.distance()},
      {"estimate", estimate_summary(record, coverage, setup.survey().planner.resolution_radius)},
      {"surface", surface_summary(record, coverage)}};
  if (record.pattern) summary["pattern"] = pattern_summary(*record.pattern);
  if (has_target(setup.scene())) {
    summary["targets"] = targets_json(target_coverage(
        setup.scene(), setup.evaluation().registration_distance, record.cloud.positions));
  }
  if (flight && flight->failure.empty()) {
    summary["route_length_m"] = flight->route.length;
    summary["min_clearance_m"] = flight->route.min_clearance;
    summary["flight"] = flight_summary(*record.flight_record, *flight);
    if (flight->replanned) summary["flight"]["replanned"] = replanned_json(*flight->replanned);
    if (flight->written) summary["flight"]["written"] = written_json(*flight->written);
    if (flight->fleet) {
      summary["flight"]["fleet"] =
          fleet_json(*flight->fleet, setup.text("flight.fleet_goal"), setup.flight().fleet.rule());
    }
  } else if (flight) {
    summary["flight"] = {{"pad", to_json(record.flight_record->pad)},
                         {"survey", survey_flight_summary(*record.flight_record)},
                         {"failure", flight->failure}};
  }
  if (flight) {
    const session::FlightRecord& flight_record = *record.flight_record;
    summary["flight"]["grounds"] = landing_surfaces_json(
        setup.flight().landing_surfaces(flight_record.pad, flight_record.landing_surfaces));
  }
  summary["settings"] = settings_json(setup);
  summary["per_view"] = Json::array();
  for (std::size_t i = 0; i < record.views.size(); ++i) {
    summary["per_view"].push_back(view_summary(i, record.views[i]));
    if (record.flight_record)
      summary["per_view"].back()["way"] = to_json(record.flight_record->legs[i].points);
  }
  return support::json_text(summary);
}

}  // namespace skycap::missions::package
