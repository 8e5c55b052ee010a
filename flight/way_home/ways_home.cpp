#include "flight/way_home/ways_home.h"

#include <algorithm>

#include "flight/paths/path.h"
#include "flight/space/place_text.h"
#include "flight/way_home/return_proof.h"

namespace skycap::flight {

using Eigen::Vector3d;

namespace {

/// Parts of a curve piece have at least 1/256 of its duration.
constexpr int most_halvings = 8;

/// The whole piece, and thus the start of each of its returns, is within the hull radius of the
/// chord.
bool has_returns(const FreeSpace& space, const CurvePiece& piece, const ReturnLaw& law,
                 double clearance, int halvings_left) {
  const Segment chord{piece.control.front(), piece.control.back()};
  const double asked = clearance + hull_radius(piece);
  if (prove_returns(space, chord, law, asked).is_proven) return true;
  if (halvings_left == 0) return false;
  return std::ranges::all_of(halves(piece), [&](const CurvePiece& half) {
    return has_returns(space, half, law, clearance, halvings_left - 1);
  });
}

}  // namespace

std::string WaysHome::why_none(const Vector3d& place) const {
  const double asked = return_clearance(clearance_);
  const ReturnProof here = prove_returns(space_, {place, place}, law(), asked);
  if (!here.is_proven) return describe(here, space_);
  const std::vector<Vector3d> over = returnable_.way_over(place, home_);
  for (std::size_t i = 1; i < over.size(); ++i) {
    const Segment leg{over[i - 1], over[i]};
    const LegProof proof = prove(space_, leg, clearance_, clearance_);
    if (!proof.is_proven) {
      return "the return straight up and over to the take-off point comes within " +
             length_text(proof.closest.distance) + " of " + space_.name(proof.closest) + " at " +
             place_text(proof.closest.on_leg);
    }
    const ReturnProof returns = prove_returns(space_, leg, law(), asked);
    if (!returns.is_proven) return describe(returns, space_);
  }
  return "";
}

std::vector<Vector3d> WaysHome::with_returns(std::vector<Vector3d> way,
                                             double worthwhile_saving) const {
  if (returnable_.has_returns(way, clearance_)) return way;
  std::vector<Vector3d> over = returnable_.way_over(way.front(), way.back());
  bool is_free = true;
  for (std::size_t i = 1; is_free && i < over.size(); ++i) {
    is_free = returnable_.continues_free({over[i - 1], over[i]}, clearance_);
  }
  if (!is_free) {
    over = returnable_.way_over(way.front(), home_);
    const std::vector<Vector3d> rest = returnable_.way_over(home_, way.back());
    over.insert(over.end(), rest.begin() + 1, rest.end());
  }
  return pull_tight(returnable_, clearance_, std::move(over), worthwhile_saving);
}

bool has_returns(const FreeSpace& space, const Curve& curve, const ReturnLaw& law,
                 double clearance) {
  return std::ranges::all_of(curve, [&](const CurvePiece& piece) {
    return has_returns(space, piece, law, clearance, most_halvings);
  });
}

}  // namespace skycap::flight
