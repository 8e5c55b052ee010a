#include "missions/package/fleet_mission.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "flight/clearance/interruptible_space.h"
#include "flight/clearance/position_text.h"
#include "flight/fleet/fleet_split.h"
#include "flight/fleet/timetable.h"
#include "flight/fleet/verified_costs.h"
#include "geometry/error.h"
#include "missions/package/fleet/timetable_verification.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;

/// Routes of a vehicle: the same tour in both directions.
using Variants = std::vector<flight::Route>;

/// Sorties and their rows in the timetable.
struct RowedSorties {
  std::vector<flight::FleetSortie> sorties;
  std::vector<TimetableRow> rows;
};

/// Returns the sorties of all variants, as in the file for the vehicle's own autopilot.
RowedSorties collect_sorties(const FleetMission& fleet, const std::vector<Variants>& variants) {
  RowedSorties all;
  const auto add = [&](std::size_t v, std::size_t variant, std::size_t i) {
    const flight::FlightOptions& own = fleet.members[v].flight;
    const flight::Route& route = variants[v][variant];
    const flight::Format format = own_format(own.required_vehicle());
    const std::string number = route.sorties.size() > 1 ? "-" + std::to_string(i + 1) : "";
    const std::string name = make_stem(v) + number;
    const flight::FlightPlan plan = flight_plan(route, i, name, own.site, own.rules());
    all.sorties.push_back({v, i, interpret_flight_file(own, write(plan, format), format).script,
                           plan.vehicle.mode.jerk, variant});
    all.rows.push_back({v, own.vehicle_name, i, name + flight::format_info(format).extension, 0.0,
                        0.0, fleet.members[v].pad});
  };
  for (std::size_t v = 0; v < variants.size(); ++v) {
    for (std::size_t k = 0; k < variants[v].size(); ++k) {
      for (std::size_t i = 0; i < variants[v][k].sorties.size(); ++i) add(v, k, i);
    }
  }
  return all;
}

/// Throws Error{bad_config} if a vehicle violates the clearance above the pad of another one.
void check_pads(const FleetMission& fleet, const std::vector<flight::FleetSortie>& sorties) {
  for (const flight::FleetSortie& sortie : sorties) {
    for (std::size_t v = 0; v < fleet.members.size(); ++v) {
      if (v == sortie.vehicle) continue;
      const double distance = distance_from(sortie.script, fleet.members[v].pad);
      if (distance >= fleet.members[v].flight.clearance) continue;
      throw Error(ErrorKind::bad_config,
                  "vehicle " + std::to_string(sortie.vehicle + 1) + " comes within " +
                      flight::length_text(distance) + " of the take-off point of vehicle " +
                      std::to_string(v + 1) + "; set other positions in flight.pads");
    }
  }
}

/// Selects the variant and the take-off times of each vehicle that minimise the last landing time.
void make_timetable(const flight::SeparationRule& rule, std::vector<Variants> variants,
                    FleetMission& fleet) {
  RowedSorties all = collect_sorties(fleet, variants);
  const flight::Timetable table = timetable(all.sorties, fleet.members.size(), rule);
  std::vector<flight::FleetSortie> sorties;
  std::vector<flight::TimedFlight> flights;
  for (std::size_t i = 0; i < all.sorties.size(); ++i) {
    flight::FleetSortie& sortie = all.sorties[i];
    if (sortie.variant != table.variants[sortie.vehicle]) continue;
    flights.push_back({sortie.script, sortie.jerk, table.starts[i]});
    fleet.timetable.push_back(std::move(all.rows[i]));
    fleet.timetable.back().start = table.starts[i];
    fleet.timetable.back().landing = flights.back().landing();
    sorties.push_back(std::move(sortie));
  }
  for (std::size_t v = 0; v < variants.size(); ++v) {
    if (variants[v].empty()) continue;
    fleet.members[v].route = std::move(variants[v][table.variants[v]]);
    fleet.total_flight_time += fleet.members[v].route.duration;
  }
  check_pads(fleet, sorties);
  fleet.makespan = table.makespan;
  fleet.delay = table.delay;
  fleet.distance = reported_distance;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    for (std::size_t j = i + 1; j < flights.size(); ++j) {
      if (sorties[i].vehicle == sorties[j].vehicle) continue;
      fleet.distance =
          std::min(fleet.distance,
                   verified_distance(flights[i], flights[j], rule.tolerance, reported_distance));
    }
  }
}

/// Free space of a whole fleet.
class FleetSpace {
 public:
  FleetSpace(flight::Obstacles rules, const flight::FreeSpace& measured, std::stop_token stop)
      : known_(std::move(rules)), joint_({&measured, &known_}), space_(joint_, std::move(stop)) {}

  const flight::FreeSpace& space() const { return space_; }

 private:
  flight::KnownSpace known_;
  flight::JointSpace joint_;
  flight::InterruptibleSpace space_;
};

std::vector<flight::FleetMember> to_fleet_members(const std::vector<FleetMember>& members) {
  std::vector<flight::FleetMember> fleet_members;
  fleet_members.reserve(members.size());
  for (const FleetMember& member : members) {
    fleet_members.push_back({member.flight.required_vehicle(), member.flight.route(member.pad)});
  }
  return fleet_members;
}

/// Returns the stations that at least one vehicle can reach, in the order of the route through all.
std::vector<std::uint32_t> compute_order(const std::vector<flight::CapturePoint>& capture_points,
                                         const std::vector<flight::Unreached>& unreached) {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < capture_points.size(); ++i) {
    const bool is_missed = std::ranges::any_of(unreached, [&](const flight::Unreached& missed) {
      return missed.capture_point.view_index == capture_points[i].view_index;
    });
    if (!is_missed) order.push_back(i);
  }
  return order;
}

/// Divides the stations until all legs of the division are verified. A quick search first
/// determines the relevant legs. Throws Error{bad_config} if no division exists.
flight::FleetSplit share(flight::FleetGoal goal, flight::VerifiedCosts& costs,
                         const std::vector<std::uint32_t>& order, unsigned threads) {
  flight::FleetSplit split;
  for (const std::size_t chains : {std::size_t{1}, flight::thorough}) {
    do {
      split = flight::share_among(costs.problem(), order, goal, chains, threads);
    } while (costs.verify_legs(split));
  }
  if (!split.parts.empty()) return split;
  throw Error(ErrorKind::bad_config,
              "the views cannot be distributed among flight.vehicles: at least one of the vehicles "
              "cannot reach enough of them");
}

}  // namespace

FleetMission plan_fleet(const flight::FlightOptions& options, const flight::FreeSpace& measured,
                        const flight::Route& alone,
                        std::span<const flight::LandingSurface> landing_surfaces, unsigned threads,
                        const std::stop_token& stop, const FleetOrders* orders) {
  FleetMission fleet;
  const std::vector<Vector3d> pads = options.fleet_pads(alone.options.takeoff);
  for (std::size_t v = 0; v < pads.size(); ++v) {
    fleet.members.push_back({options.for_vehicle(v, pads[v]), pads[v], {}, {}});
  }
  const FleetSpace free(options.rules(), measured, stop);
  flight::VerifiedCosts costs(alone.capture_points, to_fleet_members(fleet.members), free.space(),
                              threads);
  fleet.unreached = costs.unreached();
  flight::FleetSplit split;
  if (orders != nullptr) {
    for (const std::vector<std::uint32_t>& order : *orders) split.parts.push_back({order, 0.0});
    costs.verify_legs(split);
  } else {
    split = share(options.fleet.goal, costs, compute_order(alone.capture_points, fleet.unreached),
                  threads);
  }
  std::vector<Variants> variants(pads.size());
  for (std::size_t v = 0; v < pads.size(); ++v) {
    std::vector<std::uint32_t> order = split.parts[v].capture_points;
    for (int turns = 0; turns < 2 && !order.empty(); ++turns, std::ranges::reverse(order)) {
      const FleetMember& member = fleet.members[v];
      variants[v].push_back(plan_flight(member.flight, measured, member.pad,
                                        costs.ordered_capture_points(v, order), landing_surfaces,
                                        stop));
    }
  }
  make_timetable(options.fleet.rule(), std::move(variants), fleet);
  fleet.bound = fleet_bound(costs.problem(), fleet.makespan);
  fleet.lower_bound = fleet_bound(costs.lower_bound(), fleet.makespan);
  return fleet;
}

void stage_fleet(const std::string& name, FleetMission& fleet, const flight::FreeSpace& measured,
                 std::span<const flight::Format> formats, geometry::OutputFolder& folder) {
  for (std::size_t v = 0; v < fleet.members.size(); ++v) {
    FleetMember& member = fleet.members[v];
    if (member.route.sorties.empty()) continue;
    const flight::Vehicle& vehicle = member.flight.required_vehicle();
    const flight::Format own = own_format(vehicle);
    const std::span<const flight::Format> asked =
        formats.empty() ? package_formats(vehicle) : formats;
    std::vector<flight::Format> all(asked.begin(), asked.end());
    if (std::ranges::find(all, own) == all.end()) all.push_back(own);
    member.files =
        stage_flight(name, member.flight, member.route, measured, all, folder, make_stem(v));
  }
  for (const TimetableRow& row : fleet.timetable) {
    if (!folder.staged(row.file).empty()) continue;
    std::string reason;
    for (const std::string& note : fleet.members[row.vehicle].files.notes) reason += "; " + note;
    throw Error(ErrorKind::bad_config, "vehicle " + std::to_string(row.vehicle + 1) +
                                           " of the fleet lacks the file " + row.file + reason);
  }
  folder.write(timetable_name, timetable_csv(fleet.timetable));
}

std::shared_ptr<const FleetMission> staged_fleet(
    const std::string& name, const flight::FlightOptions& options,
    const flight::FreeSpace& measured, const flight::Route& alone,
    std::span<const flight::LandingSurface> landing_surfaces,
    std::span<const flight::Format> formats, geometry::OutputFolder& folder, unsigned threads,
    const std::stop_token& stop) {
  auto fleet = std::make_shared<FleetMission>(
      plan_fleet(options, measured, alone, landing_surfaces, threads, stop));
  stage_fleet(name, *fleet, measured, formats, folder);
  return fleet;
}

}  // namespace skycap::missions::package
