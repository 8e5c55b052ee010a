#include "missions/package/fleet_mission.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "flight/fleet/fleet_split.h"
#include "flight/fleet/learned_costs.h"
#include "flight/fleet/timetable.h"
#include "flight/space/interruptible_space.h"
#include "flight/space/place_text.h"
#include "geometry/error.h"
#include "missions/derived/fleet.h"
#include "missions/derived/mission_flight.h"
#include "missions/fleet/timetable_proof.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;

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

/// How often stations are shared out anew by what certified legs take, at most and without getting
/// better.
constexpr int most_rounds = 30, most_in_vain = 6;

constexpr double never = std::numeric_limits<double>::infinity();

using Order = std::vector<std::uint32_t>;

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
      members_.push_back({derived::as_flown_by(mission, v, pads[v]), pads[v], {}, {}});
    }
    std::vector<flight::FleetMember> members = costed();
    for (const flight::FleetMember& member : members) {
      least_.vehicles.push_back(least_costs(stations_, member));
    }
    costs_.emplace(stations_, std::move(members));
    Order all(stations_.size());
    std::iota(all.begin(), all.end(), 0U);
    costs_->learn(0, alone, all);
    certified_.resize(pads.size());
  }

  FleetMission plan() {
    FleetMission best;
    for (int round = 0, in_vain = 0; round < most_rounds && in_vain < most_in_vain; ++round) {
      const flight::FleetSplit split = flight::share_among(costs_->problem(), order(), goal());
      if (split.parts.empty() && !stations_.empty() && drop_unreached()) continue;
      const bool is_new = certify(split);
      if (!learn(split)) continue;
      FleetMission fleet = fleet_of(split);
      const auto is_best = [&] { return best.members.empty() || worth(fleet) < worth(best); };
      if (is_best()) make_timetable(mission_, fleet);  // lands nobody sooner
      const bool is_better = is_best();
      in_vain = is_better ? 0 : in_vain + 1;
      if (is_better) best = std::move(fleet);
      if (!is_new) break;  // nothing is left to be learned
    }
    if (best.members.empty()) {
      throw Error(ErrorKind::bad_config,
                  "the stations cannot be shared out among flight.vehicles: too many of them are "
                  "out of reach for one or the other");
    }
    best.unreached = std::move(unreached_);
    best.bound = fleet_bound(least_, best.makespan);
    return best;
  }

 private:
  /// The vehicles with what is known of the lines that they might fly.
  std::vector<flight::FleetMember> costed() const {
    std::vector<flight::FleetMember> costed;
    for (const FleetMember& member : members_) {
      const file::Mission& own = member.mission;
      const flight::RouteOptions options = derived::route_options_of(own, member.pad);
      costed.push_back({flight::Motion(derived::vehicle_of(own), options.conditions), member.pad,
                        derived::takeoff_climb_of(own)});
      const flight::KnownSpace known(derived::flight_rules(own));
      const flight::JointSpace joint({&measured_, &known});
      const flight::InterruptibleSpace space(joint, stop_);
      const double clearance = options.clearance.total();
      flight::Shortfalls& shortfalls = costed.back().shortfalls;
      shortfalls.home = home_shortfalls(stations_, costed.back().home(), space, clearance);
      const bool is_like_first = costed.size() > 1 && own.flight.vehicle == mission_.flight.vehicle;
      shortfalls.legs = is_like_first ? costed.front().shortfalls.legs
                                      : leg_shortfalls(stations_, space, clearance);
    }
    return costed;
  }

  flight::FleetGoal goal() const { return mission_.flight.fleet.goal; }

  double worth(const FleetMission& fleet) const {
    return goal() == flight::FleetGoal::makespan ? fleet.makespan : fleet.flown;
  }

  /// Of all stations that some vehicle reaches: that of the route through all.
  Order order() const {
    Order order;
    for (std::uint32_t i = 0; i < stations_.size(); ++i) {
      if (!is_dropped_.contains(i)) order.push_back(i);
    }
    return order;
  }

  /// Takes stations out that no vehicle can serve; whether there are any.
  bool drop_unreached() {
    const std::size_t before = is_dropped_.size();
    for (const std::uint32_t i : order()) {
      const Order one{i};
      const bool is_served = std::ranges::any_of(
          costs_->problem().vehicles,
          [&](const auto& vehicle) { return flight::part_time(vehicle, one) < never; });
      if (is_served) continue;
      is_dropped_.insert(i);
      unreached_.push_back({stations_[i], why_[i]});
    }
    return is_dropped_.size() > before;
  }

  /// Plans and certifies the routes that have not been, each once; whether there were any.
  bool certify(const flight::FleetSplit& split) {
    bool is_new = false;
    for (std::size_t v = 0; v < split.parts.size(); ++v) {
      const Order& part = split.parts[v].stations;
      if (part.empty() || certified_[v].contains(part)) continue;
      std::vector<flight::Station> own;
      for (const std::uint32_t i : part) own.push_back(stations_[i]);
      certified_[v][part] = plan_flight(members_[v].mission, measured_, members_[v].pad,
                                        std::move(own), grounds_, stop_);
      is_new = true;
    }
    return is_new;
  }

  /// Puts what certified routes take in the place of estimates; whether every station is in one.
  bool learn(const flight::FleetSplit& split) {
    bool is_complete = true;
    std::map<std::uint32_t, std::uint32_t> station_of;  // by view
    for (std::uint32_t i = 0; i < stations_.size(); ++i) station_of[stations_[i].view_index] = i;
    for (std::size_t v = 0; v < split.parts.size(); ++v) {
      if (split.parts[v].stations.empty()) continue;
      const flight::Route& route = certified_[v].at(split.parts[v].stations);
      Order flown;
      for (const flight::Station& station : route.stations) {
        flown.push_back(station_of.at(station.view_index));
      }
      costs_->learn(v, route, flown);
      for (const flight::Unreached& missed : route.unreached) {
        const std::uint32_t i = station_of.at(missed.station.view_index);
        costs_->refuse(v, i);
        why_[i] = missed.reason;
        is_complete = false;
      }
    }
    return is_complete;
  }

  FleetMission fleet_of(const flight::FleetSplit& split) const {
    FleetMission fleet{.members = members_};
    for (std::size_t v = 0; v < split.parts.size(); ++v) {
      if (split.parts[v].stations.empty()) continue;
      flight::Route& route = fleet.members[v].route;
      route = certified_[v].at(split.parts[v].stations);
      fleet.flown += route.duration;
      fleet.makespan = std::max(fleet.makespan, route.duration);
    }
    return fleet;
  }

  const file::Mission& mission_;
  const flight::MeasuredSpace& measured_;
  std::vector<flight::Station> stations_;
  std::span<const flight::PadGround> grounds_;
  std::stop_token stop_;
  std::vector<FleetMember> members_;
  std::optional<flight::LearnedCosts> costs_;
  flight::FleetProblem least_;
  std::vector<std::map<Order, flight::Route>> certified_;  ///< by vehicle
  std::set<std::uint32_t> is_dropped_;
  std::map<std::uint32_t, std::string> why_;
  std::vector<flight::Unreached> unreached_;
};

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
  return FleetPlanner(mission, measured, alone, grounds, std::move(stop)).plan();
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
