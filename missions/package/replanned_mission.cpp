#include "missions/package/replanned_mission.h"

#include <utility>

#include <fmt/format.h>

#include "flight/clearance/clearance.h"
#include "geometry/pose/world.h"
#include "missions/evaluation/coverage.h"
#include "missions/package/package.h"
#include "missions/session/en_route_frames.h"
#include "missions/support/json_text.h"

namespace skycap::missions::package {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const MissionFigures& figures) {
  return {{"duration_s", figures.duration},
          {"length_m", figures.length},
          {"views", figures.views},
          {"pieces", figures.segments},
          {"predicted_coverage", figures.predicted_coverage},
          {"predicted_reflight",
           figures.predicted_reflight ? Json(*figures.predicted_reflight) : Json()}};
}

Json capture_points_json(const CapturePlan& capture_points) {
  Json list = Json::array();
  for (std::size_t i = 0; i < capture_points.views.size(); ++i) {
    list.push_back({{"position", support::to_json(capture_points.views[i].position)},
                    {"direction", support::to_json(capture_points.views[i].direction)},
                    {"way", support::to_json(capture_points.paths[i])}});
  }
  return list;
}

std::string figures_text(const MissionFigures& figures) {
  return fmt::format("{} views, {} segments, {:.0f} m, {:.0f} s", figures.views, figures.segments,
                     figures.length, figures.duration);
}

std::string variant_text(const MissionFigures& figures) {
  std::string text =
      figures_text(figures) + fmt::format(", {:.2f}% of the measured surface predicted",
                                          100.0 * figures.predicted_coverage);
  if (figures.predicted_reflight) {
    text += fmt::format(", {:.2f}% of its points in a predicted re-flight",
                        100.0 * *figures.predicted_reflight);
  }
  return text;
}

std::string percent(double share) { return fmt::format("{:.2f}%", 100.0 * share); }

/// Returns the survey's views and the views of its en-route frames.
std::vector<geometry::View> collect_all_views(const session::SurveyRecord& record) {
  std::vector<geometry::View> views;
  for (const session::EvaluatedView& evaluated : record.views) {
    const survey::SurveyedView& surveyed_view = evaluated.surveyed;
    views.insert(views.end(), surveyed_view.en_route.views.begin(),
                 surveyed_view.en_route.views.end());
    views.push_back(surveyed_view.view);
  }
  return views;
}

}  // namespace

ReflightCoverage simulate_reflight(const CoverageFigures& coverage,
                                   const std::vector<session::ViewInFlight>& views) {
  return simulate_reflight(coverage, coverage.fly_again(views, {}, {}));
}

ReflightCoverage simulate_reflight(const CoverageFigures& coverage,
                                   const simulation::CoveredAgain& covered) {
  ReflightCoverage again{evaluation::marked_share(covered.stored), {}, {}};
  if (coverage.truth && !coverage.truth->is_visible.empty()) {
    again.visible = evaluation::covered_share(covered.stored, coverage.truth->is_visible);
    again.visible_before_downsampling =
        evaluation::covered_share(covered.measured, coverage.truth->is_visible);
  }
  return again;
}

Json again_json(const ReflightCoverage& again) {
  return {{"coverage", again.all},
          {"coverage_visible", again.visible ? Json(*again.visible) : Json()},
          {"coverage_visible_unthinned",
           again.visible_before_downsampling ? Json(*again.visible_before_downsampling) : Json()}};
}

std::string again_text(const ReflightCoverage& again) {
  std::string text = "simulated re-flight " + percent(again.all) + " of the surface";
  if (again.visible) text += ", " + percent(*again.visible) + " of the visible surface";
  if (again.visible_before_downsampling && again.visible_before_downsampling != again.visible) {
    text += " (" + percent(*again.visible_before_downsampling) + " if all points are kept)";
  }
  return text;
}

ChoiceOptions choice_options(const sim::SurveySensorOptions& sensor,
                             const session::RunOptions& run) {
  ChoiceOptions choice{.search = {.seed = run.seed}, .threads = run.threads};
  if (sensor.scans_in_flight()) choice.scanner = find_scanner_kind(*sensor.scanner);
  return choice;
}

ReplannedMission replan_mission(const session::SurveyOptions& options, const ChoiceOptions& choice,
                                const session::SurveyRecord& record,
                                const CoverageFigures& coverage, flight::Route present,
                                const std::stop_token& stop) {
  const session::FlightRecord& flight_record = *record.flight_record;
  const flight::KnownSpace rules(options.flight.rules());
  const flight::JointSpace space({flight_record.measured.get(), &rules});
  const auto plan = [&](const CapturePlan& capture_points) {
    return plan_flight(with_fixed_order(options.flight), *flight_record.measured, flight_record.pad,
                       capture_points.views, capture_points.paths, flight_record.landing_surfaces,
                       stop);
  };
  const std::vector<session::ViewInFlight> surveyed =
      session::measured_views(options.flight, present);
  ReplannedMission result{
      choose_mission(options.flight, options.planner, choice, *record.surface, space,
                     collect_all_views(record), std::move(present), plan, stop),
      {},
      {}};
  // The default mission is evaluated with its files (written_mission.h).
  if (!coverage.fly_again || choice.keeps_reflight || stop.stop_requested()) return result;
  if (result.choice.is_replanned) result.survey_again = simulate_reflight(coverage, surveyed);
  result.again =
      simulate_reflight(coverage, session::measured_views(options.flight, result.choice.route));
  return result;
}

Json replanned_json(const ReplannedMission& mission) {
  Json json{
      {"is_flown", mission.choice.is_replanned},
      {"reason", mission.choice.reason},
      {"survey", to_json(mission.choice.survey)},
      {"replanned", to_json(mission.choice.replanned)},
      {"fly_through_duration_s",
       mission.choice.fly_through_duration ? Json(*mission.choice.fly_through_duration) : Json()},
      {"computing_time_s", mission.choice.computing}};
  if (mission.again) json["reflight"] = again_json(*mission.again);
  if (mission.survey_again) json["survey_reflight"] = again_json(*mission.survey_again);
  if (mission.choice.is_replanned)
    json["stations"] = capture_points_json(mission.choice.capture_points);
  return json;
}

std::optional<CapturePlan> replanned_capture_points(const Json& json, const std::string& name) {
  if (!json.contains("stations")) return std::nullopt;
  CapturePlan plan;
  for (const Json& capture_point : json["stations"]) {
    const std::string location =
        name + ": flight.replanned.stations[" + std::to_string(plan.views.size()) + "].";
    plan.views.push_back({support::to_vector(capture_point.at("position")),
                          support::to_vector(capture_point.at("direction"))});
    geometry::require_valid_position(plan.views.back().position, location + "position");
    geometry::require_direction(plan.views.back().direction, location + "direction");
    plan.paths.emplace_back();
    for (const Json& point : capture_point.at("way")) {
      plan.paths.back().push_back(support::to_vector(point));
      geometry::require_valid_position(plan.paths.back().back(), location + "way");
    }
  }
  return plan;
}

std::string replanned_text(const ReplannedMission& mission) {
  const package::MissionChoice& choice = mission.choice;
  std::string text = fmt::format("  written   {} views: {}\n",
                                 choice.is_replanned ? "replanned" : "survey", choice.reason);
  text += "            survey: " + variant_text(choice.survey) + "\n";
  if (choice.replanned.duration != choice.survey.duration) {
    text += "            replanned: " + variant_text(choice.replanned) + "\n";
  }
  if (choice.fly_through_duration) {
    text += fmt::format(
        "  passing   {:.0f} s if flown through without stops; not in the autopilot's file, which "
        "cannot contain the curve; set flight.style: fly-through\n",
        *choice.fly_through_duration);
  }
  if (mission.again) text += "  coverage  " + again_text(*mission.again);
  if (mission.survey_again) text += "; survey views: " + again_text(*mission.survey_again);
  return mission.again ? text + "\n" : text;
}

}  // namespace skycap::missions::package
