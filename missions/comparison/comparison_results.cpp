#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/angle.h"
#include "missions/comparison/flight_comparison.h"
#include "missions/package/flight_report.h"
#include "missions/package/replanned_mission.h"
#include "missions/package/route_json.h"
#include "missions/package/settings.h"
#include "missions/package/surface_json.h"
#include "missions/support/json_text.h"
#include "missions/support/number_text.h"
#include "missions/version.h"

namespace skycap::missions::comparison {
namespace {

using Json = nlohmann::ordered_json;
using support::to_json;

double compute_length(const flight::PlannedLeg& leg) {
  double length = 0.0;
  for (std::size_t i = 1; i < leg.points.size(); ++i) {
    length += (leg.points[i] - leg.points[i - 1]).norm();
  }
  return length;
}

double planned_duration(const FlightComparison& comparison) {
  double duration = 0.0;
  for (const flight::PlannedLeg& leg : comparison.plan.legs) duration += leg.duration;
  return duration;
}

/// Returns the number, or null if it is unspecified.
Json number_json(double number) { return std::isfinite(number) ? Json(number) : Json(); }

/// Returns positions, rounded to centimetres.
Json points_json(const std::vector<Eigen::Vector3d>& points) {
  Json json = Json::array();
  for (const Eigen::Vector3d& point : points) {
    json.push_back(to_json(Eigen::Vector3d((100.0 * point).array().round() / 100.0)));
  }
  return json;
}

/// Returns the flown track in up to 3000 states. Each part ends at a gap in the log.
Json track_json(const FlightComparison& comparison) {
  constexpr std::size_t max_states = 3000;
  const std::vector<flight::TrackState>& states = comparison.track.states;
  const std::size_t step = (states.size() + max_states - 1) / max_states;
  Json parts = Json::array();
  std::vector<Eigen::Vector3d> points;
  std::vector<double> times;
  Json distances = Json::array();
  const auto end_part = [&] {
    parts.push_back({{"times_s", times}, {"points", points_json(points)}});
    if (!distances.empty()) parts.back()["distances_m"] = std::exchange(distances, Json::array());
    points.clear();
    times.clear();
  };
  for (std::size_t i = 0; i < states.size(); ++i) {
    const bool is_last =
        i + 1 == states.size() || states[i + 1].time - states[i].time > flight::min_log_gap;
    if (i % step != 0 && !is_last && !points.empty()) continue;
    points.push_back(states[i].position);
    times.push_back(states[i].time - states.front().time);
    if (!comparison.distances.empty()) distances.push_back(number_json(comparison.distances[i]));
    if (is_last) end_part();
  }
  return parts;
}

Json legs_json(const FlightComparison& comparison) {
  Json legs = Json::array();
  const double takeoff = comparison.track.states.front().time;
  for (std::size_t i = 0; i < comparison.plan.legs.size(); ++i) {
    const flight::PlannedLeg& planned = comparison.plan.legs[i];
    const flight::LegComparison& leg = comparison.route.legs[i];
    Json json{{"from", planned.from},
              {"to", planned.to},
              {"length_m", compute_length(planned)},
              {"points", points_json(planned.points)},
              {"planned_s", planned.duration},
              {"flown", leg.is_flown},
              {"flown_fraction", leg.flown_fraction}};
    json["begin_s"] = leg.is_flown ? Json(leg.begin - takeoff) : Json();
    json["duration_s"] = leg.is_flown ? Json(leg.duration) : Json();
    json["max_error_m"] = leg.is_flown ? Json(leg.max_error) : Json();
    json["mean_error_m"] = leg.is_flown ? Json(leg.mean_error) : Json();
    legs.push_back(std::move(json));
  }
  return legs;
}

Json captures_json(const FlightComparison& comparison) {
  Json list = Json::array();
  const double takeoff = comparison.track.states.front().time;
  for (std::size_t i = 0; i < comparison.plan.captures.size(); ++i) {
    const flight::PlannedCapture& planned = comparison.plan.captures[i];
    const flight::CaptureComparison& capture = comparison.route.captures[i];
    Json json{{"item", planned.item},
              {"planned_position", to_json(planned.position)},
              {"planned_yaw_deg", number_json(planned.yaw_deg)},
              {"planned_pitch_deg", number_json(planned.pitch_deg)},
              {"made", capture.is_made},
              {"missed", static_cast<bool>(comparison.is_missed[i])}};
    if (capture.is_made) {
      json["time_s"] = capture.state.time - takeoff;
      json["position"] = to_json(capture.state.position);
      json["yaw_deg"] = number_json(capture.state.camera_yaw_deg);
      json["pitch_deg"] = number_json(capture.state.camera_pitch_deg);
      json["error_m"] = capture.error;
      json["turned_deg"] =
          capture.turned ? Json(*capture.turned / geometry::radians_per_degree) : Json();
    }
    list.push_back(std::move(json));
  }
  Json others = Json::array();
  for (const flight::TrackState& state : comparison.route.other_captures) {
    others.push_back({{"time_s", state.time - takeoff},
                      {"position", to_json(state.position)},
                      {"yaw_deg", state.camera_yaw_deg},
                      {"pitch_deg", state.camera_pitch_deg}});
  }
  return {{"source", comparison.route.are_captures_assumed ? "assumed" : "log"},
          {"planned", comparison.plan.captures.size()},
          {"missed", comparison.num_missed_captures()},
          {"other", comparison.route.num_other_captures},
          {"mean_offset_m", to_json(comparison.route.mean_offset)},
          {"list", list},
          {"unplanned", others}};
}

Json coverage_json(const ComparedCoverage& coverage) {
  return {{"planned", coverage.planned ? package::again_json(*coverage.planned) : Json()},
          {"flown", package::again_json(coverage.flown)},
          {"patched", coverage.patched ? package::again_json(*coverage.patched) : Json()},
          {"surface", package::missing_json(coverage.missing, "simulator")}};
}

Json photos_json(const ComparedPhotos& photos) {
  const auto figures = [](const survey::photo::PhotoFigures& set) {
    return Json{{"photos", set.photos},
                {"expected_completeness", set.completeness},
                {"satisfied", set.share(set.satisfied)}};
  };
  return {{"planned", photos.planned ? figures(*photos.planned) : Json()},
          {"flown", figures(photos.flown)},
          {"patched", photos.patched ? figures(*photos.patched) : Json()}};
}

Json patch_json(const FlightComparison& comparison) {
  if (!comparison.patch) return {};
  const flight::Route& route = comparison.patch->route;
  Json files = Json::array();
  for (const package::FlightFile& file : comparison.patch->files.written) {
    files.push_back({{"name", file.name},
                     {"heights", file.heights},
                     {"min_clearance_m", file.min_clearance},
                     {"duration_s", file.duration}});
  }
  return {{"views", comparison.missed_views},
          {"waypoints", route.capture_points.size()},
          {"length_m", route.length},
          {"duration_s", route.duration},
          {"min_clearance_m", number_json(route.min_clearance)},
          {"sorties", route.sorties.size()},
          {"skipped_views", package::unreached_json(route.unreached)},
          {"files", files},
          {"notes", comparison.patch->files.notes}};
}

/// Returns 0 instead of a value that would be printed as -0.00.
double without_sign(double value) { return std::abs(value) < 0.005 ? 0.0 : value; }

std::string position_text(const Eigen::Vector3d& position) {
  return fmt::format("({:.1f}, {:.1f}, {:.1f})", position.x(), position.y(), position.z());
}

std::string leg_name(const flight::PlannedLeg& leg) { return leg.from + " to " + leg.to; }

/// Returns the table of legs.
std::string legs_text(const FlightComparison& comparison) {
  std::size_t width = 4;
  for (const flight::PlannedLeg& leg : comparison.plan.legs) {
    width = std::max(width, leg_name(leg).size());
  }
  std::string text =
      fmt::format("  {:<{}}  length m  planned s  flown s  max. error m  mean m\n", "leg", width);
  for (std::size_t i = 0; i < comparison.plan.legs.size(); ++i) {
    const flight::PlannedLeg& planned = comparison.plan.legs[i];
    const flight::LegComparison& leg = comparison.route.legs[i];
    text += fmt::format("  {:<{}}  {:8.1f}  {:9.1f}  ", leg_name(planned), width,
                        compute_length(planned), planned.duration);
    text += leg.is_flown ? fmt::format("{:7.1f}  {:12.2f}  {:6.2f}\n", leg.duration, leg.max_error,
                                       leg.mean_error)
                         : "not flown\n";
  }
  return text;
}

std::string captures_text(const FlightComparison& comparison) {
  const std::size_t planned = comparison.plan.captures.size();
  const std::size_t missed = comparison.num_missed_captures();
  if (!comparison.has_plan) {
    return fmt::format("  captures  {} in the log\n", comparison.route.num_other_captures);
  }
  if (planned == 0) return "  captures  none in the route file\n";
  std::string text = fmt::format("  captures  {} planned, {} missed", planned, missed);
  std::string items;
  for (std::size_t i = 0; i < planned; ++i) {
    if (!comparison.is_missed[i]) continue;
    items += (items.empty() ? "" : ", ") + comparison.plan.captures[i].item;
    if (comparison.route.captures[i].is_made) items += " (aimed elsewhere)";
  }
  if (!items.empty()) text += ": " + items;
  if (comparison.route.num_other_captures > 0) {
    text += fmt::format("; {} without a plan", comparison.route.num_other_captures);
  }
  const Eigen::Vector3d& offset = comparison.route.mean_offset;
  text += fmt::format(
      "\n  offset    {:.2f} m on average at the captures: east {:.2f}, north {:.2f}, up {:.2f}\n",
      offset.norm(), without_sign(offset.x()), without_sign(offset.y()), without_sign(offset.z()));
  if (comparison.route.are_captures_assumed) {
    text +=
        "  Warning: the log contains no camera event. A capture is assumed at each stop that "
        "was reached.\n";
  }
  return text;
}

/// Returns the lines with the flown legs, time and length.
std::string flight_text(const FlightComparison& comparison) {
  const double minutes = comparison.route.duration / 60.0;
  if (!comparison.has_plan) {
    return fmt::format("  time      {:.1f} min flown; {:.1f} m flown\n", minutes,
                       comparison.route.length);
  }
  double max_error = 0.0;
  for (const flight::LegComparison& leg : comparison.route.legs) {
    max_error = std::max(max_error, leg.max_error);
  }
  return fmt::format(
      "  legs      {} of {} flown, maximum error {:.2f} m\n"
      "  time      {:.1f} min flown, {:.1f} min planned; {:.1f} m flown\n",
      comparison.num_flown_legs(), comparison.plan.legs.size(), max_error, minutes,
      planned_duration(comparison) / 60.0, comparison.route.length);
}

std::string distance_text(const std::optional<SurfaceDistance>& nearest, const char* surface,
                          double clearance) {
  if (!nearest) return "";
  std::string text = fmt::format(
      "  clearance minimum {:.2f} m to the {}, {:.0f} s after take-off at {}; required {:.2f} m\n",
      nearest->distance, surface, nearest->time, position_text(nearest->position), clearance);
  if (nearest->distance < clearance) {
    text += "  Warning: the flight violated the required clearance.\n";
  }
  return text;
}

std::string percent(const package::ReflightCoverage& coverage) {
  return fmt::format("{:.2f}%", 100.0 * coverage.visible.value_or(coverage.all));
}

/// Returns the expected completeness as text.
std::string percent(const survey::photo::PhotoFigures& figures) {
  return fmt::format("{:.1f}%", 100.0 * figures.completeness);
}

std::string photos_text(const ComparedPhotos& photos) {
  std::string text = "  expected  completeness ";
  if (photos.planned) text += "planned " + percent(*photos.planned) + ", ";
  text += "flown " + percent(photos.flown);
  if (photos.patched) text += ", with the patch mission " + percent(*photos.patched);
  return text + " of the exposed surface\n";
}

std::string coverage_text(const FlightComparison& comparison) {
  if (comparison.photos) return photos_text(*comparison.photos);
  if (!comparison.coverage) {
    return "  coverage  not computed: " + comparison.no_coverage + "\n";
  }
  const ComparedCoverage& coverage = *comparison.coverage;
  std::string text = "  coverage  ";
  if (coverage.planned) text += "planned " + percent(*coverage.planned) + ", ";
  text += "flown " + percent(coverage.flown);
  if (coverage.patched) text += ", with the patch mission " + percent(*coverage.patched);
  text += coverage.flown.visible ? " of the visible surface (simulated)\n"
                                 : " of the surface (simulated)\n";
  // Another flight cannot cover surface that no admissible view sees.
  std::vector<package::Hole> holes = coverage.missing.holes;
  std::erase_if(holes, [](const package::Hole& hole) {
    return hole.reason == survey::surfel::MissingReason::unreachable;
  });
  if (holes.empty()) return text;
  text += fmt::format("  holes     {} of at least {:.1f} m^2, largest {:.1f} m^2 at {}\n",
                      holes.size(), coverage.missing.min_hole_area, holes.front().area,
                      position_text(holes.front().centre));
  return text;
}

std::string patch_text(const FlightComparison& comparison) {
  if (!comparison.patch) return "";
  const flight::Route& route = comparison.patch->route;
  std::string text = fmt::format(
      "  patch     {} of {}, {:.1f} m in {:.1f} min, {}, minimum clearance {:.2f} m, verified for "
      "every leg\n",
      route.capture_points.size(), support::counted(comparison.missed_views.size(), "missed view"),
      route.length, route.duration / 60.0, support::counted(route.sorties.size(), "sortie"),
      route.min_clearance);
  std::string files;
  for (const package::FlightFile& file : comparison.patch->files.written) files += " " + file.name;
  if (!files.empty()) text += "  files    " + files + "\n";
  for (const std::string& note : comparison.patch->files.notes)
    text += "  note      " + note + "\n";
  for (const flight::Unreached& view : route.unreached) {
    text += fmt::format("  Warning: view {} is not in the patch mission: {}\n",
                        view.capture_point.view_index, view.reason);
  }
  return text;
}

}  // namespace

void stage_comparison(const FlightComparison& comparison, const CompareRequest& request,
                      geometry::OutputFolder& folder) {
  Json logs = Json::array();
  for (const std::filesystem::path& log : request.logs) logs.push_back(log.filename().string());
  Json clearance{{"required_m", comparison.clearance}};
  if (const auto& nearest = comparison.cloud_distance) {
    clearance["min_cloud_distance_m"] = nearest->distance;
    clearance["position"] = to_json(nearest->position);
    clearance["time_s"] = nearest->time;
  }
  if (const auto& nearest = comparison.model_distance) {
    clearance["model"] = {{"min_distance_m", nearest->distance},
                          {"position", to_json(nearest->position)},
                          {"time_s", nearest->time}};
  }
  const Json json{{"mission", comparison.name},
                  {"version", version},
                  {"complete", true},
                  {"has_plan", comparison.has_plan},
                  {"route_files", comparison.files},
                  {"logs", logs},
                  {"log_kind", comparison.track.kind},
                  {"heights", comparison.track.heights},
                  {"warnings", comparison.track.warnings},
                  {"max_deviation_m", request.comparison.max_deviation},
                  {"duration_s", comparison.route.duration},
                  {"planned_duration_s", planned_duration(comparison)},
                  {"length_m", comparison.route.length},
                  {"legs", legs_json(comparison)},
                  {"captures", captures_json(comparison)},
                  {"clearance", clearance},
                  {"coverage", comparison.coverage ? coverage_json(*comparison.coverage) : Json()},
                  {"photos", comparison.photos ? photos_json(*comparison.photos) : Json()},
                  {"patch", patch_json(comparison)},
                  {"track", track_json(comparison)},
                  {"takeoff", comparison.pad ? to_json(*comparison.pad) : Json()},
                  {"settings", package::settings_json(comparison.mission)}};
  folder.write(comparison_name, support::json_text(json));
  if (comparison.coverage) {
    geometry::write_cloud(folder.stage(surface_name),
                          geometry::make_columns(comparison.coverage->map));
  } else if (!comparison.cloud.empty()) {
    geometry::write_cloud(folder.stage(surface_name), {comparison.cloud, {}, {}, {}, {}});
  }
}

std::string comparison_text(const FlightComparison& comparison) {
  std::string text = fmt::format("{}: {}, heights {}\n", comparison.name, comparison.track.kind,
                                 comparison.track.heights) +
                     flight_text(comparison) + captures_text(comparison);
  text += distance_text(comparison.cloud_distance, "measured cloud", comparison.clearance);
  text += distance_text(comparison.model_distance, "model", comparison.clearance);
  text += coverage_text(comparison) + patch_text(comparison);
  for (const std::string& warning : comparison.track.warnings) {
    text += "  Warning: log: " + warning + ".\n";
  }
  return comparison.has_plan ? text + legs_text(comparison) : text;
}

}  // namespace skycap::missions::comparison
