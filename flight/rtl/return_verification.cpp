#include "flight/rtl/return_verification.h"

#include <algorithm>
#include <vector>

#include "flight/clearance/position_text.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Returns the piece with the minimum clearance, searched up to `reach` beyond the required
/// clearance.
ReturnVerification find_nearest(const FreeSpace& space, const std::vector<ReturnSegment>& segments,
                                const Vector3d& from, double clearance, double reach) {
  ReturnVerification nearest;
  nearest.from = from;
  nearest.clearance = clearance + reach + return_surplus;
  for (const ReturnSegment& segment : segments) {
    const Closest closest = space.closest(segment.line, nearest.clearance + segment.spread);
    ++nearest.queries;
    const double distance = closest.distance - segment.spread - clearance_guard;
    if (closest.kind == ObstacleKind::none || distance >= nearest.clearance) continue;
    nearest.clearance = distance;
    nearest.segment = segment;
    nearest.closest = closest;
  }
  nearest.is_verified = nearest.clearance >= clearance;
  return nearest;
}

/// Part of a leg, as fractions of its length.
struct Interval {
  double begin, end;
};

}  // namespace

ReturnVerification verify_returns(const FreeSpace& space, const Segment& leg,
                                  const RtlProfile& rtl_profile, double clearance, double slack) {
  const double length = leg.length();
  ReturnVerification all;
  all.clearance = clearance + return_surplus;
  std::vector<Interval> open{{0.0, 1.0}};
  while (!open.empty()) {
    const auto [begin, end] = open.back();
    open.pop_back();
    const double middle = 0.5 * (begin + end);
    const double reach = 0.5 * (end - begin) * length;
    const Vector3d position = leg.at(middle);
    ReturnVerification found = find_nearest(space, return_segments(rtl_profile, position, reach),
                                            position, clearance, reach);
    found.queries += all.queries;
    // Radius within which all returns are free.
    const double covered = found.clearance - clearance;
    all.queries = found.queries;
    const double needed = std::min(reach, slack);
    if (covered < needed) {
      // Pieces from other start positions do not determine the result at this one.
      const ReturnVerification here = find_nearest(
          space, return_segments(rtl_profile, position, 0.0), position, clearance, reach);
      all.queries += here.queries;
      if (reach > slack && here.clearance - clearance >= needed) {
        open.push_back({begin, middle});
        open.push_back({middle, end});
        continue;
      }
      found.is_verified = false;
      found.clearance = std::max(0.0, found.clearance);
      return found;
    }
    // Half of the possible radius, so that the rest has a known surplus of clearance.
    const double radius = std::max(0.5 * covered, std::min(covered, slack));
    found.clearance = std::min(found.clearance - std::min(reach, radius), all.clearance);
    if (found.clearance < all.clearance) all = found;
    if (reach <= radius) continue;
    const double share = radius / length;
    open.push_back({begin, middle - share});
    open.push_back({middle + share, end});
  }
  all.is_verified = true;
  return all;
}

ReturnVerification verify_landings(const FreeSpace& space, const RtlProfile& rtl_profile,
                                   double top, double clearance) {
  const std::vector<ReturnSegment> columns = landing_columns(rtl_profile, top);
  ReturnVerification verification =
      find_nearest(space, columns, columns.front().line.from, clearance, 0.0);
  if (verification.closest.kind != ObstacleKind::none)
    verification.from = verification.segment.line.from;
  verification.clearance = std::max(0.0, verification.clearance);
  return verification;
}

std::string describe(const ReturnVerification& failed, const FreeSpace& space) {
  const double distance = std::max(0.0, failed.closest.distance - failed.segment.spread);
  return std::string(to_string(failed.segment.part)) + " of the return from " +
         position_text(failed.from) + " comes within " + length_text(distance) + " of " +
         space.name(failed.closest) + " at " + position_text(failed.closest.on_leg);
}

}  // namespace skycap::flight
