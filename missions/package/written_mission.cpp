#include "missions/package/written_mission.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "flight/export/export.h"
#include "geometry/angle.h"
#include "missions/package/fleet_mission.h"
#include "missions/package/replanned_mission.h"
#include "missions/package/surface_json.h"
#include "missions/session/en_route_frames.h"

namespace skycap::missions::package {
namespace {

using Json = nlohmann::ordered_json;
using session::ViewInFlight;

/// Tolerances for the rounding of positions [m] and directions in files. Litchi stores whole
/// degrees.
constexpr double same_position = 2.0 * flight::rounding_bound;
constexpr double same_direction = 1.0 * geometry::radians_per_degree;
constexpr double same_speed = 0.1;  ///< [m/s]

double angle_between(const geometry::View& a, const geometry::View& b) {
  return std::atan2(a.direction.cross(b.direction).norm(), a.direction.dot(b.direction));
}

bool is_same(const ViewInFlight& a, const ViewInFlight& b) {
  return (a.view.position - b.view.position).norm() <= same_position &&
         angle_between(a.view, b.view) <= same_direction &&
         (a.velocity - b.velocity).norm() <= same_speed;
}

geometry::View to_view(const flight::InterpretedStop& capture) {
  return {capture.position,
          flight::compute_direction({geometry::radians_per_degree * capture.yaw_deg,
                                     geometry::radians_per_degree * capture.pitch_deg})};
}

/// Returns the capture that belongs to this view: of all captures at its position, the one with the
/// closest direction.
std::optional<geometry::View> make_capture(const geometry::View& view,
                                           const std::vector<flight::InterpretedStop>& captures) {
  std::optional<geometry::View> nearest;
  double turned = same_direction;
  for (const flight::InterpretedStop& capture : captures) {
    if ((capture.position - view.position).norm() > same_position) continue;
    const geometry::View captured = to_view(capture);
    const double angle = angle_between(captured, view);
    if (angle > turned) continue;
    nearest = captured;
    turned = angle;
  }
  return nearest;
}

/// One or more formats with the measurements of their files.
struct WrittenPart {
  std::vector<std::string> files;
  std::size_t views = 0;
  std::vector<ViewInFlight> measured;
};

std::size_t count_capture_points(const flight::Route& route, const FlightFiles& files,
                                 flight::Format format) {
  std::size_t count = 0;
  for (const FlightFile& file : files.written) {
    if (file.format != format) continue;
    count += route.sorties[file.sortie].last - route.sorties[file.sortie].first + 1;
  }
  return count;
}

WrittenPart make_part(const flight::FlightOptions& options, const flight::Route& route,
                      const FlightFiles& files, flight::Format format) {
  WrittenPart part{{}, 0, written_views(options, route, files, format)};
  for (const FlightFile& file : files.written) {
    if (file.format == format) part.files.push_back(file.name);
  }
  part.views = options.capture.scans_in_flight() ? count_capture_points(route, files, format)
                                                 : part.measured.size();
  return part;
}

void add(WrittenPart part, std::vector<WrittenPart>& parts) {
  const auto same = std::ranges::find_if(parts, [&](const WrittenPart& other) {
    return std::ranges::equal(part.measured, other.measured, is_same);
  });
  if (same == parts.end()) {
    parts.push_back(std::move(part));
  } else {
    same->files.insert(same->files.end(), part.files.begin(), part.files.end());
  }
}

/// Returns the files of all vehicles. Each vehicle has the format of its autopilot or else its
/// first format.
WrittenPart fleet_part(const FleetMission& fleet) {
  WrittenPart all;
  for (const FleetMember& member : fleet.members) {
    if (member.files.written.empty()) continue;
    WrittenPart part =
        make_part(member.flight, member.route, member.files, member.files.written.front().format);
    all.files.insert(all.files.end(), part.files.begin(), part.files.end());
    all.views += part.views;
    const double begin = all.measured.empty() ? 0.0 : all.measured.back().time + 1.0;
    for (ViewInFlight& view : part.measured) {
      view.time += begin;
      all.measured.push_back(std::move(view));
    }
  }
  return all;
}

std::vector<WrittenPart> written_parts(const flight::FlightOptions& options,
                                       const SurveyMission& mission) {
  std::vector<WrittenPart> parts;
  for (const flight::FormatInfo& info : flight::formats()) {
    const bool is_written = std::ranges::find(mission.files.written, info.format,
                                              &FlightFile::format) != mission.files.written.end();
    if (is_written) add(make_part(options, mission.route, mission.files, info.format), parts);
  }
  if (mission.fleet) add(fleet_part(*mission.fleet), parts);
  return parts;
}

WrittenCoverage compute_target_coverage(const evaluation::SimulationOptions& simulation,
                                        const CoverageFigures& coverage, WrittenPart part,
                                        const std::stop_token& stop) {
  TargetMeter targets(simulation.scene, simulation.evaluation.registration_distance);
  const simulation::CoveredAgain covered = coverage.fly_again(
      part.measured,
      [&](std::span<const Eigen::Vector3f> stored, std::span<const Eigen::Vector3f>) {
        targets.add(stored);
      },
      stop);
  std::vector<geometry::View> views;
  for (const ViewInFlight& measured : part.measured) views.push_back(measured.view);
  const TrueCoverage& truth = coverage.truth.value();
  return {std::move(part.files),
          part.views,
          simulate_reflight(coverage, covered),
          targets.coverage(),
          missing_surface(true_patches(truth.samples, truth.area, covered.stored, truth.is_visible),
                          views),
          covered.stored};
}

/// Returns the names without the sorties' numbers, such as "mission-*.plan".
std::string names_text(const std::vector<std::string>& files) {
  std::vector<std::string> names;
  for (const std::string& file : files) {
    std::string name = file;
    const std::size_t extension = name.find('.'), dash = name.rfind('-', extension);
    if (dash != std::string::npos && extension != std::string::npos) {
      name = name.substr(0, dash) + "-*" + name.substr(extension);
    }
    if (std::ranges::find(names, name) == names.end()) names.push_back(name);
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

}  // namespace

std::vector<ViewInFlight> written_views(const flight::FlightOptions& options,
                                        const flight::Route& route, const FlightFiles& files,
                                        flight::Format format) {
  flight::Route flight_record = route;
  flight_record.sorties.clear();
  std::vector<flight::InterpretedStop> captures;
  for (const FlightFile& file : files.written) {
    if (file.format != format) continue;
    flight_record.sorties.push_back(route.sorties[file.sortie]);
    if (!flight::supports_curves(format)) flight_record.sorties.back().fly_through.reset();
    captures.insert(captures.end(), file.captures.begin(), file.captures.end());
  }
  std::vector<ViewInFlight> views = session::measured_views(options, flight_record);
  // Trajectories contain captures although they do not command the camera.
  const bool has_captures = flight::captures_images(format) || !captures.empty();
  if (options.capture.is_scanner || !has_captures) return views;
  std::erase_if(views, [&](ViewInFlight& view) {
    const std::optional<geometry::View> captured = make_capture(view.view, captures);
    if (captured) view.view = *captured;
    return !captured;
  });
  return views;
}

std::shared_ptr<const WrittenMission> written_mission(
    const evaluation::SimulationOptions& simulation, const CoverageFigures& coverage,
    const SurveyMission& mission, const std::stop_token& stop) {
  if (!coverage.fly_again || !coverage.truth || mission.files.written.empty()) return nullptr;
  auto written = std::make_shared<WrittenMission>();
  written->planned = mission.route.capture_points.size() + mission.route.unreached.size();
  for (WrittenPart& part : written_parts(simulation.survey.flight, mission)) {
    written->parts.push_back(compute_target_coverage(simulation, coverage, std::move(part), stop));
    if (stop.stop_requested()) return nullptr;
  }
  return written;
}

Json written_json(const WrittenMission& mission) {
  Json parts = Json::array();
  for (const WrittenCoverage& part : mission.parts) {
    Json json{{"files", part.files}, {"views", part.views}, {"planned_views", mission.planned}};
    json.update(again_json(part.again));
    json["targets"] = targets_json(part.targets);
    json["surface"] = missing_json(part.missing, "simulator");
    parts.push_back(std::move(json));
  }
  return parts;
}

std::string written_text(const WrittenMission& mission) {
  std::string text;
  for (const WrittenCoverage& part : mission.parts) {
    const std::string files = mission.parts.size() == 1 ? "route files" : names_text(part.files);
    text += fmt::format("  mission   {}, {} of {} views: {}\n", files, part.views, mission.planned,
                        again_text(part.again));
    text += target_text(part.targets, "");
  }
  return text;
}

}  // namespace skycap::missions::package
