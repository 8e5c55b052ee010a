#include "tests/flight/interpreter/spoiled.h"

#include <stdexcept>

namespace skycap::flight {
namespace {

const FlightPlan& plan_for(Dialect dialect) {
  static const FlightPlan px4 = sample_plan(vehicle_profile("generic")),
                          ardupilot = sample_plan(vehicle_profile("generic_ardupilot"));
  return dialect == Dialect::px4 ? px4 : ardupilot;
}

}  // namespace

MissionFile sample_file(Dialect dialect) {
  const FlightPlan& plan = plan_for(dialect);
  return dialect == Dialect::px4 ? read_plan(write_plan(plan))
                                 : read_waypoints(write_waypoints(plan));
}

FlightFacts sample_facts(Dialect dialect) { return facts_of(plan_for(dialect)); }

Problems problems_of(const FlownRoute& route) {
  static const KnownSpace space(sample_site()), pad_space(without_ground(sample_site()));
  Problems problems = route.problems;
  const FlownProof proof = prove(route, space, pad_space, 2.0 - rounding_bound, 5.0);
  problems.insert(problems.end(), proof.problems.begin(), proof.problems.end());
  return problems;
}

Problems problems_of(const MissionFile& file, Dialect dialect) {
  return problems_of(interpret(file, sample_facts(dialect)));
}

std::size_t index_of(const MissionFile& file, int command, std::size_t n) {
  for (std::size_t i = 0; i < file.items.size(); ++i) {
    if (file.items[i].command == command && n-- == 0) return i;
  }
  throw std::logic_error("the sample has no such item");
}

std::size_t station_of(const MissionFile& file, std::size_t n) {
  std::size_t i = index_of(file, command::mount_control, n);
  while (file.items[i].command != command::waypoint) ++i;
  return i;
}

std::size_t hold_of(const MissionFile& file, std::size_t n) {
  const std::size_t i = station_of(file, n);
  return file.items[i + 1].command == command::delay ? i + 1 : i;
}

GeodeticPoint place_at(const Eigen::Vector3d& local) {
  return LocalFrame(plan_for(Dialect::px4).site.origin).to_geodetic(local);
}

void move(MissionItem& item, const Eigen::Vector3d& local) {
  const GeodeticPoint place = place_at(local);
  item.params[4] = place.latitude_deg;
  item.params[5] = place.longitude_deg;
  item.params[6] = local.z();
}

}  // namespace skycap::flight
