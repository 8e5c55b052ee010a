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
constexpr std::size_t max_tour_size = 1000;

/// Returns a short closed tour from the first node, without that node.
Indices compute_tour(const std::vector<Vector3d>& positions) {
  return plan_tour(
             static_cast<std::uint32_t>(positions.size()),
             [&](std::uint32_t a, std::uint32_t b) { return (positions[a] - positions[b]).norm(); })
      .order;
}

/// Returns the waypoints of each target that has any.
std::vector<Indices> by_target(std::span<const std::uint32_t> targets) {
  std::vector<Indices> capture_points;
  for (std::uint32_t i = 0; i < targets.size(); ++i) {
    if (i == 0 || targets[i] != targets[i - 1]) capture_points.emplace_back();
    capture_points.back().push_back(i);
  }
  return capture_points;
}

/// Returns groups of at most 1000 waypoints, whose targets are consecutive in a tour of the
/// targets.
std::vector<Indices> neighbourhoods(std::span<const CapturePoint> capture_points,
                                    std::span<const std::uint32_t> targets, const Vector3d& start) {
  if (capture_points.size() <= max_tour_size) {
    Indices all;
    for (std::uint32_t i = 0; i < capture_points.size(); ++i) all.push_back(i);
    return {all};
  }
  const std::vector<Indices> target_groups = by_target(targets);
  std::vector<Vector3d> middles{start};
  for (const Indices& own : target_groups) {
    Vector3d sum = Vector3d::Zero();
    for (const std::uint32_t i : own) sum += capture_points[i].view.position;
    middles.emplace_back(sum / static_cast<double>(own.size()));
  }
  std::vector<Indices> found{{}};
  for (const std::uint32_t target : compute_tour(middles)) {
    const Indices& own = target_groups[target - 1];
    if (!found.back().empty() && found.back().size() + own.size() > max_tour_size) {
      found.emplace_back();
    }
    found.back().insert(found.back().end(), own.begin(), own.end());
  }
  return found;
}

Indices ordered(std::span<const CapturePoint> capture_points,
                std::span<const std::uint32_t> targets, Vector3d start) {
  Indices order;
  for (const Indices& near : neighbourhoods(capture_points, targets, start)) {
    std::vector<Vector3d> positions{start};
    for (const std::uint32_t i : near) positions.push_back(capture_points[i].view.position);
    for (const std::uint32_t index : compute_tour(positions)) order.push_back(near[index - 1]);
    if (!order.empty()) start = capture_points[order.back()].view.position;
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

  LegCost out(const Vector3d& home, const CapturePoint& to) const {
    return in_turn(takeoff_, leg(home, to.view.position, nullptr, nullptr));
  }
  LegCost back(const CapturePoint& from, const Vector3d& home) const {
    return in_turn(leg(from.view.position, home, nullptr, nullptr), landing_);
  }
  LegCost between(const CapturePoint& from, const CapturePoint& to) const {
    return leg(from.view.position, to.view.position, &from, &to);
  }
  LegCost at(const CapturePoint& capture_point) const { return costs_.capture_cost(capture_point); }

 private:
  LegCost leg(const Vector3d& a, const Vector3d& b, const CapturePoint* from,
              const CapturePoint* to) const {
    return compute_cost(costs_.leg({{a, b}}, from, to));
  }

  LegCosts costs_;
  LegCost takeoff_, landing_;
};

}  // namespace

PadSorties sorties_from_pads(std::span<const CapturePoint> capture_points,
                             std::span<const std::uint32_t> targets, std::span<const Vector3d> pads,
                             double climb, const Motion& motion) {
  PadSorties result;
  if (capture_points.empty() || pads.empty()) return result;
  const StraightCosts costs(motion, climb);
  SplitProblem problem{.pads = std::vector<SplitProblem::Pad>(pads.size()),
                       .energy_per_sortie = plannable_energy(motion),
                       .capture_points_per_sortie = max_capture_points(motion.vehicle())};
  const Vector3d up = climb * Vector3d::UnitZ();
  for (const std::uint32_t i : ordered(capture_points, targets, pads[0] + up)) {
    const CapturePoint& capture_point = capture_points[i];
    bool is_in_reach = false;
    for (std::size_t p = 0; p < pads.size(); ++p) {
      SplitProblem::Pad& pad = problem.pads[p];
      pad.out.push_back(costs.out(pads[p] + up, capture_point));
      pad.back.push_back(costs.back(capture_point, pads[p] + up));
      const LegCost there = in_turn(pad.out.back(), costs.at(capture_point));
      const LegCost total = in_turn(there, pad.back.back());
      is_in_reach =
          is_in_reach || std::max(total.energy, total.emergency) <= problem.energy_per_sortie;
    }
    if (!is_in_reach) {
      result.unreachable.push_back(i);
      for (SplitProblem::Pad& pad : problem.pads) pad.out.pop_back(), pad.back.pop_back();
      continue;
    }
    if (!result.order.empty()) {
      const CapturePoint& before = capture_points[result.order.back()];
      problem.leg.push_back(costs.between(before, capture_point));
      result.length += (capture_point.view.position - before.view.position).norm();
    }
    problem.capture_point.push_back(costs.at(capture_point));
    result.order.push_back(i);
  }
  for (const SortieRange& sortie : split_into_sorties(problem).sorties) {
    result.pads.resize(sortie.last + 1, sortie.pad);
  }
  return result;
}

}  // namespace skycap::flight
