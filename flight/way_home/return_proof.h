/// Proof that from every point of a leg every way home is free: no sampling.
///
/// The distance of a point to what is not free changes by no more than the point moves, and a
/// return changes by no more than the place where it begins (return_law.h). So when all returns
/// from a place are free at the clearance and e more, the returns from all places within e of it
/// are free at the clearance. A leg is covered by such balls, halved where they do not reach.
#pragma once

#include <cstddef>
#include <string>

#include <Eigen/Core>

#include "flight/space/clearance.h"
#include "flight/way_home/return_law.h"

namespace skycap::flight {

/// Where a return goes, or fails.
struct ReturnProof {
  bool is_proven = false;
  double clearance = 0.0;  ///< proven lower bound of all returns, at most return_surplus more
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< where the nearest return begins
  ReturnPiece piece;                               ///< of it
  Closest closest{};
  std::size_t queries = 0;  ///< distances asked for: the work done
};

/// The proof needs balls of some size: a leg all of whose returns keep their clearance by less than
/// this counts as not proven [m].
inline constexpr double return_slack = 0.05;

/// What the returns of a route are proven at whose legs are certified at `clearance`.
inline double return_clearance(double clearance) {
  return clearance > return_slack ? clearance - return_slack : 0.0;
}

/// Returns' clearances are reported up to this much above what was asked for [m].
inline constexpr double return_surplus = 1.0;

/// Proves the returns from every point of the leg, the columns over the landing places excepted.
/// The balls have a radius of `slack` at least.
ReturnProof prove_returns(const FreeSpace& space, const Segment& leg, const ReturnLaw& law,
                          double clearance, double slack = return_slack);

/// Proves the columns over the landing places, from `top` down to where they are vouched for.
ReturnProof prove_landings(const FreeSpace& space, const ReturnLaw& law, double top,
                           double clearance);

/// What is in the way, and where: "the climb from (x, y, z) comes within 0.8 m of the ground".
std::string describe(const ReturnProof& failed, const FreeSpace& space);

}  // namespace skycap::flight
