#include "missions/package/anew_mission.h"

#include <utility>

#include <fmt/format.h>

#include "flight/space/clearance.h"
#include "geometry/place/world.h"
#include "missions/evaluation/coverage.h"
#include "missions/package/package.h"
#include "missions/session/way_frames.h"
#include "missions/support/json_text.h"

namespace skycap::missions::package {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const MissionFigures& figures) {
  return {{"duration_s", figures.duration},
          {"length_m", figures.length},
          {"views", figures.views},
          {"pieces", figures.pieces},
          {"predicted_coverage", figures.promised}};
}

Json stations_json(const StationPlan& stations) {
  Json list = Json::array();
  for (std::size_t i = 0; i < stations.views.size(); ++i) {
    list.push_back({{"position", support::json_of(stations.views[i].position)},
                    {"direction", support::json_of(stations.views[i].direction)},
                    {"way", support::json_of(stations.ways[i])}});
  }
  return list;
}

std::string figures_text(const MissionFigures& figures) {
  return fmt::format("{} views, {} segments, {:.0f} m, {:.0f} s", figures.views, figures.pieces,
                     figures.length, figures.duration);
}

std::string percent(double share) { return fmt::format("{:.2f}%", 100.0 * share); }

/// Returns the survey's views and the views of its en-route frames.
std::vector<geometry::View> all_views_of(const session::SurveyRecord& record) {
  std::vector<geometry::View> views;
  for (const session::JudgedView& judged : record.views) {
    const survey::SurveyedView& taken = judged.surveyed;
    views.insert(views.end(), taken.on_way.views.begin(), taken.on_way.views.end());
    views.push_back(taken.view);
  }
  return views;
}

}  // namespace

FlownAgain flown_again(const CoverageFigures& coverage,
                       const std::vector<session::ViewInFlight>& views) {
  const simulation::CoveredAgain covered = coverage.fly_again(views);
  FlownAgain again{evaluation::marked_share(covered.stored), {}, {}};
  if (coverage.truth && !coverage.truth->is_visible.empty()) {
    again.visible = evaluation::covered_share(covered.stored, coverage.truth->is_visible);
    again.visible_unthinned =
        evaluation::covered_share(covered.measured, coverage.truth->is_visible);
  }
  return again;
}

Json again_json(const FlownAgain& again) {
  return {{"coverage", again.all},
          {"coverage_visible", again.visible ? Json(*again.visible) : Json()},
          {"coverage_visible_unthinned",
           again.visible_unthinned ? Json(*again.visible_unthinned) : Json()}};
}

std::string again_text(const FlownAgain& again) {
  std::string text = "simulated re-flight " + percent(again.all) + " of the surface";
  if (again.visible) text += ", " + percent(*again.visible) + " of the visible surface";
  if (again.visible_unthinned && again.visible_unthinned != again.visible) {
    text += " (" + percent(*again.visible_unthinned) + " if all points are kept)";
  }
  return text;
}

ChoiceOptions choice_options(const sim::SurveySensorOptions& sensor,
                             const session::RunOptions& run) {
  ChoiceOptions choice{.search = {.seed = run.seed}, .threads = run.threads};
  if (sensor.scans_in_flight()) choice.scanner = kind_of(*sensor.scanner);
  return choice;
}

AnewMission anew_mission(const session::SurveyOptions& options, const ChoiceOptions& choice,
                         const session::SurveyRecord& record, const CoverageFigures& coverage,
                         flight::Route present, const std::stop_token& stop) {
  const session::FlownSurvey& flown = *record.flown;
  const flight::KnownSpace rules(options.flight.rules());
  const flight::JointSpace space({flown.measured.get(), &rules});
  const auto plan = [&](const StationPlan& stations) {
    return plan_flight(in_given_order(options.flight), *flown.measured, flown.pad, stations.views,
                       stations.ways, flown.grounds, stop);
  };
  const std::vector<session::ViewInFlight> surveyed =
      session::measured_views(options.flight, present);
  AnewMission result{choose_mission(options.flight, options.planner, choice, *record.surface, space,
                                    all_views_of(record), std::move(present), plan, stop),
                     {},
                     {}};
  if (coverage.fly_again && result.choice.is_anew) {
    result.survey_again = flown_again(coverage, surveyed);
  }
  if (coverage.fly_again) {
    result.again =
        flown_again(coverage, session::measured_views(options.flight, result.choice.route));
  }
  return result;
}

Json anew_json(const AnewMission& mission) {
  Json json{{"is_flown", mission.choice.is_anew},
            {"survey", json_of(mission.choice.survey)},
            {"replanned", json_of(mission.choice.anew)},
            {"computing_time_s", mission.choice.computing}};
  if (mission.again) json["reflight"] = again_json(*mission.again);
  if (mission.survey_again) json["survey_reflight"] = again_json(*mission.survey_again);
  if (mission.choice.is_anew) json["stations"] = stations_json(mission.choice.stations);
  return json;
}

std::optional<StationPlan> anew_stations(const Json& json, const std::string& name) {
  if (!json.contains("stations")) return std::nullopt;
  StationPlan plan;
  for (const Json& station : json["stations"]) {
    const std::string place =
        name + ": flight.replanned.stations[" + std::to_string(plan.views.size()) + "].";
    plan.views.push_back(
        {support::vector_of(station.at("position")), support::vector_of(station.at("direction"))});
    geometry::require_place(plan.views.back().position, place + "position");
    geometry::require_direction(plan.views.back().direction, place + "direction");
    plan.ways.emplace_back();
    for (const Json& point : station.at("way")) {
      plan.ways.back().push_back(support::vector_of(point));
      geometry::require_place(plan.ways.back().back(), place + "way");
    }
  }
  return plan;
}

std::string anew_text(const AnewMission& mission) {
  const package::MissionChoice& choice = mission.choice;
  std::string text = choice.is_anew ? "  replanned " + figures_text(choice.anew) +
                                          "; survey views: " + figures_text(choice.survey)
                                    : "  replanned no faster plan found than the survey views: " +
                                          figures_text(choice.survey);
  text += "\n  coverage  " + percent(choice.anew.promised) +
          " predicted of the measured surface, survey views " + percent(choice.survey.promised);
  if (mission.again) text += "; " + again_text(*mission.again);
  if (mission.survey_again) text += "; survey views: " + again_text(*mission.survey_again);
  return text + "\n";
}

}  // namespace skycap::missions::package
