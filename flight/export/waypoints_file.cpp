#include <algorithm>
#include <cmath>

#include "flight/export/mavlink_files.h"
#include "geometry/text_parts.h"

namespace skycap::flight {
namespace {

constexpr std::string_view waypoints_header = "QGC WPL 110";
constexpr std::size_t item_fields = 12;

std::string line(std::size_t index, bool is_current, const MissionItem& item) {
  std::string text = std::to_string(index) + (is_current ? "\t1\t" : "\t0\t") +
                     std::to_string(item.frame) + "\t" + std::to_string(item.command);
  for (std::size_t p = 0; p < item.params.size(); ++p) {
    const double value = std::isnan(item.params[p]) ? 0.0 : item.params[p];
    text += "\t" + (p == 4 || p == 5 ? degrees(value) : fixed(value, 4));
  }
  return text + "\t1\n";
}

/// Combines checking and reading: the items are complete if there are no problems. Strict: the
/// rules of the strictest ground station. Otherwise: those of Mission Planner, MAVProxy and APM
/// Planner, with blank lines, comments, columns separated by blanks and a home without position.
struct WaypointsParser {
  Problems problems;
  std::vector<MissionItem> items;
  std::optional<MissionItem> home;
  bool is_strict;

  explicit WaypointsParser(const std::string& text, bool strict) : is_strict(strict) {
    const std::vector<std::string> lines = split_lines(text);
    const std::size_t first = is_strict ? 0 : first_line(lines);
    if (!check_header(first < lines.size() ? lines[first] : "", first + 1)) return;
    for (std::size_t i = first + 1; i < lines.size(); ++i) read_line(lines[i], i + 1);
    if (!problems.empty() || items.empty() || !is_home(items.front())) return;
    home = items.front();
    items.erase(items.begin());
  }

  static std::size_t first_line(const std::vector<std::string>& lines) {
    const auto is_full = [](const std::string& line) {
      return !geometry::split_words(line).empty();
    };
    return static_cast<std::size_t>(std::ranges::find_if(lines, is_full) - lines.begin());
  }

  bool check_header(const std::string& line, std::size_t number) {
    const std::string who = "line " + std::to_string(number) + " ";
    if (line == waypoints_header) return true;
    const std::vector<std::string> words = geometry::split_words(line);
    const bool is_wpl = words.size() == 3 && words[0] == "QGC" && words[1] == "WPL";
    // Files of APM Planner 2 have version 120 and the same columns.
    if (!is_strict && is_wpl && (words[2] == "110" || words[2] == "120")) return true;
    if (is_wpl && (words[2] == "100" || words[2] == "101")) {
      problems.push_back(
          who + "has version " + words[2] +
          ", whose columns are in a different order; save the mission as QGC WPL 110");
    } else {
      problems.push_back(who + "must be \"QGC WPL 110\"");
    }
    return false;
  }

  /// Returns true for the home item. ArduPilot's files start with it: a waypoint with absolute
  /// height before the take-off. Mission Planner writes an unknown home as zeros, including its
  /// command.
  bool is_home(const MissionItem& item) const {
    if (item.command == command::waypoint && item.frame == frame::global) return true;
    return !is_strict &&
           (item.command == 0 || (item.command == command::waypoint && !has_coordinates(item)));
  }

  void read_line(const std::string& text, std::size_t line_number) {
    const std::string who = "line " + std::to_string(line_number) + " ";
    const std::vector<std::string> fields =
        is_strict ? split(text, '\t') : geometry::split_words(text);
    if (!is_strict && (fields.empty() || fields.front().starts_with('#'))) return;
    if (fields.size() != item_fields) {
      problems.push_back(who + "has " + std::to_string(fields.size()) + " fields separated by " +
                         (is_strict ? "tabs" : "tabs or blanks") + "; it must have 12");
      return;
    }
    const std::optional<std::vector<double>> numbers = to_numbers(fields, who, problems);
    if (!numbers) return;
    const std::vector<double>& values = *numbers;
    const std::size_t index = items.size();
    if (values[0] != static_cast<double>(index)) {
      problems.push_back(who + "has index " + fields[0] + "; it must be " + std::to_string(index));
    }
    if (is_strict && values[1] != (index == 0 ? 1.0 : 0.0)) {
      problems.push_back(who + "must have the current flag (1) on the first line only");
    }
    for (const std::size_t whole : {2U, 3U, 11U}) {
      if (values[whole] != std::floor(values[whole]) || std::abs(values[whole]) > 1e5) {
        problems.push_back(who + "has \"" + geometry::excerpt(fields[whole]) +
                           "\"; it must be an integer");
        return;
      }
    }
    MissionItem item{
        static_cast<int>(values[3]), static_cast<int>(values[2]), {}, values[11] == 1, index};
    std::copy(values.begin() + 4, values.begin() + 11, item.params.begin());
    items.push_back(item);
  }
};

Problems find_problems(WaypointsParser& parser, std::optional<AutopilotType> autopilot) {
  if (!parser.problems.empty()) return parser.problems;
  if (autopilot == AutopilotType::ardupilot && !parser.home) {
    parser.problems.emplace_back("line 2 must be home: frame 0, command 16");
  }
  if (autopilot == AutopilotType::px4 && parser.home) {
    parser.problems.emplace_back("line 2 is a home position, which PX4 files must not contain");
  }
  for (const std::string& problem : check_items(parser.items, autopilot)) {
    parser.problems.push_back(problem);
  }
  return parser.problems;
}

}  // namespace

std::string write_waypoints(const FlightPlan& plan) {
  std::vector<MissionItem> items = mission_items(plan);
  if (plan.vehicle.autopilot == AutopilotType::ardupilot) {
    const GeodeticPoint home = LocalFrame(plan.site.origin).to_geodetic(plan.pad);
    const double amsl = home.height - plan.site.undulation_for("an ArduPilot .waypoints file");
    items.insert(items.begin(),
                 MissionItem{command::waypoint,
                             frame::global,
                             {0, 0, 0, 0, home.latitude_deg, home.longitude_deg, amsl}});
  }
  // Programs interpret NaN differently. Therefore an unset yaw at a corner becomes that of the
  // previous stop, or of the first waypoint with captures.
  double yaw = 0.0;
  for (auto item = items.rbegin(); item != items.rend(); ++item) {
    if (item->command == command::waypoint && !std::isnan(item->params[3])) yaw = item->params[3];
  }
  for (MissionItem& item : items) {
    if (std::isnan(item.params[3])) item.params[3] = yaw;
    if (item.command == command::waypoint) yaw = item.params[3];
  }
  std::string text = std::string(waypoints_header) + "\n";
  for (std::size_t i = 0; i < items.size(); ++i) text += line(i, i == 0, items[i]);
  return text;
}

Problems validate_waypoints(const std::string& text, std::optional<AutopilotType> autopilot) {
  WaypointsParser parser(text, true);
  return find_problems(parser, autopilot);
}

MavlinkMission read_waypoints(const std::string& text) {
  WaypointsParser parser(text, false);
  throw_first(find_problems(parser, {}), "invalid .waypoints file");
  MavlinkMission file{.items = parser.items,
                      .autopilot = parser.home ? AutopilotType::ardupilot : AutopilotType::px4};
  if (parser.home && has_coordinates(*parser.home)) {
    const std::array<double, 7>& home_values = parser.home->params;
    file.home = GeodeticPoint{home_values[4], home_values[5], home_values[6]};
    file.home_name = "item 0";
  }
  return file;
}

}  // namespace skycap::flight
