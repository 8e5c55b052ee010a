#include "flight/interpreter/interpret.h"

#include <cmath>

#include "flight/export/map_files.h"
#include "flight/export/trajectory_file.h"
#include "flight/interpreter/mission_interpreter.h"
#include "flight/interpreter/photographs.h"
#include "flight/interpreter/wpml_interpreter.h"
#include "flight/motion/motion.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/io/file.h"
#include "geometry/pose/world.h"

namespace skycap::flight {
namespace {

/// Maximum corner curve of Litchi that any tracking error covers [m].
constexpr double covered_curve = 0.3;

/// Name of a position in messages: `word` and its number, counted from `first`.
struct Naming {
  std::string word;
  std::size_t first = 0;

  std::string operator()(std::size_t i) const { return word + std::to_string(first + i); }
};

/// Returns a route through the positions in order.
InterpretedRoute in_a_row(const std::vector<Eigen::Vector3d>& positions, const Naming& name) {
  InterpretedRoute route;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (i == 0) continue;
    route.segments.push_back(
        {{positions[i - 1], positions[i - 1]}, positions[i], name(i - 1), name(i)});
  }
  if (route.segments.empty()) route.problems.emplace_back("the file contains no legs");
  return route;
}

/// Interprets a Litchi mission: straight lines with a small curve at each corner, and actions at
/// stops.
InterpretedRoute interpret_litchi(const RouteFile& file, const FlightFacts& facts) {
  const std::vector<Eigen::Vector3d> positions = local_points(file, facts.site, facts.pad);
  const Naming name{"line ", 2};
  InterpretedRoute route = in_a_row(positions, name);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const FilePoint& point = file.points[i];
    const auto add_problem = [&](const std::string& what) {
      route.problems.push_back(name(i) + " " + what);
    };
    if (point.curve > covered_curve) {
      add_problem("has a curve of " + fixed(point.curve, 1) +
                  " m, which cannot be verified; it must be " + "at most 0.3 m");
    }
    if (!(point.speed > 0.0 && point.speed <= facts.cruise_speed + 1e-3)) {
      add_problem("has a speed of " + fixed(point.speed, 2) +
                  " m/s; it must be above 0 and at most the " + "mission's cruise speed, " +
                  fixed(facts.cruise_speed, 2) + " m/s");
    }
    if (point.captures == 0) continue;
    route.stops.push_back(
        {positions[i], name(i), point.hold_before, point.yaw_deg, point.pitch_deg, point.captures});
    route.stops.back().hold_after = point.hold - point.hold_before;
  }
  for (const std::string& problem : check_photographs(route, facts)) {
    route.problems.push_back(problem);
  }
  return route;
}

InterpretedRoute interpreted(const std::string& content, Format format, const FlightFacts& facts) {
  if (format == Format::plan) return interpret(read_plan(content), facts);
  if (format == Format::waypoints) return interpret(read_waypoints(content), facts);
  if (format == Format::kmz) return interpret(unpack_kmz(content), facts);
  if (format == Format::litchi) return interpret_litchi(read_litchi(content), facts);
  return in_a_row(read_positions(content, format, facts.site, facts.pad), {"point "});
}

}  // namespace

InterpretedRoute interpret(const std::string& content, Format format, const FlightFacts& facts) {
  InterpretedRoute route = interpreted(content, format, facts);
  for (const InterpretedSegment& segment : route.segments) {
    geometry::require_valid_position(segment.start.from, segment.from_item);
    geometry::require_valid_position(segment.start.to, segment.from_item);
    geometry::require_valid_position(segment.to, segment.to_item);
  }
  for (std::size_t i = 0; facts.vehicle && i + 1 < route.segments.size(); ++i) {
    InterpretedSegment& segment = route.segments[i];
    if (route.segments[i + 1].start.length() == 0.0) continue;  // The vehicle stops.
    const double speed = std::isnan(segment.speed) ? facts.cruise_speed : segment.speed;
    const Eigen::Vector3d direction = (segment.to - segment.start.to).stableNormalized();
    segment.braking = stopping_distance(*facts.vehicle, speed * direction);
  }
  return route;
}

std::vector<InterpretedStop> list_captures(const std::string& content, Format format,
                                           const InterpretedRoute& route) {
  if (format != Format::csv && format != Format::ned_csv) return route.stops;
  const Naming name{"point "};
  std::vector<InterpretedStop> captures;
  const std::vector<TimedState> states = read_trajectory_csv(content);
  for (std::size_t i = 0; i < states.size(); ++i) {
    if (!states[i].is_capture) continue;
    captures.push_back({states[i].position, name(i), 0.0,
                        geometry::degrees_per_radian * states[i].yaw,
                        geometry::degrees_per_radian * states[i].pitch, 1});
  }
  return captures;
}

InterpretedRoute interpret_file(const std::filesystem::path& path, const FlightFacts& facts) {
  const std::string content = geometry::read_file(path, largest_route_file);
  const Format format = detect_format(path, content);
  try {
    return interpret(content, format, facts);
  } catch (const Error& error) {
    throw Error(error.kind(), path.string() + ": " + error.what());
  }
}

}  // namespace skycap::flight
