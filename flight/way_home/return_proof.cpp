#include "flight/way_home/return_proof.h"

#include <algorithm>
#include <vector>

#include "flight/space/place_text.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Returns the piece with the minimum clearance, searched up to `reach` beyond the required
/// clearance.
ReturnProof nearest_of(const FreeSpace& space, const std::vector<ReturnPiece>& pieces,
                       const Vector3d& from, double clearance, double reach) {
  ReturnProof nearest;
  nearest.from = from;
  nearest.clearance = clearance + reach + return_surplus;
  for (const ReturnPiece& piece : pieces) {
    const Closest closest = space.closest(piece.line, nearest.clearance + piece.spread);
    ++nearest.queries;
    const double distance = closest.distance - piece.spread - clearance_guard;
    if (closest.kind == ObstacleKind::none || distance >= nearest.clearance) continue;
    nearest.clearance = distance;
    nearest.piece = piece;
    nearest.closest = closest;
  }
  nearest.is_proven = nearest.clearance >= clearance;
  return nearest;
}

/// Part of a leg, as fractions of its length.
struct Interval {
  double begin, end;
};

}  // namespace

ReturnProof prove_returns(const FreeSpace& space, const Segment& leg, const ReturnLaw& law,
                          double clearance, double slack) {
  const double length = leg.length();
  ReturnProof all;
  all.clearance = clearance + return_surplus;
  std::vector<Interval> open{{0.0, 1.0}};
  while (!open.empty()) {
    const auto [begin, end] = open.back();
    open.pop_back();
    const double middle = 0.5 * (begin + end);
    const double reach = 0.5 * (end - begin) * length;
    const Vector3d place = leg.at(middle);
    ReturnProof found =
        nearest_of(space, return_pieces(law, place, reach), place, clearance, reach);
    found.queries += all.queries;
    // Radius within which all returns are free.
    const double covered = found.clearance - clearance;
    all.queries = found.queries;
    const double needed = std::min(reach, slack);
    if (covered < needed) {
      // Pieces from other start positions do not determine the result at this one.
      const ReturnProof here =
          nearest_of(space, return_pieces(law, place, 0.0), place, clearance, reach);
      all.queries += here.queries;
      if (reach > slack && here.clearance - clearance >= needed) {
        open.push_back({begin, middle});
        open.push_back({middle, end});
        continue;
      }
      found.is_proven = false;
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
  all.is_proven = true;
  return all;
}

ReturnProof prove_landings(const FreeSpace& space, const ReturnLaw& law, double top,
                           double clearance) {
  const std::vector<ReturnPiece> columns = landing_columns(law, top);
  ReturnProof proof = nearest_of(space, columns, columns.front().line.from, clearance, 0.0);
  if (proof.closest.kind != ObstacleKind::none) proof.from = proof.piece.line.from;
  proof.clearance = std::max(0.0, proof.clearance);
  return proof;
}

std::string describe(const ReturnProof& failed, const FreeSpace& space) {
  const double distance = std::max(0.0, failed.closest.distance - failed.piece.spread);
  return std::string(name_of(failed.piece.part)) + " of the return from " +
         place_text(failed.from) + " comes within " + length_text(distance) + " of " +
         space.name(failed.closest) + " at " + place_text(failed.closest.on_leg);
}

}  // namespace skycap::flight
