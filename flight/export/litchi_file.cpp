#include <algorithm>
#include <cmath>

#include "flight/export/map_files.h"
#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

using geometry::degrees_per_radian;
constexpr std::size_t actions_per_line = 15;
constexpr std::size_t max_waypoints = 99;  // Limit per mission on the oldest supported firmware.
constexpr double min_curve_size = 0.2;     // Minimum corner curve that Litchi accepts [m].

constexpr int stay = 0, photo = 1, rotate = 4, tilt = 5;  // Action types.

constexpr std::size_t fields_before_actions = 8, fields_after_actions = 8;
constexpr std::size_t litchi_fields =
    fields_before_actions + 2 * actions_per_line + fields_after_actions;

std::string header() {
  std::string text =
      "latitude,longitude,altitude(m),heading(deg),curvesize(m),rotationdir,gimbalmode,"
      "gimbalpitchangle";
  for (std::size_t i = 1; i <= actions_per_line; ++i) {
    text += ",actiontype" + std::to_string(i) + ",actionparam" + std::to_string(i);
  }
  return text +
         ",altitudemode,speed(m/s),poi_latitude,poi_longitude,poi_altitude(m),poi_altitudemode,"
         "photo_timeinterval,photo_distinterval";
}

std::string format_actions(const Waypoint& waypoint) {
  std::string text;
  std::size_t used = 0;
  const auto act = [&](int action, const std::string& parameter) {
    text += "," + std::to_string(action) + "," + parameter;
    ++used;
  };
  if (waypoint.is_capture_point)
    act(tilt, fixed(waypoint.pitch * degrees_per_radian, 0));  // Whole degrees only.
  act(stay, fixed(waypoint.hold * 1000.0, 0));
  for (int capture = 0; capture < waypoint.captures; ++capture) act(photo, "0");
  if (waypoint.hold_after > 0.0) act(stay, fixed(waypoint.hold_after * 1000.0, 0));
  if (used > actions_per_line) {
    throw Error(ErrorKind::bad_config, "a waypoint with " + std::to_string(waypoint.captures) +
                                           " photos cannot be written for Litchi; the maximum is " +
                                           std::to_string(actions_per_line - 3));
  }
  for (; used < actions_per_line; ++used) text += ",-1,0";
  return text;
}

struct LitchiParser {
  Problems problems;
  RouteFile route;

  explicit LitchiParser(const std::string& text) {
    const std::vector<std::string> lines = split_lines(text);
    if (lines.empty() || geometry::trimmed(lines[0]) != header()) {
      problems.emplace_back("line 1 is not the Litchi header");
      return;
    }
    for (std::size_t i = 1; i < lines.size(); ++i) {
      if (!geometry::trimmed(lines[i]).empty()) read_line(lines[i], i + 1);
    }
    if (problems.empty() && route.points.size() < 2) {
      problems.emplace_back("fewer than two waypoints");
    }
    if (route.points.size() > max_waypoints) {
      problems.push_back("too many waypoints: " + std::to_string(route.points.size()) +
                         "; the limit of old firmware is 99");
    }
  }

  void read_line(const std::string& text, std::size_t number) {
    const std::string who = "line " + std::to_string(number) + " ";
    const std::vector<std::string> fields = split(text, ',');
    if (fields.size() != litchi_fields) {
      problems.push_back(who + "has " + std::to_string(fields.size()) + " fields; it must have " +
                         std::to_string(litchi_fields) + ", including all 15 actions");
      return;
    }
    const std::optional<std::vector<double>> numbers = to_numbers(fields, who, problems);
    if (!numbers) return;
    const std::vector<double>& values = *numbers;
    const auto require = [&](std::size_t field, double low, double high, const char* name) {
      if (values[field] >= low && values[field] <= high) return;
      problems.push_back(
          who + "has " + name + " " + fields[field] + "; it must be " +
          (low == high ? fixed(low, 0) : "from " + fixed(low, 0) + " to " + fixed(high, 0)));
    };
    require(0, -90, 90, "latitude"), require(1, -180, 180, "longitude");
    require(2, -200, 500, "altitude"), require(3, 0, 359.999999, "heading");
    require(fields_before_actions + 2 * actions_per_line, 0, 0, "altitudemode (above take-off)");
    require(fields_before_actions + 2 * actions_per_line + 1, 0, 15, "speed");
    require(6, 0, 0, "gimbalmode (by actions)");
    require(litchi_fields - 2, -1, 0, "photo_timeinterval (by actions)");
    require(litchi_fields - 1, -1, 0, "photo_distinterval (by actions)");

    FilePoint point{values[0], values[1], values[2], values[3]};
    point.datum = HeightDatum::takeoff;
    point.curve = values[4];
    point.speed = values[fields_before_actions + 2 * actions_per_line + 1];
    for (std::size_t i = 0; i < actions_per_line; ++i) {
      const std::size_t field = fields_before_actions + 2 * i;
      const double parameter = values[field + 1];
      require(field, -1, 5, "an action type");
      if (values[field] == stay) point.hold += parameter / 1000.0;
      if (values[field] == stay && point.captures == 0) point.hold_before += parameter / 1000.0;
      if (values[field] == tilt) point.pitch_deg = parameter;
      if (values[field] == rotate) point.yaw_deg = parameter;
      if (values[field] == photo) ++point.captures;
    }
    route.points.push_back(point);
  }
};

}  // namespace

std::vector<FlightPlan> litchi_parts(const FlightPlan& plan) {
  std::vector<FlightPlan> parts;
  for (std::size_t first = 0; parts.empty() || first + 1 < plan.waypoints.size();) {
    const std::size_t end = std::min(first + max_waypoints, plan.waypoints.size());
    FlightPlan part = plan;
    part.waypoints.assign(plan.waypoints.begin() + static_cast<std::ptrdiff_t>(first),
                          plan.waypoints.begin() + static_cast<std::ptrdiff_t>(end));
    if (first > 0) {
      Waypoint& start = part.waypoints.front();
      start.is_capture_point = false;
      start.captures = 0;
      start.hold = corner_hold;
      start.hold_after = 0.0;
    }
    parts.push_back(std::move(part));
    first = end - 1;
  }
  return parts;
}

std::string write_litchi(const FlightPlan& plan) {
  if (plan.waypoints.size() > max_waypoints) {
    throw Error(ErrorKind::bad_config,
                "\"" + plan.name + "\" has " + std::to_string(plan.waypoints.size()) +
                    " waypoints; the maximum for Litchi is 99; divide the plan with split_plan()");
  }
  const LocalFrame frame(plan.site.origin);
  const double pad_height = frame.to_geodetic(plan.pad).height;
  std::string text = header() + "\n";
  double heading = 0.0;
  for (const Waypoint& waypoint : plan.waypoints) {
    const GeodeticPoint geodetic = frame.to_geodetic(waypoint.position);
    if (waypoint.is_capture_point)
      heading = std::fmod(std::round(waypoint.yaw * degrees_per_radian * 1e4) / 1e4, 360.0);
    text += degrees(geodetic.latitude_deg) + "," + degrees(geodetic.longitude_deg) + "," +
            fixed(geodetic.height - pad_height, 3) + "," + fixed(heading, 4) + "," +
            fixed(min_curve_size, 1) + ",0,0,0" + format_actions(waypoint) + ",0," +
            fixed(plan.conditions.cruise_speed, 2) + ",0,0,0,0,-1,-1\n";
  }
  return text;
}

Problems validate_litchi(const std::string& text) { return LitchiParser(text).problems; }

RouteFile read_litchi(const std::string& text) {
  const LitchiParser parser(text);
  throw_first(parser.problems, "invalid Litchi file");
  return parser.route;
}

}  // namespace skycap::flight
