#include "missions/inspection/inspection_package.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "missions/config/inspection_rules.h"
#include "missions/config/mission_document.h"
#include "missions/inspection/flight_file.h"
#include "missions/inspection/inspection_results.h"
#include "missions/package/flight_report.h"
#include "missions/package/inspection_summary.h"
#include "missions/package/package.h"
#include "missions/package/pilot_text.h"
#include "survey/inspection/flight_evaluation.h"

namespace skycap::missions::inspection {
namespace {

using flight::Format;
using survey::inspection::FlightEvaluation;
using survey::inspection::LimitUse;

/// Returns the mission files among the formats.
std::vector<Format> mission_formats(const InspectionPackage& package,
                                    std::span<const Format> formats) {
  const flight::Vehicle& vehicle = package.setup.flight().required_vehicle();
  const auto expressible = inspection_formats(vehicle.autopilot);
  std::vector<Format> result;
  for (const Format format : formats) {
    if (flight::is_local(format)) continue;
    const std::string name = flight::format_info(format).name;
    if (const std::string reason = unsupported_reason(format); !reason.empty()) {
      throw Error(ErrorKind::bad_usage, "--format " + name + " " + reason);
    }
    if (std::ranges::find(expressible, format) == expressible.end()) {
      throw Error(ErrorKind::bad_usage,
                  fmt::format("--format {} requires a {} vehicle, and the flight is for {}; add "
                              "--set flight.vehicle={}",
                              name, format == Format::kmz ? "DJI" : "PX4 or ArduPilot",
                              vehicle.name, format == Format::kmz ? "mavic_3e" : "generic"));
    }
    result.push_back(format);
  }
  return result;
}

/// Returns the limits of the vehicle and its camera.
survey::inspection::EvaluationOptions vehicle_limits(const InspectionPackage& package) {
  const flight::Vehicle& vehicle = package.setup.flight().required_vehicle();
  const survey::inspection::InspectionOptions planned =
      config::inspection_options(*package.setup.document);
  survey::inspection::EvaluationOptions options;
  options.camera = planned.camera;
  options.min_pitch = planned.pitch.min;
  options.max_pitch = planned.pitch.max;
  options.limits = planned.limits;
  options.limits.speed = vehicle.max_speed;
  options.limits.acceleration =
      std::min(vehicle.mode.acceleration, vehicle.mode.vertical_acceleration);
  options.limits.jerk = vehicle.mode.jerk;
  options.limits.yaw_rate = vehicle.mode.yaw_rate;
  options.limits.yaw_acceleration = vehicle.mode.yaw_acceleration;
  options.threads = package.setup.run.threads;
  return options;
}

/// Returns the limits that the planned flight exceeds, with their values.
std::vector<std::string> exceeded_limits(const FlightEvaluation& evaluation) {
  std::vector<std::string> list;
  const auto add = [&](const char* name, const LimitUse& use, const char* unit, double factor) {
    if (use.is_kept()) return;
    list.push_back(
        fmt::format("{} {:.2f} of {:.2f} {}", name, factor * use.max, factor * use.limit, unit));
  };
  add("speed", evaluation.speed, "m/s", 1.0);
  add("acceleration", evaluation.acceleration, "m/s^2", 1.0);
  add("jerk", evaluation.jerk, "m/s^3", 1.0);
  add("yaw rate", evaluation.yaw_rate, "deg/s", geometry::degrees_per_radian);
  add("yaw acceleration", evaluation.yaw_acceleration, "deg/s^2", geometry::degrees_per_radian);
  add("pitch rate", evaluation.pitch_rate, "deg/s", geometry::degrees_per_radian);
  if (!evaluation.keeps_pitch) {
    list.push_back(fmt::format("pitch {:.1f} to {:.1f} degrees",
                               geometry::degrees_per_radian * evaluation.min_pitch,
                               geometry::degrees_per_radian * evaluation.max_pitch));
  }
  if (!evaluation.keeps_vertical_speed) {
    list.push_back(fmt::format("vertical speed {:.2f} m/s up, {:.2f} m/s down",
                               evaluation.max_ascent, evaluation.max_descent));
  }
  return list;
}

}  // namespace

std::optional<InspectionPackage> read_inspection(
    const std::filesystem::path& folder, const std::vector<config::KeyOverride>& overrides) {
  auto summary = package::read_inspection_summary(folder, overrides);
  if (!summary) return std::nullopt;
  InspectionPackage package;
  package.setup = std::move(summary->mission);
  package.pad = summary->pad;
  package.attainable = summary->attainable;
  package.flight = read_flight_csv(folder / flight_name);
  try {
    package.space = std::make_shared<const InspectionSpace>(package.setup);
  } catch (const Error& error) {
    throw Error(error.kind(), (folder / package::summary_name).string() + ": " + error.what());
  }
  return package;
}

InspectionExport export_inspection(const InspectionPackage& package,
                                   std::span<const Format> formats, const std::stop_token& stop,
                                   geometry::OutputFolder& folder) {
  InspectionExport exported;
  const std::vector<Format> missions = mission_formats(package, formats);
  for (const Format format : formats) {
    if (flight::is_local(format)) {
      exported.setpoints.push_back(stage_setpoints(package.flight, format, folder));
    }
  }
  if (missions.empty()) return exported;

  const flight::FlightOptions flight_options = inspection_flight_options(*package.space);
  const survey::inspection::InspectionSite site = package.space->site();
  const survey::inspection::StructureCloud cloud =
      survey::inspection::make_structure_cloud(site.points, site.normals);
  exported.points = cloud.size();
  const survey::inspection::EvaluationOptions limits = vehicle_limits(package);
  const FlightEvaluation evaluation = evaluate_flight(package.flight, cloud, limits);
  InspectionFlight flight = plan_inspection_flight(
      package.setup, *package.space,
      {package.flight, cloud, limits.camera, evaluation.acceleration.max, package.pad}, stop);
  check_deviation(flight, flown_deviation);
  if (!flight.mission.route.unreached.empty()) {
    const flight::Unreached& first = flight.mission.route.unreached.front();
    exported.warnings.push_back(
        fmt::format("{} of {} waypoints are not part of the route files; reason for the first: {}",
                    flight.mission.route.unreached.size(), flight.waypoints, first.reason));
  }
  if (const auto exceeded = exceeded_limits(evaluation); !exceeded.empty()) {
    exported.warnings.push_back(fmt::format(
        "the planned flight exceeds limits of {} ({}). The autopilot flies these parts more "
        "slowly; plan the mission again for this vehicle to avoid it",
        package.setup.flight().required_vehicle().name, fmt::join(exceeded, ", ")));
  }
  flight.mission.files =
      package::stage_flight(package.setup.name, flight_options, flight.mission.route,
                            package.space->space(), missions, folder);
  exported.flight = std::move(flight);
  return exported;
}

std::string export_text(const InspectionPackage& package, const InspectionExport& exported) {
  std::string text;
  if (exported.flight) {
    text += package.setup.name + ": " + deviation_text(*exported.flight, exported.points) +
            package::flight_text(exported.flight->mission);
  }
  if (!exported.setpoints.empty()) {
    text += fmt::format("  setpoints {}\n", fmt::join(exported.setpoints, ", "));
  }
  return text;
}

}  // namespace skycap::missions::inspection
