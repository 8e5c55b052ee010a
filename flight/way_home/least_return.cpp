#include "flight/way_home/least_return.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// PX4 holds for 5 s before a return (COM_FAIL_ACT_T), ArduCopter for 5 s above home
/// (RTL_LOIT_TIME). Braking and two corners account for the rest [s].
constexpr double waiting_time = 12.0;

double least_height(const ReturnLaw& law) {
  const bool has_dji = std::ranges::find(law.dialects, Dialect::dji) != law.dialects.end();
  return std::ceil(std::max(law.landing_climb, has_dji ? least_of_dji : 0.0));
}

/// Returns the altitudes to test in ascending order. They are not below the route, because a
/// vehicle above the return altitude returns at its own. They are whole metres up to `highest`. For
/// a route above that, the next metre is tested, then its own height in case of a lower fence.
std::vector<double> heights_to_try(double least, double route, double highest) {
  const double lowest = std::max(least, std::ceil(route));
  if (lowest > highest) return {lowest, std::max(least, std::ceil(100.0 * route) / 100.0)};
  std::vector<double> heights;
  for (double height = lowest; height <= highest; height += 1.0) heights.push_back(height);
  return heights;
}

double top_of(const std::vector<Segment>& legs, const ReturnLaw& law) {
  double top = law.level;
  for (const Segment& leg : legs) top = std::max({top, leg.from.z(), leg.to.z()});
  return top;
}

/// Minimum ball radii of the proof, tried in turn [m]. Small radii are slow in narrow spaces, and
/// the last misses clearances of 2 mm.
constexpr std::array<double, 3> slacks{return_slack, 0.01, 0.002};

/// Tests one altitude after another, starting with the leg that failed last.
class LeastReturn {
 public:
  LeastReturn(const FreeSpace& space, const std::vector<Segment>& legs, double clearance,
              double slack)
      : space_(space), legs_(legs), clearance_(clearance), slack_(slack), order_(legs.size()) {
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = i;
  }

  ReturnSearch prove(const ReturnLaw& law) {
    Returns returns{.law = law, .height = law.level - law.landings.front().z()};
    returns.nearest = prove_landings(space_, law, top_of(legs_, law), clearance_);
    queries_ += returns.nearest.queries;
    if (!returns.nearest.is_proven) return failure(returns.nearest, false);
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const ReturnProof proof = prove_returns(space_, legs_[order_[i]], law, clearance_, slack_);
      queries_ += proof.queries;
      if (!proof.is_proven) {
        std::rotate(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(i),
                    order_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        const Segment place{proof.from, proof.from};
        return failure(proof, prove_returns(space_, place, law, clearance_).is_proven);
      }
      if (proof.clearance < returns.nearest.clearance) returns.nearest = proof;
    }
    returns.clearance = returns.nearest.clearance;
    returns.queries = queries_;
    if (returns.nearest.closest.kind != ObstacleKind::none) {
      returns.obstacle = space_.name(returns.nearest.closest);
    }
    return {returns, "", false};
  }

 private:
  ReturnSearch failure(const ReturnProof& proof, bool is_by_slack) const {
    return {std::nullopt, describe(proof, space_), is_by_slack};
  }

  const FreeSpace& space_;
  const std::vector<Segment>& legs_;
  double clearance_, slack_;
  std::vector<std::size_t> order_;  ///< Order of the legs.
  std::size_t queries_ = 0;
};

/// Returns the first verified altitude.
ReturnSearch least_proven(LeastReturn search, const std::vector<Segment>& legs, ReturnLaw law,
                          double highest) {
  const double ground = law.landings.front().z();
  char text[96];
  std::snprintf(text, sizeof text, "no return altitude fits below %.1f m", highest);
  ReturnSearch result{.found = std::nullopt, .why = text};
  double top = ground;
  for (const Segment& leg : legs) top = std::max({top, leg.from.z(), leg.to.z()});
  for (const double height : heights_to_try(least_height(law), top - ground, highest - ground)) {
    law.level = ground + height;
    const bool failed_by_slack = result.fails_by_slack;
    result = search.prove(law);
    if (result.found) return result;
    result.fails_by_slack = result.fails_by_slack || failed_by_slack;
    std::snprintf(text, sizeof text, "at a return altitude of %g m ", height);
    result.why = text + result.why;
  }
  return result;
}

}  // namespace

ReturnSearch prove_returns(const FreeSpace& space, const std::vector<Segment>& legs,
                           const ReturnLaw& law, double clearance) {
  ReturnSearch result;
  for (const double slack : slacks) {
    result = LeastReturn(space, legs, clearance, slack).prove(law);
    if (!result.fails_by_slack) break;
  }
  return result;
}

ReturnSearch least_return(const FreeSpace& space, const std::vector<Segment>& legs,
                          const ReturnLaw& law, double highest, double clearance) {
  ReturnSearch result;
  for (const double slack : slacks) {
    result = least_proven({space, legs, clearance, slack}, legs, law, highest);
    if (!result.fails_by_slack) break;
  }
  return result;
}

double return_energy(const Motion& motion, const ReturnLaw& law, const Vector3d& place) {
  // The lowest landing point has the longest descent.
  double ground = law.landings.front().z();
  for (const Vector3d& landing : law.landings) ground = std::min(ground, landing.z());
  const double top = std::max(law.level, place.z());
  const auto flown = [&](const Vector3d& way) {
    return motion.leg_energy(way, motion.leg_time(way));
  };
  const double upright = flown({0.0, 0.0, top - place.z()}) +
                         motion.hover_energy(waiting_time + motion.landing_time(top - ground));
  double most = 0.0;
  for (const ReturnPiece& piece : return_pieces(law, place)) {
    if (piece.part != ReturnPart::level) continue;
    most = std::max(most, upright + flown(piece.line.to - piece.line.from));
  }
  return most;
}

}  // namespace skycap::flight
