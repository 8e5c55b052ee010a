#include "flight/interpreter/flown_route.h"

#include <algorithm>

namespace skycap::flight {
namespace {

/// Minimum length to subdivide [m]. A leg that is verified in the plan has half of this as margin
/// in its file, where the required clearance is lower (rounding_bound).
constexpr double finest_fan = 0.01;

/// Verifies the legs from every point of `start` to `to`. The distance to obstacles is 1-Lipschitz,
/// and legs from points e apart are at most e apart everywhere. A leg verified at the clearance
/// plus e therefore verifies all legs within e.
LegProof prove_fan(const FreeSpace& space, const Segment& start, const Eigen::Vector3d& to,
                   double clearance, double up_to) {
  const double reach = 0.5 * start.length();
  LegProof proof = prove(space, {start.at(0.5), to}, clearance, up_to + reach);
  proof.clearance -= reach;
  if (!proof.is_proven || proof.clearance >= clearance) return proof;
  if (start.length() < finest_fan) {
    proof.is_proven = false;
    return proof;
  }
  const LegProof first = prove_fan(space, {start.from, start.at(0.5)}, to, clearance, up_to);
  if (!first.is_proven) return first;
  const LegProof second = prove_fan(space, {start.at(0.5), start.to}, to, clearance, up_to);
  return second.is_proven && first.clearance < second.clearance ? first : second;
}

std::string describe(const FlownPiece& piece, const LegProof& proof, const FreeSpace& space) {
  const Eigen::Vector3d& place = proof.closest.on_leg;
  return "leg from " + piece.from_item + " to " + piece.to_item + ": " +
         fixed(proof.closest.distance, 2) + " m from " + space.name(proof.closest) + " at (" +
         fixed(place.x(), 2) + ", " + fixed(place.y(), 2) + ", " + fixed(place.z(), 2) + ")";
}

}  // namespace

FlownProof prove(const FlownRoute& route, const FreeSpace& space, const FreeSpace& pad_space,
                 double clearance, double up_to) {
  FlownProof result{{}, up_to};
  for (const FlownPiece& piece : route.pieces) {
    const FreeSpace& where = piece.is_over_pad ? pad_space : space;
    const LegProof proof = piece.start.length() > 0.0
                               ? prove_fan(where, piece.start, piece.to, clearance, up_to)
                               : prove(where, {piece.start.to, piece.to}, clearance, up_to);
    if (!proof.is_proven) result.problems.push_back(describe(piece, proof, where));
    const double known = proof.is_proven ? proof.clearance : proof.closest.distance;
    result.clearance = std::min(result.clearance, known);
  }
  return result;
}

double length(const FlownRoute& route) {
  double sum = 0.0;
  for (const FlownPiece& piece : route.pieces) {
    if (!piece.is_over_pad) sum += (piece.to - piece.start.to).norm();
  }
  return sum;
}

}  // namespace skycap::flight
