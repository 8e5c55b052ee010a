#include "missions/package/fleet_report.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "missions/package/route_json.h"
#include "missions/support/json_text.h"

namespace skycap::missions::package {
namespace {

using support::to_json;
using Json = nlohmann::ordered_json;

/// Returns the relative difference between a value and its lower bound [%].
double gap(double figure, double bound) {
  return bound > 0.0 ? 100.0 * (figure / bound - 1.0) : 0.0;
}

Json to_json(const TimetableRow& row) {
  return {{"vehicle", row.vehicle + 1},
          {"sortie", row.sortie + 1},
          {"file", row.file},
          {"start_s", row.start},
          {"landing_s", row.landing}};
}

Json member_json(const FleetMember& member) {
  Json files = Json::array();
  for (const FlightFile& file : member.files.written) files.push_back(file.name);
  for (const std::string& name : member.files.parameters) files.push_back(name);
  const std::optional<flight::Returns>& returns = member.route.returns;
  return {{"vehicle", member.flight.vehicle_name},
          {"pad", to_json(member.pad)},
          {"order", order_json(member.route)},
          {"sorties", sorties_json(member.route)},
          {"duration_s", member.route.duration},
          {"length_m", member.route.length},
          {"energy_wh", member.route.energy / 3600.0},
          {"min_clearance_m", member.route.min_clearance},
          {"return_height_m", returns ? Json(returns->height) : Json()},
          {"files", files}};
}

}  // namespace

std::string fleet_text(const FleetMission& fleet, bool is_verbose) {
  std::string text = fmt::format(
      "  fleet     {} vehicles, last landing after {:.1f} min, total flight time {:.1f} min\n",
      fleet.members.size(), fleet.makespan / 60.0, fleet.total_flight_time / 60.0);
  if (is_verbose) {
    text += fmt::format(
        "            optimality gap: makespan {:.1f}%, total flight time {:.1f}% (bound for the "
        "verified "
        "legs); makespan {:.1f}%, total flight time {:.1f}% (bound for arbitrary legs)\n",
        gap(fleet.makespan, fleet.bound.makespan),
        gap(fleet.total_flight_time, fleet.bound.total_flight_time),
        gap(fleet.makespan, fleet.lower_bound.makespan),
        gap(fleet.total_flight_time, fleet.lower_bound.total_flight_time));
  }
  text += fmt::format(
      "  separation minimum {:.2f} m at all times, verified; delays the last landing by {:.0f} s\n",
      fleet.distance, fleet.delay);
  for (const TimetableRow& row : fleet.timetable) {
    text +=
        fmt::format("  {:9} take-off at {:.0f} s, landing at {:.0f} s: {}\n",
                    fmt::format("vehicle {}", row.vehicle + 1), row.start, row.landing, row.file);
  }
  return text;
}

Json fleet_json(const FleetMission& fleet, const std::string& goal,
                const flight::SeparationRule& asked) {
  Json vehicles = Json::array(), timetable = Json::array();
  for (const FleetMember& member : fleet.members) vehicles.push_back(member_json(member));
  for (const TimetableRow& row : fleet.timetable) timetable.push_back(to_json(row));
  return {{"goal", goal},
          {"makespan_s", fleet.makespan},
          {"makespan_bound_s", fleet.bound.makespan},
          {"makespan_least_s", fleet.lower_bound.makespan},
          {"flown_s", fleet.total_flight_time},
          {"flown_bound_s", fleet.bound.total_flight_time},
          {"flown_least_s", fleet.lower_bound.total_flight_time},
          {"delay_s", fleet.delay},
          {"separation",
           {{"asked_m", asked.distance},
            {"tolerance_s", asked.tolerance},
            {"proven_m", fleet.distance}}},
          {"vehicles", vehicles},
          {"timetable", timetable},
          {"skipped_views", unreached_json(fleet.unreached)}};
}

}  // namespace skycap::missions::package
