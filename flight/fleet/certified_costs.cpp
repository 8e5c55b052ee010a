#include "flight/fleet/certified_costs.h"

#include <algorithm>
#include <limits>
#include <map>
#include <utility>

#include "flight/route/leg_planner.h"
#include "flight/route/route_legs.h"
#include "geometry/parallel.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Number of nearest waypoints to which legs are verified in advance.
constexpr std::size_t near_stations = 10;

}  // namespace

/// Maps the waypoints to the vehicle's own indices.
struct CertifiedCosts::Vehicle {
  Vehicle(const FleetMember& member, const FreeSpace& space)
      : options(member.options), legs(member.vehicle, space, options) {}

  /// Finds the legs from and to the pad for all waypoints.
  void take(const std::vector<Station>& stations) {
    legs.admit(legs.allowed(stations));
    std::map<std::uint32_t, std::size_t> place_of_view;
    for (std::size_t i = 0; i < legs.stations().size(); ++i) {
      legs.give_returns(i);
      place_of_view[legs.stations()[i].view_index] = i;
    }
    for (const Station& station : stations) {
      const auto found = place_of_view.find(station.view_index);
      places.push_back(found == place_of_view.end() ? std::nullopt : std::optional(found->second));
    }
  }

  RouteOptions options;
  RouteLegs legs;
  std::vector<std::optional<std::size_t>> places;  ///< Index in `legs`, by waypoint.
  /// Verified paths, by start and goal.
  std::map<std::pair<std::uint32_t, std::uint32_t>, Way> ways;
};

CertifiedCosts::CertifiedCosts(std::vector<Station> stations,
                               const std::vector<FleetMember>& members, const FreeSpace& space,
                               unsigned threads)
    : stations_(std::move(stations)),
      space_(space),
      threads_(threads),
      clearance_(members.front().options.clearance.total()),
      path_options_(members.front().options.path) {
  for (Station& station : stations_) station.way.clear();  // Paths of a different order.
  for (const FleetMember& member : members) {
    vehicles_.push_back(std::make_unique<Vehicle>(member, space));
  }
  const std::vector<double> between = leg_shortfalls(stations_, space, clearance_);
  least_.vehicles.resize(members.size());
  geometry::parallel_for(members.size(), threads, [&](std::size_t v) {
    vehicles_[v]->take(stations_);
    const Shortfalls shortfalls{home_shortfalls(stations_, members[v].home(), space, clearance_),
                                between};
    least_.vehicles[v] = least_costs(stations_, members[v], shortfalls);
  });
  problem_ = least_;
  for (std::size_t v = 0; v < members.size(); ++v) take_ends(v);
  certify(near_pairs());
}

CertifiedCosts::~CertifiedCosts() = default;

void CertifiedCosts::take_ends(std::size_t vehicle) {
  FleetVehicle& costs = problem_.vehicles[vehicle];
  const RouteLegs& legs = vehicles_[vehicle]->legs;
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    const std::optional<std::size_t> place = vehicles_[vehicle]->places[i];
    if (!place) {
      costs.out[i].energy = std::numeric_limits<double>::infinity();
      continue;
    }
    costs.out[i] = legs.out_cost(*place);
    costs.station[i] = legs.station_cost(*place);
    costs.back[i] = legs.back_cost(*place);
  }
}

std::vector<Unreached> CertifiedCosts::unreached() const {
  std::vector<Unreached> missed;
  for (const Unreached& one : vehicles_.front()->legs.unreached()) {
    const bool is_served = std::ranges::any_of(vehicles_, [&](const auto& vehicle) {
      return std::ranges::any_of(vehicle->legs.stations(), [&](const Station& station) {
        return station.view_index == one.station.view_index;
      });
    });
    if (!is_served) missed.push_back(one);
  }
  return missed;
}

std::vector<CertifiedCosts::Pair> CertifiedCosts::near_pairs() const {
  const auto count = static_cast<std::uint32_t>(stations_.size());
  std::vector<Pair> pairs;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::vector<std::uint32_t> others;
    for (std::uint32_t j = 0; j < count; ++j) {
      if (j != i) others.push_back(j);
    }
    std::ranges::stable_sort(others, {}, [&](std::uint32_t j) {
      return (stations_[j].view.position - stations_[i].view.position).squaredNorm();
    });
    others.resize(std::min(others.size(), near_stations));
    for (const std::uint32_t j : others) pairs.push_back({std::min(i, j), std::max(i, j)});
  }
  return pairs;
}

bool CertifiedCosts::certify(const FleetSplit& split) {
  std::vector<Pair> pairs;
  for (const FleetPart& part : split.parts) {
    for (std::size_t i = 1; i < part.stations.size(); ++i) {
      const auto [low, high] = std::minmax(part.stations[i - 1], part.stations[i]);
      pairs.push_back({low, high});
    }
  }
  return certify(std::move(pairs));
}

bool CertifiedCosts::certify(std::vector<Pair> pairs) {
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::erase_if(pairs, [&](const Pair& pair) { return certified_.contains(pair); });
  const std::vector<Way> ways = found(pairs);
  const std::size_t vehicles = vehicles_.size();
  std::vector<BothWays> legs(pairs.size() * vehicles);
  geometry::parallel_for(legs.size(), threads_, [&](std::size_t k) {
    legs[k] = both_ways(k % vehicles, pairs[k / vehicles], ways[k / vehicles]);
  });
  for (std::size_t k = 0; k < legs.size(); ++k) {
    const auto [low, high] = pairs[k / vehicles];
    take_leg(k % vehicles, low, high, std::move(legs[k].up));
    take_leg(k % vehicles, high, low, std::move(legs[k].down));
  }
  certified_.insert(pairs.begin(), pairs.end());
  return !pairs.empty();
}

/// Returns paths from the lower to the higher index, empty where none was found.
std::vector<CertifiedCosts::Way> CertifiedCosts::found(const std::vector<Pair>& pairs) const {
  std::vector<Way> ways(pairs.size());
  // Each planner has its own distance cache. Therefore few planners are used, each for neighbouring
  // pairs.
  const std::size_t parts = std::min<std::size_t>(geometry::thread_count(threads_), pairs.size());
  geometry::parallel_for(parts, threads_, [&](std::size_t part) {
    LegPlanner planner(space_, clearance_, path_options_);
    for (std::size_t k = part * pairs.size() / parts; k < (part + 1) * pairs.size() / parts; ++k) {
      ways[k] =
          planner
              .path(stations_[pairs[k].low].view.position, stations_[pairs[k].high].view.position)
              .points;
    }
  });
  return ways;
}

CertifiedCosts::BothWays CertifiedCosts::both_ways(std::size_t vehicle, const Pair& pair,
                                                   const Way& way) const {
  const Vehicle& own = *vehicles_[vehicle];
  const std::optional<std::size_t> low = own.places[pair.low], high = own.places[pair.high];
  if (!low || !high) return {};
  const RouteLegs& legs = own.legs;
  std::optional<Leg> up = legs.along(way, *low, *high);
  if (!up) return {legs.by_home(*low, *high), legs.by_home(*high, *low)};
  std::optional<Leg> down = legs.along({up->points.rbegin(), up->points.rend()}, *high, *low);
  if (!down) down = legs.by_home(*high, *low);
  return {std::move(up), std::move(down)};
}

void CertifiedCosts::take_leg(std::size_t vehicle, std::uint32_t from, std::uint32_t to,
                              std::optional<Leg> leg) {
  if (!leg) return;
  problem_.vehicles[vehicle].leg(from, to) = cost_of(*leg);
  vehicles_[vehicle]->ways[{from, to}] = std::move(leg->points);
}

std::vector<Station> CertifiedCosts::stations_of(std::size_t vehicle,
                                                 std::span<const std::uint32_t> order) const {
  std::vector<Station> stations;
  for (std::size_t i = 0; i < order.size(); ++i) {
    stations.push_back(stations_[order[i]]);
    if (i == 0) continue;
    const auto way = vehicles_[vehicle]->ways.find({order[i - 1], order[i]});
    if (way != vehicles_[vehicle]->ways.end()) stations.back().way = way->second;
  }
  return stations;
}

}  // namespace skycap::flight
