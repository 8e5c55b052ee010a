#include "missions/batch/district/district_results.h"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "missions/package/route_json.h"
#include "missions/support/json_text.h"
#include "missions/support/number_text.h"
#include "missions/version.h"

namespace skycap::missions::batch {
namespace {

using support::to_json;
using Json = nlohmann::ordered_json;

/// Visited and omitted views of a target in the joint flight.
struct VisitedViews {
  std::size_t visited = 0;
  std::map<std::string, std::size_t> skip_reason;  ///< number of views by reason

  /// Returns the number of omitted views and their most frequent reason; ties are resolved
  /// alphabetically. Empty if all views are visited.
  std::string reason() const {
    std::size_t all = 0;
    for (const auto& [reason, views] : skip_reason) all += views;
    const auto max =
        std::ranges::max_element(skip_reason, {}, [](const auto& one) { return one.second; });
    if (max == skip_reason.end()) return "";
    std::string text = support::counted(all, "view");
    if (max->second < all) text += fmt::format("; {} of them", max->second);
    return text + ": " + max->first;
  }
};

std::vector<VisitedViews> visited_views(std::span<const SurveyedTarget> targets,
                                        const DistrictFlight& flight) {
  std::vector<VisitedViews> views(targets.size());
  for (const DistrictCapturePoint& capture_point : flight.capture_points) {
    if (capture_point.skip_reason.empty()) {
      ++views[capture_point.target].visited;
    } else {
      ++views[capture_point.target].skip_reason[capture_point.skip_reason];
    }
  }
  return views;
}

Json outlines_json(const std::vector<Ring>& rings) {
  Json list = Json::array();
  for (const Ring& ring : rings) {
    Json& footprint = list.emplace_back(Json::array());
    for (const Eigen::Vector2d& position : ring) footprint.push_back({position.x(), position.y()});
  }
  return list;
}

Json survey_json(const SurveyFigures& figures, const std::filesystem::path& out) {
  return {{"folder", figures.folder.lexically_proximate(out).generic_string()},
          {"stop_reason", figures.stop_reason},
          {"views", figures.views},
          {"coverage", figures.coverage},
          {"coverage_visible", figures.coverage_visible ? Json(*figures.coverage_visible) : Json()},
          {"planning_time_s", figures.planning_time},
          {"alone_duration_s", figures.time},
          {"alone_length_m", figures.length},
          {"wall_time_s", figures.wall_time},
          {"peak_memory_bytes", figures.peak_memory},
          {"file_bytes", figures.file_bytes}};
}

Json target_json(const SurveyedTarget& one, const VisitedViews& views,
                 const std::filesystem::path& out) {
  const DistrictTarget& target = one.target;
  return {{"title", target.title},
          {"ids", target.ids},
          {"survey", one.figures ? survey_json(*one.figures, out) : Json()},
          {"why_none", one.failure_reason},
          {"views_flown", views.visited},
          {"why_not_flown", views.reason()},
          {"height_m", target.box.sizes().z()},
          {"outlines", outlines_json(target.outlines)},
          {"pad", to_json(target.pad)}};
}

Json files_json(const package::FlightFiles& files) {
  Json list = Json::array();
  for (const package::FlightFile& file : files.written) {
    list.push_back({{"name", std::string(flights_folder) + "/" + file.name},
                    {"sortie", file.sortie},
                    {"heights", file.heights},
                    {"min_clearance_m", file.min_clearance},
                    {"duration_s", file.duration}});
  }
  return list;
}

Json pad_json(const PadFlight& pad) {
  const flight::Route& route = pad.route;
  Json json{{"pad", pad.pad},
            {"position", to_json(route.options.takeoff)},
            {"stations", route.capture_points.size()},
            {"length_m", route.length},
            {"duration_s", route.duration},
            {"energy_wh", route.energy / 3600.0},
            {"min_clearance_m", route.min_clearance},
            {"return", Json()},
            {"sorties", package::sorties_json(route)},
            {"files", files_json(pad.files)},
            {"parameters", pad.files.parameters}};
  if (route.returns) {
    json["return"] = {{"height_m", route.returns->height},
                      {"clearance_m", route.returns->clearance}};
  }
  return json;
}

double min_clearance(const DistrictFlight& flight) {
  double min = std::numeric_limits<double>::infinity();
  for (const PadFlight& pad : flight.pads) min = std::min(min, pad.route.min_clearance);
  return min;
}

std::size_t visited(const DistrictFlight& flight) {
  return static_cast<std::size_t>(
      std::ranges::count(flight.capture_points, std::string(), &DistrictCapturePoint::skip_reason));
}

Json flight_json(const DistrictFlight& flight) {
  if (flight.pads.empty()) return {};
  Json pads = Json::array(), capture_points = Json::array();
  for (const PadFlight& pad : flight.pads) pads.push_back(pad_json(pad));
  for (const DistrictCapturePoint& capture_point : flight.capture_points) {
    capture_points.push_back({capture_point.target, capture_point.view, capture_point.skip_reason});
  }
  return {{"vehicle", flight.pads[0].route.vehicle.name},
          {"views", flight.capture_points.size()},
          {"views_flown", visited(flight)},
          {"sorties", flight.sorties()},
          {"length_m", flight.length()},
          {"duration_s", flight.duration()},
          {"clearance_m", flight.pads[0].route.clearance},
          {"min_clearance_m", min_clearance(flight)},
          {"pads", pads},
          {"stations", capture_points},
          {"notes", flight.notes}};
}

/// Quotes a CSV field if it contains a separator, quote or line feed.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string number_or_none(bool is_there, double number) {
  return is_there ? support::exact_text(number) : "";
}

}  // namespace

std::string results_json(const DistrictFile& district, const DistrictPlan& district_plan,
                         std::span<const SurveyedTarget> targets, const DistrictFlight& flight,
                         const std::filesystem::path& out) {
  const std::vector<VisitedViews> views = visited_views(targets, flight);
  const auto surveyed = std::ranges::count_if(
      targets, [](const SurveyedTarget& target) { return target.figures.has_value(); });
  Json json{{"district", district.name},
            {"version", version},
            {"map", district.request.map.filename().string()},
            {"planner", district.planner},
            {"seed", district.seed},
            {"vehicle", district.request.vehicle},
            {"surveyed", surveyed},
            {"complete", surveyed == std::ssize(targets)},
            {"pads", to_json(district_plan.pads)},
            {"targets", Json::array()}};
  for (std::size_t i = 0; i < targets.size(); ++i) {
    json["targets"].push_back(target_json(targets[i], views[i], out));
  }
  json["flight"] = flight_json(flight);
  json["neighbours"] = outlines_json(district_plan.neighbours);
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string targets_csv(std::span<const SurveyedTarget> targets, const DistrictFlight& flight) {
  const std::vector<VisitedViews> views = visited_views(targets, flight);
  std::string csv =
      "title,things,views,coverage,coverage_visible,alone_duration_s,alone_length_m,views_flown,"
      "remark\n";
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const SurveyedTarget& one = targets[i];
    const bool is_there = one.figures.has_value();
    const SurveyFigures figures = one.figures.value_or(SurveyFigures());
    csv += fmt::format(
        "{},{},{},{},{},{},{},{},{}\n", field(one.target.title), one.target.ids.size(),
        figures.views, number_or_none(is_there, figures.coverage),
        number_or_none(figures.coverage_visible.has_value(), figures.coverage_visible.value_or(0)),
        number_or_none(is_there, figures.time), number_or_none(is_there, figures.length),
        views[i].visited, field(is_there ? views[i].reason() : one.failure_reason));
  }
  return csv;
}

std::string results_text(std::span<const SurveyedTarget> targets, const DistrictFlight& flight) {
  std::size_t surveyed = 0, views = 0;
  double planning = 0.0, alone = 0.0, coverage = 0.0;
  for (const SurveyedTarget& one : targets) {
    if (!one.figures) continue;
    ++surveyed;
    views += one.figures->views;
    planning += one.figures->planning_time;
    alone += one.figures->time;
    coverage += one.figures->coverage;
  }
  std::string text = fmt::format("  targets   {} of {} surveyed", surveyed, targets.size());
  if (surveyed > 0) {
    text += fmt::format(", {} views, mean coverage {:.2f}%\n  planning  {:.3f} s per view", views,
                        100.0 * coverage / static_cast<double>(surveyed),
                        planning / std::max<double>(1.0, static_cast<double>(views)));
  }
  if (!flight.pads.empty()) {
    text += fmt::format(
        "\n  flight    {} of {} views, {:.1f} m in {:.1f} min, {} from {}; each target separately "
        "{:.1f} min\n  clearance required {:.2f} m, minimum {:.2f} m, verified for every leg",
        visited(flight), flight.capture_points.size(), flight.length(), flight.duration() / 60.0,
        support::counted(flight.sorties(), "sortie"), support::counted(flight.pads.size(), "pad"),
        alone / 60.0, flight.pads[0].route.clearance, min_clearance(flight));
  }
  return text + "\n";
}

}  // namespace skycap::missions::batch
