#include "flight/interpreter/flight_facts.h"

#include <algorithm>
#include <cmath>

#include "flight/export/scanner_commands.h"

namespace skycap::flight {

FlightFacts make_flight_facts(const FlightPlan& plan) {
  FlightFacts facts;
  facts.site = plan.site;
  facts.pad = plan.pad;
  facts.vehicle = plan.vehicle;
  facts.takeoff_climb = plan.waypoints.front().position.z() - plan.pad.z();
  facts.rally = rally_points(plan);
  facts.cruise_speed = plan.conditions.cruise_speed;
  facts.photo = plan.photo;
  facts.no_fly = plan.no_fly;
  facts.fence = plan.fence;
  bool is_first = true;
  for (const Waypoint& waypoint : plan.waypoints) {
    const bool is_scanned = !commanded_scanner(plan.vehicle.wpml.payload).empty();
    if (waypoint.is_capture_point && waypoint.captures == 0 && is_scanned) {
      facts.views.push_back({waypoint.position, compute_direction({waypoint.yaw, waypoint.pitch})});
    }
    if (!waypoint.is_capture_point || waypoint.captures == 0) continue;
    facts.hold = is_first ? waypoint.hold : std::min(facts.hold, waypoint.hold);
    is_first = false;
    facts.views.push_back({waypoint.position, compute_direction({waypoint.yaw, waypoint.pitch})});
  }
  for (const Waypoint& waypoint : plan.passed) {
    if (waypoint.captures == 0) continue;
    facts.views.push_back({waypoint.position, compute_direction({waypoint.yaw, waypoint.pitch})});
  }
  return facts;
}

}  // namespace skycap::flight
