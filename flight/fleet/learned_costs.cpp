#include "flight/fleet/learned_costs.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "flight/route/leg_certifier.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Pads whose distance is a smaller share of the way to a station see it from the same side.
constexpr double nearby = 0.25;
/// What ways take of the time of their straight line where that is not free, before any is known:
/// as in a block of houses; counts like two that are known.
constexpr double first_detour = 1.4, first_noted = 2.0;

/// The estimate raised by what another part was dearer than its own.
PartCost raised(const PartCost& estimate, const PartCost& cost, const PartCost& own_estimate) {
  return {estimate.time + cost.time - own_estimate.time,
          estimate.energy + cost.energy - own_estimate.energy, cost.emergency};
}

}  // namespace

LearnedCosts::LearnedCosts(std::span<const Station> stations, std::vector<FleetMember> members)
    : members_(std::move(members)), detours_(first_noted * first_detour), noted_(first_noted) {
  for (const Station& station : stations) places_.push_back(station.view.position);
  for (const FleetMember& member : members_) {
    straight_.vehicles.push_back(straight_costs(stations, member));
  }
  problem_ = straight_;
  for (const FleetMember& member : members_) {
    std::vector<State>& states = states_.emplace_back();
    const auto add = [&](const std::vector<double>& shortfalls, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) {
        const bool is_blocked = !shortfalls.empty() && shortfalls[i] > 0.0;
        states.push_back(is_blocked ? State::blocked : State::free);
      }
    };
    add(member.shortfalls.legs, stations.size() * stations.size());
    add(member.shortfalls.home, stations.size());
    add(member.shortfalls.home, stations.size());
  }
  guess_blocked();
}

void LearnedCosts::learn(std::size_t vehicle, const Route& route,
                         std::span<const std::uint32_t> stations) {
  for (std::size_t i = 0; i < route.legs.size(); ++i) {
    learn_leg(vehicle, stations[i], stations[i + 1], cost_of(route.legs[i]));
  }
  const KnownSpace nothing(Obstacles{});
  const std::optional<WaysHome> no_ways_home;
  const FleetMember& member = members_[vehicle];
  const LegCertifier legs(nothing, member.motion, 0.0, no_ways_home);
  for (const Sortie& sortie : route.sorties) {
    learn_end(vehicle, Way::out, stations[sortie.first],
              in_turn(legs.takeoff_cost(member.takeoff_climb), cost_of(sortie.out)));
    learn_end(vehicle, Way::back, stations[sortie.last],
              in_turn(cost_of(sortie.back), legs.landing_cost(member.takeoff_climb)));
  }
  guess_blocked();
}

void LearnedCosts::note_detour(State state, const PartCost& cost, const PartCost& estimate) {
  if (state == State::free || state == State::known || !(estimate.time > 0.0)) return;
  detours_ += cost.time / estimate.time;
  noted_ += 1.0;
}

void LearnedCosts::guess_blocked() {
  const double share = std::max(1.0, detours_ / noted_);
  const std::size_t count = places_.size();
  for (std::size_t v = 0; v < members_.size(); ++v) {
    const auto guess = [&](std::size_t state, const PartCost& estimate, PartCost& cost) {
      if (states_[v][state] != State::blocked) return;
      cost = {share * estimate.time, share * estimate.energy, estimate.emergency};
    };
    const FleetVehicle& straight = straight_.vehicles[v];
    FleetVehicle& costs = problem_.vehicles[v];
    for (std::size_t i = 0; i < count * count; ++i) guess(i, straight.legs[i], costs.legs[i]);
    for (std::size_t i = 0; i < count; ++i) {
      guess(count * count + i, straight.out[i], costs.out[i]);
      guess(count * (count + 1) + i, straight.back[i], costs.back[i]);
    }
  }
}

void LearnedCosts::refuse(std::size_t vehicle, std::uint32_t station) {
  end(vehicle, Way::out, station).energy = std::numeric_limits<double>::infinity();
  states_[vehicle][places_.size() * places_.size() + station] = State::known;
}

void LearnedCosts::learn_leg(std::size_t vehicle, std::uint32_t from, std::uint32_t to,
                             const PartCost& cost) {
  const std::size_t count = places_.size(), ahead = from * count + to, against = to * count + from;
  const PartCost& estimate = straight_.vehicles[vehicle].legs[ahead];
  note_detour(states_[vehicle][ahead], cost, estimate);
  states_[vehicle][ahead] = State::known;
  problem_.vehicles[vehicle].legs[ahead] = cost;
  for (std::size_t v = 0; v < members_.size(); ++v) {
    if (!is_alike(vehicle, v)) continue;
    for (const std::size_t leg : {ahead, against}) {
      if (states_[v][leg] == State::known) continue;
      states_[v][leg] = State::raised;
      problem_.vehicles[v].legs[leg] = raised(straight_.vehicles[v].legs[leg], cost, estimate);
    }
  }
}

void LearnedCosts::learn_end(std::size_t vehicle, Way way, std::uint32_t station,
                             const PartCost& cost) {
  const std::size_t legs = places_.size() * places_.size();
  const auto part = [&](Way which) {
    return legs + (which == Way::out ? 0 : places_.size()) + station;
  };
  const auto estimate_of = [&](std::size_t v, Way which) {
    const FleetVehicle& costs = straight_.vehicles[v];
    return which == Way::out ? costs.out[station] : costs.back[station];
  };
  note_detour(states_[vehicle][part(way)], cost, estimate_of(vehicle, way));
  states_[vehicle][part(way)] = State::known;
  end(vehicle, way, station) = cost;
  for (std::size_t v = 0; v < members_.size(); ++v) {
    if (!is_alike(vehicle, v) || !is_near(vehicle, v, station)) continue;
    for (const Way which : {Way::out, Way::back}) {
      if (states_[v][part(which)] == State::known) continue;
      states_[v][part(which)] = State::raised;
      end(v, which, station) = raised(estimate_of(v, which), cost, estimate_of(vehicle, way));
    }
  }
}

PartCost& LearnedCosts::end(std::size_t vehicle, Way way, std::uint32_t station) {
  FleetVehicle& costs = problem_.vehicles[vehicle];
  return way == Way::out ? costs.out[station] : costs.back[station];
}

bool LearnedCosts::is_alike(std::size_t vehicle, std::size_t other) const {
  return members_[vehicle].motion.vehicle().name == members_[other].motion.vehicle().name;
}

bool LearnedCosts::is_near(std::size_t vehicle, std::size_t other, std::uint32_t station) const {
  const Vector3d own = members_[vehicle].home(), its = members_[other].home();
  return (own - its).norm() <= nearby * (places_[station] - own).norm();
}

}  // namespace skycap::flight
