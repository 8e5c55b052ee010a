#include "missions/package/fleet_mission.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "flight/fleet/fleet_costs.h"
#include "flight/fleet/fleet_split.h"
#include "flight/fleet/timetable.h"
#include "flight/space/place_text.h"
#include "geometry/error.h"
#include "missions/derived/fleet.h"
#include "missions/derived/mission_flight.h"
#include "missions/fleet/timetable_proof.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;

/// How often stations are shared out anew by what certified legs take.
constexpr int most_rounds = 6;

constexpr double never = std::numeric_limits<double>::infinity();

/// Plans a fleet's routes.
class FleetPlanner {
 public:
  FleetPlanner(const file::Mission& mission, const flight::MeasuredSpace& measured,
               const flight::Route& alone, std::span<const flight::PadGround> grounds,
               std::stop_token stop)
      : mission_(mission),
        measured_(measured),
        stations_(alone.stations),
        grounds_(grounds),
        stop_(std::move(stop)) {
    for (flight::Station& station : stations_) station.way.clear();  // of the survey's order
    const std::vector<Vector3d> pads = derived::pads_of_fleet(mission, alone.options.takeoff);
    for (std::size_t v = 0; v < pads.size(); ++v) {
      file::Mission own = derived::as_flown_by(mission, v, pads[v]);
      const flight::FleetMember member = member_of(own, pads[v]);
      problem_.vehicles.push_back(straight_costs(stations_, member));
      least_.vehicles.push_back(least_costs(stations_, member));
      members_.push_back({std::move(own), pads[v], {}, {}});
    }
  }

  FleetMission plan() {
    FleetMission best;
    for (int round = 0; round < most_rounds; ++round) {
      const flight::FleetSplit split = flight::share_among(problem_, order(), goal());
      if (split.parts.empty() && !stations_.empty() && drop_unreached()) continue;
      FleetMission fleet = certified(split);
      const bool is_complete = learn(fleet, split);
      const bool is_better = best.members.empty() || worth(fleet) < worth(best);
      if (is_complete && is_better) {
        best = std::move(fleet);
      } else if (is_complete) {
        break;  // what was learned does not help
      }
    }
    if (best.members.empty()) {
      throw Error(ErrorKind::bad_config,
                  "the stations cannot be shared out among flight.vehicles: too many of them are "
                  "out of reach for one or the other");
    }
    best.unreached = std::move(unreached_);
    best.bound = fleet_bound(least_);
    return best;
  }

 private:
  static flight::FleetMember member_of(const file::Mission& own, const Vector3d& pad) {
    return {
        flight::Motion(derived::vehicle_of(own), derived::route_options_of(own, pad).conditions),
        pad, derived::takeoff_climb_of(own)};
  }

  flight::FleetGoal goal() const { return mission_.flight.fleet.goal; }

  double worth(const FleetMission& fleet) const {
    return goal() == flight::FleetGoal::makespan ? fleet.makespan : fleet.flown;
  }

  /// Of all stations that some vehicle reaches: that of the route through all.
  std::vector<std::uint32_t> order() const {
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < stations_.size(); ++i) {
      if (!is_dropped_.contains(i)) order.push_back(i);
    }
    return order;
  }

  /// Takes stations out that no vehicle can serve; whether there are any.
  bool drop_unreached() {
    const std::size_t before = is_dropped_.size();
    for (const std::uint32_t i : order()) {
      const std::vector<std::uint32_t> one{i};
      const bool is_served = std::ranges::any_of(problem_.vehicles, [&](const auto& vehicle) {
        return flight::part_time(vehicle, one) < never;
      });
      if (is_served) continue;
      is_dropped_.insert(i);
      unreached_.push_back({stations_[i], why_[i]});
    }
    return is_dropped_.size() > before;
  }

  FleetMission certified(const flight::FleetSplit& split) const {
    FleetMission fleet{.members = members_};
    for (std::size_t v = 0; v < split.parts.size(); ++v) {
      std::vector<flight::Station> own;
      for (const std::uint32_t i : split.parts[v].stations) own.push_back(stations_[i]);
      if (own.empty()) continue;
      FleetMember& member = fleet.members[v];
      member.route =
          plan_flight(member.mission, measured_, member.pad, std::move(own), grounds_, stop_);
      fleet.flown += member.route.duration;
      fleet.makespan = std::max(fleet.makespan, member.route.duration);
    }
    return fleet;
  }

  /// Puts what certified routes take in the place of estimates; whether every station is in one.
  bool learn(const FleetMission& fleet, const flight::FleetSplit& split) {
    bool is_complete = true;
    std::map<std::uint32_t, std::uint32_t> station_of;  // by view
    for (std::uint32_t i = 0; i < stations_.size(); ++i) station_of[stations_[i].view_index] = i;
    for (std::size_t v = 0; v < split.parts.size(); ++v) {
      const flight::Route& route = fleet.members[v].route;
      flight::FleetVehicle& costs = problem_.vehicles[v];
      const auto index = [&](const flight::Station& station) {
        return station_of.at(station.view_index);
      };
      for (std::size_t i = 0; i + 1 < route.stations.size(); ++i) {
        flight::PartCost& leg = costs.leg(index(route.stations[i]), index(route.stations[i + 1]));
        leg = {route.legs[i].duration, route.legs[i].energy, route.legs[i].emergency};
      }
      for (const flight::Unreached& missed : route.unreached) {
        const std::uint32_t i = index(missed.station);
        costs.out[i].energy = never;  // no battery is enough
        why_[i] = missed.reason;
        is_complete = false;
      }
    }
    return is_complete;
  }

  const file::Mission& mission_;
  const flight::MeasuredSpace& measured_;
  std::vector<flight::Station> stations_;
  std::span<const flight::PadGround> grounds_;
  std::stop_token stop_;
  std::vector<FleetMember> members_;
  flight::FleetProblem problem_, least_;
  std::set<std::uint32_t> is_dropped_;
  std::map<std::uint32_t, std::string> why_;
  std::vector<flight::Unreached> unreached_;
};

/// Every sortie as its own autopilot's file has it.
std::vector<flight::FleetSortie> sorties_of(FleetMission& fleet) {
  std::vector<flight::FleetSortie> sorties;
  for (std::size_t v = 0; v < fleet.members.size(); ++v) {
    const FleetMember& member = fleet.members[v];
    const flight::Format format = fleet::own_format(derived::vehicle_of(member.mission).dialect);
    const std::size_t count = member.route.sorties.size();
    for (std::size_t i = 0; i < count; ++i) {
      const std::string number = count > 1 ? "-" + std::to_string(i + 1) : "";
      const std::string name = fleet::stem_of(v) + number;
      const flight::FlightPlan plan =
          flight_plan(member.route, i, name, derived::site_of(member.mission),
                      derived::flight_rules(member.mission));
      sorties.push_back({v, i,
                         fleet::flown_file(member.mission, write(plan, format), format).script,
                         plan.vehicle.mode.jerk});
      fleet.timetable.push_back({v, member.mission.flight.vehicle, i,
                                 name + flight::format_info(format).ending, 0.0, 0.0, member.pad});
    }
  }
  return sorties;
}

/// Throws Error{bad_config} if a vehicle flies too low over another one's pad.
void check_pads(const FleetMission& fleet, const std::vector<flight::FleetSortie>& sorties) {
  for (const flight::FleetSortie& sortie : sorties) {
    for (std::size_t v = 0; v < fleet.members.size(); ++v) {
      if (v == sortie.vehicle) continue;
      const double distance = distance_from(sortie.script, fleet.members[v].pad);
      if (distance >= fleet.members[v].mission.flight.clearance) continue;
      throw Error(ErrorKind::bad_config, "vehicle " + std::to_string(sortie.vehicle + 1) +
                                             " comes within " + flight::length_text(distance) +
                                             " of the pad of vehicle " + std::to_string(v + 1) +
                                             "; give other places in flight.pads");
    }
  }
}

void make_timetable(const file::Mission& mission, FleetMission& fleet) {
  const std::vector<flight::FleetSortie> sorties = sorties_of(fleet);
  check_pads(fleet, sorties);
  const flight::SeparationRule rule = derived::separation_of(mission);
  const flight::Timetable table = timetable(sorties, fleet.members.size(), rule);
  std::vector<flight::TimedFlight> flights;
  for (std::size_t i = 0; i < sorties.size(); ++i) {
    flights.push_back({sorties[i].script, sorties[i].jerk, table.starts[i]});
    fleet.timetable[i].start = table.starts[i];
    fleet.timetable[i].landing = flights[i].landing();
  }
  fleet.makespan = table.makespan;
  fleet.delay = table.delay;
  fleet.distance = reported_distance;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    for (std::size_t j = i + 1; j < flights.size(); ++j) {
      if (sorties[i].vehicle == sorties[j].vehicle) continue;
      fleet.distance = std::min(fleet.distance, proven_distance(flights[i], flights[j],
                                                                rule.tolerance, reported_distance));
    }
  }
}

void stage_fleet(FleetMission& fleet, const flight::MeasuredSpace& measured,
                 std::span<const flight::Format> formats, geometry::OutputFolder& folder) {
  for (std::size_t v = 0; v < fleet.members.size(); ++v) {
    FleetMember& member = fleet.members[v];
    if (member.route.sorties.empty()) continue;
    const flight::Format own = fleet::own_format(derived::vehicle_of(member.mission).dialect);
    std::vector<flight::Format> all(formats.begin(), formats.end());
    if (std::ranges::find(all, own) == all.end()) all.push_back(own);
    member.files =
        stage_flight(member.mission, member.route, measured, all, folder, fleet::stem_of(v));
  }
  for (const fleet::TimetableRow& row : fleet.timetable) {
    if (!folder.staged(row.file).empty()) continue;
    std::string why;
    for (const std::string& note : fleet.members[row.vehicle].files.notes) why += "; " + note;
    throw Error(ErrorKind::bad_config, "vehicle " + std::to_string(row.vehicle + 1) +
                                           " of the fleet has no " + row.file + why);
  }
  folder.write(fleet::timetable_name, fleet::timetable_csv(fleet.timetable));
}

}  // namespace

FleetMission plan_fleet(const file::Mission& mission, const flight::MeasuredSpace& measured,
                        const flight::Route& alone, std::span<const flight::PadGround> grounds,
                        std::stop_token stop) {
  FleetMission fleet = FleetPlanner(mission, measured, alone, grounds, std::move(stop)).plan();
  make_timetable(mission, fleet);
  return fleet;
}

std::shared_ptr<const FleetMission> staged_fleet(
    const file::Mission& mission, const flight::MeasuredSpace& measured, const flight::Route& alone,
    std::span<const flight::PadGround> grounds, std::span<const flight::Format> formats,
    geometry::OutputFolder& folder, std::stop_token stop) {
  auto fleet = std::make_shared<FleetMission>(
      plan_fleet(mission, measured, alone, grounds, std::move(stop)));
  stage_fleet(*fleet, measured, formats, folder);
  return fleet;
}

}  // namespace skycap::missions::package
