#include "missions/config/fleet.h"

#include <algorithm>
#include <cmath>

#include "missions/config/mission_flight.h"
#include "missions/config/mission_priors.h"
#include "missions/config/mission_rules.h"
#include "missions/support/number_text.h"

namespace skycap::missions::config {
namespace {

using Eigen::Vector3d;

/// Keys that say nothing without several vehicles.
constexpr const char* keys_of_fleets[] = {"flight.pads", "flight.fleet_goal", "flight.separation",
                                          "flight.timing_tolerance"};

/// What two vehicles' places may be off together, and their sizes.
double least_separation(const config::FlightConfig& flight) {
  std::vector<double> radii;
  for (const flight::Vehicle& vehicle : flight.fleet.described) radii.push_back(vehicle.radius);
  std::ranges::sort(radii, std::greater());
  return radii[0] + radii[1] + 2.0 * (flight.position_error + flight.tracking_error);
}

void check_pads_given(const config::MissionFile& given) {
  const config::FlightConfig& flight = given.mission.flight;
  const std::vector<Vector3d>& pads = flight.fleet.pads;
  if (pads.empty()) return;
  if (pads.size() != flight.fleet.vehicles.size()) {
    given.refuse("flight.pads", "has " + std::to_string(pads.size()) + " pads for the " +
                                    std::to_string(flight.fleet.vehicles.size()) +
                                    " of flight.vehicles; give one for each");
  }
  if (flight.takeoff && *flight.takeoff != pads.front()) {
    given.refuse("flight.takeoff", "is not the first of flight.pads; leave it out");
  }
}

}  // namespace

bool is_fleet(const config::Mission& mission) { return mission.flight.fleet.vehicles.size() > 1; }

std::vector<Vector3d> pads_of_fleet(const config::Mission& mission, const Vector3d& first) {
  const config::FleetConfig& fleet = mission.flight.fleet;
  if (!fleet.pads.empty()) return fleet.pads;
  const Eigen::AlignedBox3d box = unknown_box_of(mission);
  const bool is_west_or_east = first.x() < box.min().x() || first.x() > box.max().x();
  const Vector3d along = is_west_or_east ? Vector3d::UnitY() : Vector3d::UnitX();
  std::vector<Vector3d> pads{first};
  for (std::size_t i = 1; i < fleet.vehicles.size(); ++i) {
    const double side = i % 2 == 1 ? 1.0 : -1.0;
    const double steps = static_cast<double>((i + 1) / 2);
    Vector3d pad = first + side * steps * (fleet.separation + 1.0) * along;
    pad.z() = ground_at(mission, pad.head<2>());
    pads.push_back(pad);
  }
  return pads;
}

config::Mission as_flown_by(const config::Mission& mission, std::size_t vehicle,
                            const Vector3d& pad) {
  config::Mission own = mission;
  own.flight.vehicle = mission.flight.fleet.vehicles.at(vehicle);
  own.flight.described = mission.flight.fleet.described.at(vehicle);
  own.flight.takeoff = pad;
  own.flight.order = config::VisitOrder::survey;
  own.flight.fleet = {};
  return own;
}

config::Mission with_vehicles(config::Mission mission, const std::vector<std::size_t>& kept,
                              const std::vector<Vector3d>& pads) {
  const config::FleetConfig all = mission.flight.fleet;
  config::FleetConfig& fleet = mission.flight.fleet;
  fleet.vehicles.clear(), fleet.described.clear(), fleet.pads.clear();
  for (const std::size_t v : kept) {
    fleet.vehicles.push_back(all.vehicles.at(v));
    fleet.described.push_back(all.described.at(v));
    fleet.pads.push_back(pads.at(v));
  }
  mission.flight.vehicle = fleet.vehicles.front();
  mission.flight.described = fleet.described.front();
  mission.flight.takeoff = fleet.pads.front();
  if (kept.size() == 1) fleet = {};
  return mission;
}

flight::SeparationRule separation_of(const config::Mission& mission) {
  const config::FleetConfig& fleet = mission.flight.fleet;
  return {.distance = fleet.separation, .tolerance = fleet.timing_tolerance};
}

void lead_fleet(config::MissionFile& given) {
  config::FlightConfig& flight = given.mission.flight;
  config::FleetConfig& fleet = flight.fleet;
  if (fleet.vehicles.empty()) {
    for (const char* key : keys_of_fleets) {
      if (given.gives(key)) given.refuse(key, "is for several vehicles; give flight.vehicles");
    }
    return;
  }
  if (flight.is_flown() && flight.vehicle != fleet.vehicles.front()) {
    given.refuse("flight.vehicle", "is not the first of flight.vehicles; leave it out");
  }
  check_pads_given(given);
  flight.vehicle = fleet.vehicles.front();
  flight.described = fleet.described.front();
  if (!fleet.pads.empty()) flight.takeoff = fleet.pads.front();
  if (fleet.vehicles.size() == 1) fleet = {};
}

void check_fleet(const config::MissionFile& given) {
  if (!is_fleet(given.mission)) return;
  if (!has_place(given.mission)) {
    given.refuse("flight.vehicles",
                 "needs a place on the Earth: vehicles are kept apart as their route files say; "
                 "give site.latitude_deg and site.longitude_deg");
  }
  const config::FlightConfig& flight = given.mission.flight;
  if (flight.style != flight::FlightStyle::stop) {
    given.refuse("flight.style",
                 "several vehicles are kept apart as they fly from stop to stop; "
                 "leave the key out");
  }
  if (const double least = least_separation(flight); flight.fleet.separation < least) {
    given.refuse("flight.separation",
                 "is less than two vehicles' radii, position and tracking errors make together, " +
                     support::short_text(least) + " m; make it larger");
  }
  for (std::size_t v = 1; v < flight.fleet.vehicles.size(); ++v) {
    config::MissionFile own = given;
    own.mission = as_flown_by(given.mission, v, flight.takeoff.value_or(Vector3d::Zero()));
    check_flight(own);
  }
}

}  // namespace skycap::missions::config
