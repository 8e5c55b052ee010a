#include <cmath>

#include "flight/export/mavlink_files.h"

namespace skycap::flight {
namespace {

constexpr std::string_view header = "QGC WPL 110";
constexpr std::size_t fields_per_line = 12;

std::string line(std::size_t index, bool is_current, const MissionItem& item) {
  std::string text = std::to_string(index) + (is_current ? "\t1\t" : "\t0\t") +
                     std::to_string(item.frame) + "\t" + std::to_string(item.command);
  for (std::size_t p = 0; p < item.params.size(); ++p) {
    const double value = std::isnan(item.params[p]) ? 0.0 : item.params[p];
    text += "\t" + (p == 4 || p == 5 ? degrees(value) : fixed(value, 4));
  }
  return text + "\t1\n";
}

/// Checks and reads at once: the items are whole if there are no problems.
struct Reading {
  Problems problems;
  std::vector<MissionItem> items;
  std::optional<MissionItem> home;

  explicit Reading(const std::string& text) {
    const std::vector<std::string> lines = lines_of(text);
    if (lines.empty() || lines[0] != header) {
      problems.emplace_back("line 1 must be \"QGC WPL 110\"");
      return;
    }
    for (std::size_t i = 1; i < lines.size(); ++i) read_line(lines[i], i);
    if (!problems.empty()) return;
    // ArduPilot's files begin with home: a waypoint in absolute height before the take-off.
    const bool has_home =
        !items.empty() && items[0].command == command::waypoint && items[0].frame == frame::global;
    if (!has_home) return;
    home = items.front();
    items.erase(items.begin());
  }

  void read_line(const std::string& text, std::size_t number) {
    const std::string who = "line " + std::to_string(number + 1) + " ";
    const std::vector<std::string> fields = split(text, '\t');
    if (fields.size() != fields_per_line) {
      problems.push_back(who + "has " + std::to_string(fields.size()) +
                         " fields separated by tabs; it must have 12");
      return;
    }
    const std::optional<std::vector<double>> numbers = to_numbers(fields, who, problems);
    if (!numbers) return;
    const std::vector<double>& values = *numbers;
    if (values[0] != static_cast<double>(number - 1)) {
      problems.push_back(who + "has index " + fields[0] + "; it must be " +
                         std::to_string(number - 1));
    }
    if (values[1] != (number == 1 ? 1.0 : 0.0)) {
      problems.push_back(who + "must be current (1) on the first line only");
    }
    for (const std::size_t whole : {2U, 3U, 11U}) {
      if (values[whole] != std::floor(values[whole]) || std::abs(values[whole]) > 1e5) {
        problems.push_back(who + "has \"" + fields[whole] + "\" where an integer belongs");
        return;
      }
    }
    MissionItem item{
        static_cast<int>(values[3]), static_cast<int>(values[2]), {}, values[11] == 1, number - 1};
    std::copy(values.begin() + 4, values.begin() + 11, item.params.begin());
    items.push_back(item);
  }
};

}  // namespace

std::string write_waypoints(const FlightPlan& plan) {
  std::vector<MissionItem> items = mission_items(plan);
  if (plan.vehicle.dialect == Dialect::ardupilot) {
    const GeodeticPoint home = LocalFrame(plan.site.origin).to_geodetic(plan.pad);
    const double amsl = home.height - plan.site.undulation_for("an ArduPilot .waypoints file");
    items.insert(items.begin(),
                 MissionItem{command::waypoint,
                             frame::global,
                             {0, 0, 0, 0, home.latitude_deg, home.longitude_deg, amsl}});
  }
  // No reader agrees with another on NaN. A corner's open yaw becomes that of the stop before it,
  // or of the first station.
  double yaw = 0.0;
  for (auto item = items.rbegin(); item != items.rend(); ++item) {
    if (item->command == command::waypoint && !std::isnan(item->params[3])) yaw = item->params[3];
  }
  for (MissionItem& item : items) {
    if (std::isnan(item.params[3])) item.params[3] = yaw;
    if (item.command == command::waypoint) yaw = item.params[3];
  }
  std::string text = std::string(header) + "\n";
  for (std::size_t i = 0; i < items.size(); ++i) text += line(i, i == 0, items[i]);
  return text;
}

Problems validate_waypoints(const std::string& text, std::optional<Dialect> dialect) {
  Reading reading(text);
  if (!reading.problems.empty()) return reading.problems;
  if (dialect == Dialect::ardupilot && !reading.home) {
    reading.problems.emplace_back("line 2 must be home: frame 0, command 16");
  }
  if (dialect == Dialect::px4 && reading.home) {
    reading.problems.emplace_back("line 2 is a home, which PX4's files do not have");
  }
  for (const std::string& problem : check_items(reading.items, dialect)) {
    reading.problems.push_back(problem);
  }
  return reading.problems;
}

MissionFile read_waypoints(const std::string& text) {
  throw_first(validate_waypoints(text), "not a good .waypoints file");
  const Reading reading(text);
  MissionFile file{.items = reading.items,
                   .dialect = reading.home ? Dialect::ardupilot : Dialect::px4};
  if (reading.home) {
    const std::array<double, 7>& place = reading.home->params;
    file.home = GeodeticPoint{place[4], place[5], place[6]};
    file.home_name = "item 0";
  }
  return file;
}

}  // namespace skycap::flight
