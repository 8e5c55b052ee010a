/// The least height of return at which every way home of a mission is proven.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flight/motion/motion.h"
#include "flight/space/clearance.h"
#include "flight/way_home/return_law.h"
#include "flight/way_home/return_proof.h"

namespace skycap::flight {

/// A mission's certified ways home.
struct Returns {
  ReturnLaw law;            ///< at the height of return
  double height = 0.0;      ///< of return, above the pad, whole metres: what autopilots are told
  double clearance = 0.0;   ///< proven for every return [m]
  ReturnProof nearest{};    ///< the return that comes nearest to anything
  std::string obstacle{};   ///< what that is; empty: nothing is near
  double energy = 0.0;      ///< of the dearest return from any stop of the route [J]
  std::size_t queries = 0;  ///< distances asked for: the work done
};

struct ReturnSearch {
  std::optional<Returns> found;
  std::string why;  ///< what is in the way of the last height tried, if none is found
  /// Whether the clearance is kept where the proof failed, at some height: by less than its balls.
  bool fails_by_slack = false;
};

/// DJI's applications take no lower height of return [m above the pad].
inline constexpr double least_of_dji = 20.0;

/// Looks for the least whole metre above the pad, no lower than the legs themselves, at which the
/// returns from every point of all legs are proven at the clearance, up to the height `highest`
/// (z) or, if the legs are that high, a metre above them. Heights are tried one by one, for a
/// greater one need not be safer where the airspace has a ceiling. `law.level` is not used.
///
/// Routes are planned close to what is proven, by balls that lie elsewhere than those of this
/// proof: where it fails by no more than their size it is tried again with smaller ones.
ReturnSearch least_return(const FreeSpace& space, const std::vector<Segment>& legs,
                          const ReturnLaw& law, double highest, double clearance);

/// The proof at the height that the law has; with smaller balls, too, if need be.
ReturnSearch prove_returns(const FreeSpace& space, const std::vector<Segment>& legs,
                           const ReturnLaw& law, double clearance);

/// Electrical energy of the dearest return from a place, landing included, with the waits that
/// autopilots make before it and over the landing place [J].
double return_energy(const Motion& motion, const ReturnLaw& law, const Eigen::Vector3d& place);

}  // namespace skycap::flight
