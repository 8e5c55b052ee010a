#include "flight/rtl/return_paths.h"

#include <algorithm>

#include "flight/clearance/position_text.h"
#include "flight/paths/path.h"
#include "flight/rtl/return_verification.h"

namespace skycap::flight {

using Eigen::Vector3d;

namespace {

/// Parts of a curve piece have at least 1/256 of its duration.
constexpr int max_segment_halvings = 8;

/// The whole piece, and thus the start of each of its returns, is within the hull radius of the
/// chord.
bool has_returns(const FreeSpace& space, const CurveSegment& segment, const RtlProfile& rtl_profile,
                 double clearance, int halvings_left) {
  const Segment chord{segment.control.front(), segment.control.back()};
  const double asked = clearance + hull_radius(segment);
  if (verify_returns(space, chord, rtl_profile, asked).is_verified) return true;
  if (halvings_left == 0) return false;
  return std::ranges::all_of(halves(segment), [&](const CurveSegment& half) {
    return has_returns(space, half, rtl_profile, clearance, halvings_left - 1);
  });
}

constexpr const char* over_remedy = "raise site.max_height or move flight.takeoff";

/// What a user can change so that a failed return can be verified.
std::string remedy_for(const ReturnVerification& failed) {
  switch (failed.segment.part) {
    case ReturnPart::level_as_it_is:
      return "move flight.takeoff more than 54 m (horizontal distance) away from the view, so that "
             "the vehicle climbs before it returns and no level return is required";
    case ReturnPart::climb:
      return failed.closest.kind == ObstacleKind::unknown_space
                 ? "survey the space above the view (raise site.max_height, lower "
                   "planner.min_gain), or lower the top of flight.unknown_box to the maximum "
                   "obstacle height"
                 : "raise planner.view_distance so that views keep away from overhangs";
    case ReturnPart::level:
      return over_remedy;
    case ReturnPart::descent:
    case ReturnPart::landing:
      break;
  }
  return "move flight.takeoff";
}

}  // namespace

NoReturn ReturnPaths::no_return_reason(const Vector3d& position) const {
  const double asked = return_clearance(clearance_);
  const ReturnVerification here =
      verify_returns(space_, {position, position}, rtl_profile(), asked);
  if (!here.is_verified) return {describe(here, space_), remedy_for(here)};
  const std::vector<Vector3d> over = returnable_.path_over(position, home_);
  for (std::size_t i = 1; i < over.size(); ++i) {
    const Segment leg{over[i - 1], over[i]};
    const LegVerification verification = verify(space_, leg, clearance_, clearance_);
    if (!verification.is_verified) {
      return {"the return (vertical climb, then level flight to the take-off point) comes within " +
                  length_text(verification.closest.distance) + " of " +
                  space_.name(verification.closest) + " at " +
                  position_text(verification.closest.on_leg),
              over_remedy};
    }
    const ReturnVerification returns = verify_returns(space_, leg, rtl_profile(), asked);
    if (!returns.is_verified) return {describe(returns, space_), remedy_for(returns)};
  }
  return {};
}

std::vector<Vector3d> ReturnPaths::with_returns(std::vector<Vector3d> path,
                                                double worthwhile_saving) const {
  if (returnable_.has_returns(path, clearance_)) return path;
  std::vector<Vector3d> over = returnable_.path_over(path.front(), path.back());
  bool is_free = true;
  for (std::size_t i = 1; is_free && i < over.size(); ++i) {
    is_free = returnable_.continues_free({over[i - 1], over[i]}, clearance_);
  }
  if (!is_free) {
    over = returnable_.path_over(path.front(), home_);
    const std::vector<Vector3d> rest = returnable_.path_over(home_, path.back());
    over.insert(over.end(), rest.begin() + 1, rest.end());
  }
  return pull_tight(returnable_, clearance_, std::move(over), worthwhile_saving);
}

bool has_returns(const FreeSpace& space, const Curve& curve, const RtlProfile& rtl_profile,
                 double clearance) {
  return std::ranges::all_of(curve, [&](const CurveSegment& segment) {
    return has_returns(space, segment, rtl_profile, clearance, max_segment_halvings);
  });
}

}  // namespace skycap::flight
