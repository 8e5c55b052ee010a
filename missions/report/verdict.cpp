#include "missions/report/verdict.h"

#include <algorithm>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "missions/session/survey_record.h"

namespace skycap::missions::report {
namespace {

using Json = nlohmann::ordered_json;

/// Thresholds of the coverage rating: complete and usable.
constexpr double good_coverage = 0.95, fair_coverage = 0.85;

Json to_json(const Light& light) {
  return {{"name", light.name}, {"figure", light.figure}, {"value", light.value},
          {"form", light.form}, {"light", light.light},   {"rule", light.rule}};
}

Json at(const Json& summary, const char* path) {
  const Json::json_pointer pointer(path);
  return summary.contains(pointer) ? summary[pointer] : Json();
}

Light coverage(const std::string& name, const std::string& figure, const Json& value) {
  const double share = value.get<double>();
  const char* light = share >= good_coverage ? "green" : share >= fair_coverage ? "amber" : "red";
  return {name,
          figure,
          "share",
          value,
          light,
          fmt::format("green: at least {:.0f}%, amber: at least {:.0f}%", 100.0 * good_coverage,
                      100.0 * fair_coverage)};
}

/// Of the route files that cover least.
void add_written_coverage(const Json& summary, std::vector<Light>& lights) {
  const Json written = at(summary, "/flight/written");
  if (!written.is_array() || written.empty()) return;
  std::size_t min = 0;
  const char* field = "coverage";
  for (std::size_t i = 0; i < written.size(); ++i) {
    if (written[i].value("coverage_visible", Json()).is_number()) field = "coverage_visible";
    if (written[i].at(field).get<double>() < written[min].at(field).get<double>()) min = i;
  }
  lights.push_back(coverage("Coverage of the route files (simulated re-flight)",
                            fmt::format("flight.written.{}.{}", min, field),
                            written[min].at(field)));
}

void add_coverage(const Json& summary, std::vector<Light>& lights) {
  add_written_coverage(summary, lights);
  if (const Json estimated = at(summary, "/estimate/estimated_coverage"); estimated.is_number()) {
    lights.push_back(
        coverage("Coverage (planner estimate)", "estimate.estimated_coverage", estimated));
  }
  if (const Json visible = at(summary, "/coverage_visible"); visible.is_number()) {
    lights.push_back(
        coverage("Coverage of visible surface (ground truth)", "coverage_visible", visible));
  } else if (const Json all = at(summary, "/coverage"); all.is_number()) {
    lights.push_back({"Coverage of the whole surface (ground truth)", "coverage", "share", all});
  }
}

/// Adds the unobserved part of the region of interest. Live surveys only: their estimated coverage
/// refers to the known surface, and surface in unobserved space is unknown.
void add_region(const Json& summary, std::vector<Light>& lights) {
  constexpr double much = 0.5;
  const Json predicted = at(summary, "/unseen_box_surface");
  if (!predicted.is_number()) return;
  lights.push_back({"Unobserved surface of planner.scene_box", "unseen_box_surface", "share",
                    predicted, predicted.get<double>() <= much ? "green" : "amber",
                    fmt::format("green: at most {:.0f}%, otherwise amber", 100.0 * much)});
}

void add_flight(const Json& summary, std::vector<Light>& lights) {
  const Json flight = at(summary, "/flight");
  if (!flight.is_object()) return;
  if (flight.contains("failure")) {
    lights.push_back(
        {"Flight", "flight.failure", "text", "no route", "red", "red: no verified route"});
    return;
  }
  const Json clearance = at(summary, "/flight/route/min_clearance_m");
  const Json asked = at(summary, "/flight/clearance_m/total");
  if (clearance.is_number() && asked.is_number()) {
    // Tolerance for rounding errors, because the terms are summed in floating point.
    const bool is_kept = clearance.get<double>() >= asked.get<double>() * (1.0 - 1e-9);
    lights.push_back({"Minimum clearance (verified)", "flight.route.min_clearance_m", "metres",
                      clearance, is_kept ? "green" : "red",
                      "green: at least the required clearance"});
  }
  if (const Json minutes = at(summary, "/flight/route/duration_s"); minutes.is_number()) {
    lights.push_back({"Flight", "flight.route.duration_s", "minutes", minutes});
  }
  double left = std::numeric_limits<double>::infinity();
  const Json sorties = at(summary, "/flight/route/sorties");
  for (const Json& sortie : sorties) left = std::min(left, sortie.value("energy_left_wh", 0.0));
  if (!sorties.empty()) {
    lights.push_back({"Sorties (one battery each)", "flight.route.sorties.length", "count",
                      sorties.size(), left >= 0.0 ? "green" : "red",
                      "green: every sortie keeps its battery reserve"});
  }
  const std::size_t missed = at(summary, "/flight/route/skipped_views").size();
  lights.push_back({"Views not in the mission", "flight.route.skipped_views.length", "count",
                    missed, missed == 0 ? "green" : "amber", "green: none, otherwise amber"});
}

}  // namespace

Json to_json(const Verdict& verdict) {
  Json lights = Json::array();
  for (const Light& light : verdict.lights) lights.push_back(to_json(light));
  return {{"answer", verdict.is_complete ? "complete" : "incomplete"},
          {"because", verdict.because},
          {"light", verdict.is_complete ? "green" : verdict.else_light},
          {"lights", lights}};
}

Json stop_words() {
  using enum survey::StopReason;
  return {{session::to_string(complete), "no remaining view adds enough coverage"},
          {session::to_string(view_limit), "view limit reached"},
          {session::to_string(distance_limit), "distance limit reached"},
          {session::to_string(time_limit), "time limit reached"},
          {session::to_string(nowhere_to_go), "no remaining view is reachable"},
          {session::to_string(interrupted), "interrupted"}};
}

Json verdict(const Json& summary) {
  const std::string stop = summary.value("stop_reason", std::string());
  const bool is_interrupted = stop == session::to_string(survey::StopReason::interrupted);
  Verdict verdict{.is_complete = at(summary, "/complete") == Json(true),
                  .because = stop_words().value(stop, stop),
                  .lights = {},
                  .else_light = is_interrupted ? "red" : "amber"};
  const Json missing = at(summary, "/estimate/missing/unreachable");
  if (stop == session::to_string(survey::StopReason::nowhere_to_go) && missing.is_number() &&
      missing.get<double>() > 0.0) {
    verdict.because += fmt::format("; estimate: {:.1f}% of the surface is unreachable",
                                   100.0 * missing.get<double>());
  }
  add_coverage(summary, verdict.lights);
  add_region(summary, verdict.lights);
  if (const Json views = at(summary, "/views"); views.is_number()) {
    verdict.lights.push_back({"Views", "views", "count", views});
  }
  add_flight(summary, verdict.lights);
  return to_json(verdict);
}

}  // namespace skycap::missions::report
