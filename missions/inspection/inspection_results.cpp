#include "missions/inspection/inspection_results.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "flight/export/trajectory_file.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "missions/config/mission_document.h"
#include "missions/inspection/flight_file.h"
#include "missions/package/field_sheet.h"
#include "missions/package/flight_files.h"
#include "missions/package/flight_report.h"
#include "missions/package/package.h"
#include "missions/package/pilot_text.h"
#include "missions/package/profile_file.h"
#include "missions/package/settings.h"
#include "missions/support/json_text.h"
#include "missions/version.h"

namespace skycap::missions::inspection {
namespace {

using geometry::degrees_per_radian;
using Json = nlohmann::ordered_json;
using support::to_json;
using survey::inspection::FlightEvaluation;
using survey::inspection::FlightSample;
using survey::inspection::incidence_rule;
using survey::inspection::InspectionPlan;
using survey::inspection::LimitUse;
using survey::inspection::pixel_rule;
using survey::inspection::solid_rule;

constexpr const char* enu_name = "setpoints.enu.csv";
constexpr const char* ned_name = "setpoints.ned.csv";
constexpr const char* tum_name = "camera.tum";

std::string percent(double share) { return fmt::format("{:.2f}%", 100.0 * share); }

double share_of(std::size_t count, std::size_t all) {
  return all > 0 ? static_cast<double>(count) / static_cast<double>(all) : 0.0;
}

Json limit_json(const LimitUse& use, double factor = 1.0) {
  return {{"max", factor * use.max},
          {"max_axis", factor * use.max_axis},
          {"limit", factor * use.limit},
          {"share_above", use.share_above}};
}

std::string limit_text(const char* name, const LimitUse& use, const char* unit,
                       double factor = 1.0) {
  return fmt::format(
      "{} {:.2f} of {:.4g} {}{}", name, factor * use.max, factor * use.limit, unit,
      use.is_kept() ? "" : fmt::format(" (EXCEEDED in {})", percent(use.share_above)));
}

/// Returns the states of the flight for the formats of setpoints, by central differences.
std::vector<flight::TimedState> timed_states(std::span<const FlightSample> samples) {
  std::vector<flight::TimedState> states;
  constexpr double dt = survey::inspection::sample_interval;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const FlightSample& before = samples[i == 0 ? 0 : i - 1];
    const FlightSample& after = samples[std::min(i + 1, samples.size() - 1)];
    const FlightSample& at = samples[i];
    // The vehicle rests before the start and after the end.
    flight::TimedState state;
    state.time = at.time;
    state.position = at.position;
    state.velocity = (after.position - before.position) / (2.0 * dt);
    state.acceleration = (after.position - 2.0 * at.position + before.position) / (dt * dt);
    state.yaw = std::remainder(0.5 * std::numbers::pi - at.yaw, 2.0 * std::numbers::pi);
    state.yaw_rate = -(after.yaw - before.yaw) / (2.0 * dt);
    state.pitch = at.pitch;
    states.push_back(state);
  }
  return states;
}

/// Formats that are not written, with the reason.
Json formats_json(const InspectionMission& mission, const package::FlightFiles& files) {
  Json formats = Json::object();
  for (const flight::Format format :
       {flight::Format::litchi, flight::Format::kml, flight::Format::geojson}) {
    formats[flight::format_info(format).name] = unsupported_reason(format);
  }
  if (!mission.flight) {
    for (const char* name : {"plan", "waypoints", "kmz"}) formats[name] = mission.flight_failure;
    return formats;
  }
  const flight::AutopilotType autopilot = mission.flight->mission.route.vehicle.autopilot;
  for (const flight::Format format :
       {flight::Format::plan, flight::Format::waypoints, flight::Format::kmz}) {
    const flight::FormatInfo& info = flight::format_info(format);
    const auto written = inspection_formats(autopilot);
    if (std::ranges::find(written, format) == written.end()) {
      formats[info.name] = "the vehicle does not read this format";
    } else if (std::ranges::find(files.written, format, &package::FlightFile::format) ==
               files.written.end()) {
      const std::string prefix = std::string("no mission") + info.extension + ": ";
      std::string reason = "see flight.notes";
      for (const std::string& note : files.notes) {
        if (note.starts_with(prefix)) reason = note.substr(prefix.size());
      }
      formats[info.name] = reason;
    }
  }
  return formats;
}

/// Returns the figures of the curve that the autopilot flies from the route files, or null.
Json flown_json(const InspectionMission& mission) {
  if (!mission.flight) return {};
  const InspectionFlight& flight = *mission.flight;
  double clearance = flight.mission.route.min_clearance;
  for (const package::FlightFile& file : flight.mission.files.written) {
    clearance = std::min(clearance, file.min_clearance);
  }
  const auto share = [&](std::size_t rule) {
    return share_of(flight.seen[rule], mission.plan.cloud.size());
  };
  return {{"deviation_bound_m", flight.deviation_bound},
          {"allowed_deviation_m", mission.options.flown_deviation},
          {"verified_clearance_m", clearance},
          {"waypoints", flight.waypoints},
          {"unreached_waypoints", flight.mission.route.unreached.size()},
          {"sorties", flight.mission.route.sorties.size()},
          {"recorded_duration_s", flight.recorded_duration},
          {"pixel", share(pixel_rule)},
          {"solid", share(solid_rule)},
          {"incidence", share(incidence_rule)}};
}

void write_structure(const InspectionPlan& plan, geometry::OutputFolder& folder) {
  std::vector<std::uint8_t> pixel, solid, incidence;
  for (const std::uint8_t rules : plan.evaluation.rules_seen) {
    pixel.push_back(rules >> pixel_rule & 1U);
    solid.push_back(rules >> solid_rule & 1U);
    incidence.push_back(rules >> incidence_rule & 1U);
  }
  constexpr std::array<std::uint8_t, 3> seen{86, 180, 233}, unseen{213, 94, 0};
  std::vector<std::array<std::uint8_t, 3>> colours;
  for (const std::uint8_t is_seen : incidence) colours.push_back(is_seen != 0 ? seen : unseen);
  geometry::CloudColumns columns;
  columns.positions = plan.cloud.points;
  columns.colours = colours;
  columns.normals = plan.cloud.normals;
  columns.marks = {{"seen_pixel", pixel}, {"seen_solid", solid}, {"seen", incidence}};
  geometry::write_cloud(folder.stage(structure_name), columns);
}

/// Stages the route files. A format that cannot be written is a note.
void stage_route_files(const config::MissionSetup& setup, const InspectionSpace& space,
                       package::SurveyMission& flight, geometry::OutputFolder& folder) {
  try {
    flight.files = package::stage_flight(
        setup.name, inspection_flight_options(space), flight.route, space.space(),
        inspection_formats(flight.route.vehicle.autopilot), folder);
    package::stage_profile(inspection_flight_options(space), flight.route, space.space(), folder);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::bad_config && error.kind() != ErrorKind::bad_geometry) throw;
    flight.files.notes.emplace_back(error.what());
  }
}

Json vertices_json(const InspectionPlan& plan) {
  Json list = Json::array();
  for (const survey::inspection::Vertex& vertex : plan.vertices) {
    list.push_back({{"position", to_json(vertex.position)},
                    {"yaw_deg", degrees_per_radian * vertex.yaw},
                    {"pitch_deg", degrees_per_radian * vertex.pitch},
                    {"delay_s", vertex.delay}});
  }
  return list;
}

/// Returns the figures of the search, or null for edited flights.
Json search_json(const InspectionMission& mission) {
  if (mission.is_edited) return {};
  return {{"moves", mission.options.moves},
          {"searches", mission.options.searches},
          {"best_search", mission.plan.search},
          {"evaluated_moves", mission.plan.evaluated_moves},
          {"cells", mission.plan.cells}};
}

Json inspection_json(const InspectionMission& mission) {
  const InspectionPlan& plan = mission.plan;
  return {
      {"duration_s", plan.evaluation.duration},
      {"length_m", plan.evaluation.length},
      {"first_tour_s", mission.is_edited ? Json() : Json(plan.first_duration)},
      {"range_m", mission.options.camera.range},
      {"required_clearance_m", mission.options.clearance},
      {"verified_clearance_m", plan.verified_clearance},
      {"required_share", mission.options.goal.shares[incidence_rule]},
      {"attainable_points", plan.attainable[incidence_rule]},
      {"share_of_attainable",
       share_of(plan.evaluation.seen[incidence_rule], plan.attainable[incidence_rule])},
      {"meets_goal", plan.meets_goal},
      {"evaluation", evaluation_json(plan.evaluation)},
      {"search", search_json(mission)},
      {"smoothing_s", {plan.smoothing.shorter, plan.smoothing.longer}},
      {"vertices", vertices_json(plan)},
      {"flown", flown_json(mission)},
      {"formats_not_written", formats_json(mission, mission.flight ? mission.flight->mission.files
                                                                   : package::FlightFiles{})}};
}

}  // namespace

std::string evaluation_text(const FlightEvaluation& evaluation) {
  std::string text = fmt::format(
      "  seen      {} of {} points at a limited incidence; {} not hidden; {} by pixels alone\n",
      percent(evaluation.share(incidence_rule)), evaluation.points,
      percent(evaluation.share(solid_rule)), percent(evaluation.share(pixel_rule)));
  text += fmt::format(
      "  views     median {:.0f} per point (one view every 0.5 s), at least {:.0f} for 90% of the "
      "points; median distance of the nearest view {:.2f} m\n",
      evaluation.views.median, evaluation.views.percentile_10, evaluation.median_view_distance);
  text += "  motion    " + limit_text("speed", evaluation.speed, "m/s") + ", " +
          limit_text("acceleration", evaluation.acceleration, "m/s^2") + ", " +
          limit_text("jerk", evaluation.jerk, "m/s^3") + "\n";
  text += fmt::format(
      "            {}, {}, {}, pitch {:.1f} to {:.1f} degrees{}\n",
      limit_text("yaw", evaluation.yaw_rate, "deg/s", degrees_per_radian),
      limit_text("yaw acceleration", evaluation.yaw_acceleration, "deg/s^2", degrees_per_radian),
      limit_text("pitch", evaluation.pitch_rate, "deg/s", degrees_per_radian),
      degrees_per_radian * evaluation.min_pitch, degrees_per_radian * evaluation.max_pitch,
      evaluation.keeps_pitch ? "" : " (OUT OF RANGE)");
  if (!evaluation.keeps_vertical_speed) {
    text += fmt::format("            vertical speed EXCEEDED: {:.2f} m/s up, {:.2f} m/s down\n",
                        evaluation.max_ascent, evaluation.max_descent);
  }
  return text;
}

Json evaluation_json(const FlightEvaluation& evaluation) {
  const auto rule = [&](std::size_t i) {
    return Json{{"points", evaluation.seen[i]}, {"share", evaluation.share(i)}};
  };
  return {{"duration_s", evaluation.duration},
          {"length_m", evaluation.length},
          {"points", evaluation.points},
          {"pixel", rule(pixel_rule)},
          {"solid", rule(solid_rule)},
          {"incidence", rule(incidence_rule)},
          {"views_per_point",
           {{"mean", evaluation.views.mean},
            {"median", evaluation.views.median},
            {"percentile_10", evaluation.views.percentile_10}}},
          {"median_view_distance_m", evaluation.median_view_distance},
          {"nearest_point_m", evaluation.nearest},
          {"nearest_disc_m", evaluation.nearest_surface},
          {"nearest_time_s", evaluation.nearest_time},
          {"min_height_m", evaluation.min_height},
          {"keeps_limits", evaluation.keeps_limits()},
          {"speed", limit_json(evaluation.speed)},
          {"acceleration", limit_json(evaluation.acceleration)},
          {"jerk", limit_json(evaluation.jerk)},
          {"yaw_rate_deg", limit_json(evaluation.yaw_rate, degrees_per_radian)},
          {"yaw_acceleration_deg", limit_json(evaluation.yaw_acceleration, degrees_per_radian)},
          {"pitch_rate_deg", limit_json(evaluation.pitch_rate, degrees_per_radian)},
          {"pitch_deg",
           {degrees_per_radian * evaluation.min_pitch, degrees_per_radian * evaluation.max_pitch}},
          {"max_ascent_m_s", evaluation.max_ascent},
          {"max_descent_m_s", evaluation.max_descent}};
}

std::string deviation_text(const InspectionFlight& flight, std::size_t points) {
  return fmt::format(
      "{} waypoints, at most {:.2f} m from the planned curve (allowed: {:.2f} m); the flown curve "
      "sees {} of all points at a limited incidence\n",
      flight.waypoints, flight.deviation_bound, flown_deviation,
      percent(share_of(flight.seen[incidence_rule], points)));
}

std::string stage_setpoints(std::span<const FlightSample> flight, flight::Format format,
                            geometry::OutputFolder& folder) {
  const std::vector<flight::TimedState> states = timed_states(flight);
  const bool is_poses = format == flight::Format::tum, is_ned = format == flight::Format::ned_csv;
  const std::string name = is_poses ? tum_name : is_ned ? ned_name : enu_name;
  folder.write(name, is_poses ? write_tum(camera_poses(states))
                              : write_trajectory_csv(
                                    states, is_ned ? flight::Frame::ned : flight::Frame::enu));
  return name;
}

std::string plan_text(const config::MissionSetup& setup, const InspectionMission& mission) {
  const InspectionPlan& plan = mission.plan;
  const FlightEvaluation& evaluation = plan.evaluation;
  std::string text =
      fmt::format("{}: continuous flight of {:.1f} s ({:.1f} min), {:.1f} m\n", setup.name,
                  evaluation.duration, evaluation.duration / 60.0, evaluation.length);
  text += fmt::format(
      "  coverage  {} of the attainable points (required: {}), which are {} of all points\n",
      percent(share_of(evaluation.seen[incidence_rule], plan.attainable[incidence_rule])),
      percent(mission.options.goal.shares[incidence_rule]),
      percent(share_of(plan.attainable[incidence_rule], evaluation.points)));
  text += evaluation_text(evaluation);
  text += fmt::format("  clearance {:.2f} m verified from all surfaces (required: {:.2f} m)\n",
                      plan.verified_clearance, mission.options.clearance);
  const FlightSample& start = plan.samples.front();
  const FlightSample& end = plan.samples.back();
  text += fmt::format(
      "  start     ({:.2f}, {:.2f}, {:.2f}), end ({:.2f}, {:.2f}, {:.2f}), both at rest\n",
      start.position.x(), start.position.y(), start.position.z(), end.position.x(),
      end.position.y(), end.position.z());
  if (!mission.is_edited) {
    text +=
        fmt::format("  search    {} changes evaluated; flight time of the initial tour {:.0f} s\n",
                    plan.evaluated_moves, plan.first_duration);
  }
  if (!mission.flight) return text;
  const InspectionFlight& flight = *mission.flight;
  return text + "  files     " + deviation_text(flight, plan.cloud.size());
}

std::string warnings_text(const config::MissionSetup& setup, const InspectionMission& mission) {
  if (mission.flight) {
    return package::flight_text(mission.flight->mission) + "\n" +
           package::pilot_text(setup.flight(), mission.flight->mission, mission.warnings);
  }
  std::string text;
  for (const std::string& warning : mission.warnings) text += "Warning: " + warning + ".\n";
  return text;
}

void stage_inspection_mission(const config::MissionSetup& setup, const InspectionSpace& space,
                              InspectionMission& mission, geometry::OutputFolder& folder) {
  folder.replace([](std::string_view name) {
    return name == package::free_space_name || name == package::report_name ||
           name == package::field_sheet_name || name == package::fly_test_name ||
           name == package::profile_name || package::is_flight_file(name);
  });
  folder.write(flight_name, write_flight_csv(mission.plan.samples));
  folder.write(corners_name, write_corners_csv(mission.plan.vertices));
  for (const flight::Format format :
       {flight::Format::csv, flight::Format::ned_csv, flight::Format::tum}) {
    stage_setpoints(mission.plan.samples, format, folder);
  }
  write_structure(mission.plan, folder);
  if (mission.flight) {
    stage_route_files(setup, space, mission.flight->mission, folder);
  }
  Json summary{{"mission", setup.name},
               {"kind", "inspection"},
               {"seed", setup.run.seed},
               {"version", version},
               {"complete", true},
               {"warnings", mission.warnings},
               {"inspection", inspection_json(mission)}};
  if (mission.flight) {
    summary["flight"] = package::route_json(mission.flight->mission, mission.flight->pad);
  }
  summary["settings"] = package::settings_json(setup);
  folder.write(package::summary_name, support::json_text(summary));
}

}  // namespace skycap::missions::inspection
