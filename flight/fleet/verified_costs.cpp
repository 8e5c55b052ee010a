#include "flight/fleet/verified_costs.h"

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
constexpr std::size_t neighbour_count = 10;

}  // namespace

/// Maps the waypoints to the vehicle's own indices.
struct VerifiedCosts::Vehicle {
  Vehicle(const FleetMember& member, const FreeSpace& space)
      : options(member.options), legs(member.vehicle, space, options) {}

  /// Finds the legs from and to the pad for all waypoints.
  void set_stations(const std::vector<CapturePoint>& capture_points) {
    legs.admit(legs.allowed(capture_points));
    std::map<std::uint32_t, std::size_t> index_by_view;
    for (std::size_t i = 0; i < legs.capture_points().size(); ++i) {
      legs.reroute_for_returns(i);
      index_by_view[legs.capture_points()[i].view_index] = i;
    }
    for (const CapturePoint& capture_point : capture_points) {
      const auto found = index_by_view.find(capture_point.view_index);
      indices.push_back(found == index_by_view.end() ? std::nullopt : std::optional(found->second));
    }
  }

  RouteOptions options;
  RouteLegs legs;
  std::vector<std::optional<std::size_t>> indices;  ///< Index in `legs`, by waypoint.
  /// Verified paths, by start and goal.
  std::map<std::pair<std::uint32_t, std::uint32_t>, Polyline> paths;
};

VerifiedCosts::VerifiedCosts(std::vector<CapturePoint> capture_points,
                             const std::vector<FleetMember>& members, const FreeSpace& space,
                             unsigned threads)
    : capture_points_(std::move(capture_points)),
      space_(space),
      threads_(threads),
      clearance_(members.front().options.clearance.total()),
      path_options_(members.front().options.path) {
  for (CapturePoint& capture_point : capture_points_)
    capture_point.approach_path.clear();  // Paths of a different order.
  for (const FleetMember& member : members) {
    vehicles_.push_back(std::make_unique<Vehicle>(member, space));
  }
  const std::vector<double> between = leg_clearance_deficits(capture_points_, space, clearance_);
  lower_bound_.vehicles.resize(members.size());
  geometry::parallel_for(members.size(), threads, [&](std::size_t v) {
    vehicles_[v]->set_stations(capture_points_);
    const ClearanceDeficits clearance_deficits{
        return_clearance_deficits(capture_points_, members[v].home(), space, clearance_), between};
    lower_bound_.vehicles[v] = lower_bound_costs(capture_points_, members[v], clearance_deficits);
  });
  problem_ = lower_bound_;
  for (std::size_t v = 0; v < members.size(); ++v) add_end_legs(v);
  verify_legs(near_pairs());
}

VerifiedCosts::~VerifiedCosts() = default;

void VerifiedCosts::add_end_legs(std::size_t vehicle) {
  FleetVehicle& costs = problem_.vehicles[vehicle];
  const RouteLegs& legs = vehicles_[vehicle]->legs;
  for (std::size_t i = 0; i < capture_points_.size(); ++i) {
    const std::optional<std::size_t> index = vehicles_[vehicle]->indices[i];
    if (!index) {
      costs.out[i].energy = std::numeric_limits<double>::infinity();
      continue;
    }
    costs.out[i] = legs.out_cost(*index);
    costs.capture_point[i] = legs.capture_cost(*index);
    costs.back[i] = legs.back_cost(*index);
  }
}

std::vector<Unreached> VerifiedCosts::unreached() const {
  std::vector<Unreached> missed;
  for (const Unreached& one : vehicles_.front()->legs.unreached()) {
    const bool is_served = std::ranges::any_of(vehicles_, [&](const auto& vehicle) {
      return std::ranges::any_of(vehicle->legs.capture_points(),
                                 [&](const CapturePoint& capture_point) {
                                   return capture_point.view_index == one.capture_point.view_index;
                                 });
    });
    if (!is_served) missed.push_back(one);
  }
  return missed;
}

std::vector<VerifiedCosts::Pair> VerifiedCosts::near_pairs() const {
  const auto count = static_cast<std::uint32_t>(capture_points_.size());
  std::vector<Pair> pairs;
  for (std::uint32_t i = 0; i < count; ++i) {
    std::vector<std::uint32_t> others;
    for (std::uint32_t j = 0; j < count; ++j) {
      if (j != i) others.push_back(j);
    }
    std::ranges::stable_sort(others, {}, [&](std::uint32_t j) {
      return (capture_points_[j].view.position - capture_points_[i].view.position).squaredNorm();
    });
    others.resize(std::min(others.size(), neighbour_count));
    for (const std::uint32_t j : others) pairs.push_back({std::min(i, j), std::max(i, j)});
  }
  return pairs;
}

bool VerifiedCosts::verify_legs(const FleetSplit& split) {
  std::vector<Pair> pairs;
  for (const FleetPart& part : split.parts) {
    for (std::size_t i = 1; i < part.capture_points.size(); ++i) {
      const auto [low, high] = std::minmax(part.capture_points[i - 1], part.capture_points[i]);
      pairs.push_back({low, high});
    }
  }
  return verify_legs(std::move(pairs));
}

bool VerifiedCosts::verify_legs(std::vector<Pair> pairs) {
  std::ranges::sort(pairs);
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::erase_if(pairs, [&](const Pair& pair) { return verified_.contains(pair); });
  const std::vector<Polyline> paths = found(pairs);
  const std::size_t vehicles = vehicles_.size();
  std::vector<BothDirections> legs(pairs.size() * vehicles);
  geometry::parallel_for(legs.size(), threads_, [&](std::size_t k) {
    legs[k] = both_directions(k % vehicles, pairs[k / vehicles], paths[k / vehicles]);
  });
  for (std::size_t k = 0; k < legs.size(); ++k) {
    const auto [low, high] = pairs[k / vehicles];
    add_leg(k % vehicles, low, high, std::move(legs[k].up));
    add_leg(k % vehicles, high, low, std::move(legs[k].down));
  }
  verified_.insert(pairs.begin(), pairs.end());
  return !pairs.empty();
}

/// Returns paths from the lower to the higher index, empty where none was found.
std::vector<VerifiedCosts::Polyline> VerifiedCosts::found(const std::vector<Pair>& pairs) const {
  std::vector<Polyline> paths(pairs.size());
  // Each planner has its own distance cache. Therefore few planners are used, each for neighbouring
  // pairs.
  const std::size_t parts = std::min<std::size_t>(geometry::thread_count(threads_), pairs.size());
  geometry::parallel_for(parts, threads_, [&](std::size_t part) {
    LegPlanner planner(space_, clearance_, path_options_);
    for (std::size_t k = part * pairs.size() / parts; k < (part + 1) * pairs.size() / parts; ++k) {
      paths[k] = planner
                     .path(capture_points_[pairs[k].low].view.position,
                           capture_points_[pairs[k].high].view.position)
                     .points;
    }
  });
  return paths;
}

VerifiedCosts::BothDirections VerifiedCosts::both_directions(std::size_t vehicle, const Pair& pair,
                                                             const Polyline& approach_path) const {
  const Vehicle& own = *vehicles_[vehicle];
  const std::optional<std::size_t> low = own.indices[pair.low], high = own.indices[pair.high];
  if (!low || !high) return {};
  const RouteLegs& legs = own.legs;
  std::optional<Leg> up = legs.along(approach_path, *low, *high);
  if (!up) return {legs.via_home(*low, *high), legs.via_home(*high, *low)};
  std::optional<Leg> down = legs.along({up->points.rbegin(), up->points.rend()}, *high, *low);
  if (!down) down = legs.via_home(*high, *low);
  return {std::move(up), std::move(down)};
}

void VerifiedCosts::add_leg(std::size_t vehicle, std::uint32_t from, std::uint32_t to,
                            std::optional<Leg> leg) {
  if (!leg) return;
  problem_.vehicles[vehicle].leg(from, to) = compute_cost(*leg);
  vehicles_[vehicle]->paths[{from, to}] = std::move(leg->points);
}

std::vector<CapturePoint> VerifiedCosts::ordered_capture_points(
    std::size_t vehicle, std::span<const std::uint32_t> order) const {
  std::vector<CapturePoint> capture_points;
  for (std::size_t i = 0; i < order.size(); ++i) {
    capture_points.push_back(capture_points_[order[i]]);
    if (i == 0) continue;
    const auto approach_path = vehicles_[vehicle]->paths.find({order[i - 1], order[i]});
    if (approach_path != vehicles_[vehicle]->paths.end())
      capture_points.back().approach_path = approach_path->second;
  }
  return capture_points;
}

}  // namespace skycap::flight
