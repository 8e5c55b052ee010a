#include "flight/district/measured_union.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "geometry/error.h"

namespace skycap::flight {
namespace {

using Eigen::AlignedBox3d;

std::vector<AlignedBox3d> collect_extents(const std::vector<MeasuredSpace>& spaces) {
  std::vector<AlignedBox3d> extents;
  extents.reserve(spaces.size());
  for (const MeasuredSpace& space : spaces) extents.push_back(space.extent());
  return extents;
}

/// Adds to each space the free space of the others in its region. `near` finds candidates.
std::vector<MeasuredSpace> shared(std::vector<MeasuredSpace> spaces) {
  for (const MeasuredSpace& space : spaces) {
    if (!space.config().region.isEmpty()) continue;
    throw Error(ErrorKind::bad_config,
                "a measured space without a region cannot be merged with others, because only its "
                "observed space is free");
  }
  std::vector<AlignedBox3d> known;
  known.reserve(spaces.size());
  for (const MeasuredSpace& space : spaces) known.push_back(space.known_box());
  const BoundingTree tree(known);
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    // A ball around the region finds everything that intersects it.
    const AlignedBox3d& box = spaces[i].config().region;
    double reach = 0.5 * box.diagonal().norm();
    tree.visit_near({box.center(), box.center()}, reach, [&](std::uint32_t j) {
      if (j != i && box.intersects(known[j])) spaces[i].merge_free(spaces[j]);
    });
  }
  return spaces;
}

/// Returns the part of a leg within a box grown by `reach`, or std::nullopt. The rest of the leg is
/// at least `reach` away from the box.
std::optional<Segment> part_near(const Segment& leg, const AlignedBox3d& box, double reach) {
  double begin = 0.0, end = 1.0;
  // Rounding tolerance of fractions, by which parts may be longer.
  constexpr double rounding = 1e-9;
  for (int axis = 0; axis < 3; ++axis) {
    const double delta = leg.to[axis] - leg.from[axis];
    if (delta == 0.0) continue;
    const double one = (box.min()[axis] - reach - leg.from[axis]) / delta;
    const double other = (box.max()[axis] + reach - leg.from[axis]) / delta;
    begin = std::max(begin, std::min(one, other) - rounding);
    end = std::min(end, std::max(one, other) + rounding);
  }
  if (begin > end) return std::nullopt;
  return Segment{begin == 0.0 ? leg.from : leg.at(begin), end == 1.0 ? leg.to : leg.at(end)};
}

}  // namespace

MeasuredUnion::MeasuredUnion(std::vector<MeasuredSpace> spaces)
    : spaces_(shared(std::move(spaces))), extents_(collect_extents(spaces_)), tree_(extents_) {}

Closest MeasuredUnion::closest(const Segment& leg, double up_to) const {
  Closest best{up_to};
  double reach = up_to;
  tree_.visit_near(leg, reach, [&](std::uint32_t i) {
    const std::optional<Segment> part = part_near(leg, extents_[i], best.distance);
    if (!part) return;
    const Closest found = spaces_[i].closest(*part, best.distance);
    if (found.kind == ObstacleKind::none || found.distance >= best.distance) return;
    best = found;
    reach = best.distance;
  });
  return best;
}

bool MeasuredUnion::continues_free(const Segment& leg, double clearance) const {
  return closest(leg, clearance + clearance_guard).kind == ObstacleKind::none;
}

AlignedBox3d MeasuredUnion::extent() const {
  AlignedBox3d extent;
  for (const MeasuredSpace& space : spaces_) extent.extend(space.extent());
  return extent;
}

std::string MeasuredUnion::name(const Closest& closest) const {
  return spaces_.empty() ? "" : spaces_.front().name(closest);
}

}  // namespace skycap::flight
