#include "tests/flight/interpreter/spoiled.h"

#include <stdexcept>

namespace skycap::flight {
namespace {

const FlightPlan& plan_for(AutopilotType autopilot) {
  static const FlightPlan px4 = sample_plan(vehicle_profile("generic")),
                          ardupilot = sample_plan(vehicle_profile("generic_ardupilot"));
  return autopilot == AutopilotType::px4 ? px4 : ardupilot;
}

}  // namespace

MavlinkMission sample_file(AutopilotType autopilot) {
  const FlightPlan& plan = plan_for(autopilot);
  return autopilot == AutopilotType::px4 ? read_plan(write_plan(plan))
                                         : read_waypoints(write_waypoints(plan));
}

FlightFacts sample_facts(AutopilotType autopilot) { return make_flight_facts(plan_for(autopilot)); }

Problems find_problems(const InterpretedRoute& route) {
  static const KnownSpace space(sample_site()), pad_space(without_ground(sample_site()));
  Problems problems = route.problems;
  const RouteVerification verification = verify(route, space, pad_space, 2.0 - rounding_bound, 5.0);
  problems.insert(problems.end(), verification.problems.begin(), verification.problems.end());
  return problems;
}

Problems find_problems(const MavlinkMission& file, AutopilotType autopilot) {
  return find_problems(interpret(file, sample_facts(autopilot)));
}

std::size_t find_index(const MavlinkMission& file, int command, std::size_t n) {
  for (std::size_t i = 0; i < file.items.size(); ++i) {
    if (file.items[i].command == command && n-- == 0) return i;
  }
  throw std::logic_error("the sample has no such item");
}

std::size_t find_waypoint(const MavlinkMission& file, std::size_t n) {
  std::size_t i = find_index(file, command::mount_control, n);
  while (file.items[i].command != command::waypoint) ++i;
  return i;
}

std::size_t find_hold(const MavlinkMission& file, std::size_t n) {
  const std::size_t i = find_waypoint(file, n);
  return file.items[i + 1].command == command::delay ? i + 1 : i;
}

GeodeticPoint position_at(const Eigen::Vector3d& local) {
  return LocalFrame(plan_for(AutopilotType::px4).site.origin).to_geodetic(local);
}

void move(MissionItem& item, const Eigen::Vector3d& local) {
  const GeodeticPoint position = position_at(local);
  item.params[4] = position.latitude_deg;
  item.params[5] = position.longitude_deg;
  item.params[6] = local.z();
}

}  // namespace skycap::flight
