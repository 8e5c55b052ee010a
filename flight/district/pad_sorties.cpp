#include "flight/district/pad_sorties.h"

#include <algorithm>

#include "flight/motion/flight_time_range.h"
#include "flight/route/leg_costs.h"
#include "flight/route/sortie_split.h"
#include "flight/route/tour.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using Indices = std::vector<std::uint32_t>;

/// Maximum number of nodes in a tour, whose cost grows quadratically.
constexpr std::size_t most_in_a_tour = 1000;

/// Returns a short closed tour from the first node, without that node.
Indices tour_of(const std::vector<Vector3d>& places) {
  return plan_tour(static_cast<std::uint32_t>(places.size()),
                   [&](std::uint32_t a, std::uint32_t b) { return (places[a] - places[b]).norm(); })
      .order;
}

/// Returns the waypoints of each target that has any.
std::vector<Indices> by_target(std::span<const std::uint32_t> targets) {
  std::vector<Indices> stations;
  for (std::uint32_t i = 0; i < targets.size(); ++i) {
    if (i == 0 || targets[i] != targets[i - 1]) stations.emplace_back();
    stations.back().push_back(i);
  }
  return stations;
}

/// Returns groups of at most 1000 waypoints, whose targets are consecutive in a tour of the
/// targets.
std::vector<Indices> neighbourhoods(std::span<const Station> stations,
                                    std::span<const std::uint32_t> targets, const Vector3d& start) {
  if (stations.size() <= most_in_a_tour) {
    Indices all;
    for (std::uint32_t i = 0; i < stations.size(); ++i) all.push_back(i);
    return {all};
  }
  const std::vector<Indices> of_target = by_target(targets);
  std::vector<Vector3d> middles{start};
  for (const Indices& own : of_target) {
    Vector3d sum = Vector3d::Zero();
    for (const std::uint32_t i : own) sum += stations[i].view.position;
    middles.emplace_back(sum / static_cast<double>(own.size()));
  }
  std::vector<Indices> found{{}};
  for (const std::uint32_t target : tour_of(middles)) {
    const Indices& own = of_target[target - 1];
    if (!found.back().empty() && found.back().size() + own.size() > most_in_a_tour) {
      found.emplace_back();
    }
    found.back().insert(found.back().end(), own.begin(), own.end());
  }
  return found;
}

Indices ordered(std::span<const Station> stations, std::span<const std::uint32_t> targets,
                Vector3d start) {
  Indices order;
  for (const Indices& near : neighbourhoods(stations, targets, start)) {
    std::vector<Vector3d> places{start};
    for (const std::uint32_t i : near) places.push_back(stations[i].view.position);
    for (const std::uint32_t place : tour_of(places)) order.push_back(near[place - 1]);
    if (!order.empty()) start = stations[order.back()].view.position;
  }
  return order;
}

/// Costs of flight parts along straight lines.
class StraightCosts {
 public:
  StraightCosts(const Motion& motion, double climb)
      : costs_(motion),
        takeoff_(costs_.takeoff_cost(climb)),
        landing_(costs_.landing_cost(climb)) {}

  LegCost out(const Vector3d& home, const Station& to) const {
    return in_turn(takeoff_, leg(home, to.view.position, nullptr, nullptr));
  }
  LegCost back(const Station& from, const Vector3d& home) const {
    return in_turn(leg(from.view.position, home, nullptr, nullptr), landing_);
  }
  LegCost between(const Station& from, const Station& to) const {
    return leg(from.view.position, to.view.position, &from, &to);
  }
  LegCost at(const Station& station) const { return costs_.station_cost(station); }

 private:
  LegCost leg(const Vector3d& a, const Vector3d& b, const Station* from, const Station* to) const {
    return cost_of(costs_.leg({{a, b}}, from, to));
  }

  LegCosts costs_;
  LegCost takeoff_, landing_;
};

}  // namespace

PadSorties sorties_from_pads(std::span<const Station> stations,
                             std::span<const std::uint32_t> targets, std::span<const Vector3d> pads,
                             double climb, const Motion& motion) {
  PadSorties result;
  if (stations.empty() || pads.empty()) return result;
  const StraightCosts costs(motion, climb);
  SplitProblem problem{.pads = std::vector<SplitProblem::Pad>(pads.size()),
                       .energy_per_sortie = plannable_energy(motion),
                       .stations_per_sortie = most_stations(motion.vehicle())};
  const Vector3d up = climb * Vector3d::UnitZ();
  for (const std::uint32_t i : ordered(stations, targets, pads[0] + up)) {
    const Station& station = stations[i];
    bool is_in_reach = false;
    for (std::size_t p = 0; p < pads.size(); ++p) {
      SplitProblem::Pad& pad = problem.pads[p];
      pad.out.push_back(costs.out(pads[p] + up, station));
      pad.back.push_back(costs.back(station, pads[p] + up));
      const LegCost there = in_turn(pad.out.back(), costs.at(station));
      const LegCost total = in_turn(there, pad.back.back());
      is_in_reach =
          is_in_reach || std::max(total.energy, total.emergency) <= problem.energy_per_sortie;
    }
    if (!is_in_reach) {
      result.out_of_reach.push_back(i);
      for (SplitProblem::Pad& pad : problem.pads) pad.out.pop_back(), pad.back.pop_back();
      continue;
    }
    if (!result.order.empty()) {
      const Station& before = stations[result.order.back()];
      problem.leg.push_back(costs.between(before, station));
      result.length += (station.view.position - before.view.position).norm();
    }
    problem.station.push_back(costs.at(station));
    result.order.push_back(i);
  }
  for (const SortieRange& sortie : split_into_sorties(problem).sorties) {
    result.pads.resize(sortie.last + 1, sortie.pad);
  }
  return result;
}

}  // namespace skycap::flight
