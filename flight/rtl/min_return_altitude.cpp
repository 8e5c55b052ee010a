#include "flight/rtl/min_return_altitude.h"

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

double min_height(const RtlProfile& rtl_profile) {
  const bool has_dji =
      std::ranges::find(rtl_profile.autopilots, AutopilotType::dji) != rtl_profile.autopilots.end();
  return std::ceil(std::max(rtl_profile.landing_climb, has_dji ? dji_min_return_altitude : 0.0));
}

/// Returns the altitudes to test in ascending order. They are not below the route, because a
/// vehicle above the return altitude returns at its own. They are whole metres up to `max_height`.
/// For a route above that, the next metre is tested, then its own height in case of a lower fence.
std::vector<double> heights_to_try(double min, double route, double max_height) {
  const double min_height = std::max(min, std::ceil(route));
  if (min_height > max_height) return {min_height, std::max(min, std::ceil(100.0 * route) / 100.0)};
  std::vector<double> heights;
  for (double height = min_height; height <= max_height; height += 1.0) heights.push_back(height);
  return heights;
}

double compute_max_altitude(const std::vector<Segment>& legs, const RtlProfile& rtl_profile) {
  double top = rtl_profile.level;
  for (const Segment& leg : legs) top = std::max({top, leg.from.z(), leg.to.z()});
  return top;
}

/// Minimum ball radii of the proof, tried in turn [m]. Small radii are slow in narrow spaces, and
/// the last misses clearances of 2 mm.
constexpr std::array<double, 3> slacks{return_slack, 0.01, 0.002};

/// Tests one altitude after another, starting with the leg that failed last.
class MinReturnAltitude {
 public:
  MinReturnAltitude(const FreeSpace& space, const std::vector<Segment>& legs, double clearance,
                    double slack)
      : space_(space), legs_(legs), clearance_(clearance), slack_(slack), order_(legs.size()) {
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = i;
  }

  ReturnSearch verify(const RtlProfile& rtl_profile) {
    Returns returns{.rtl_profile = rtl_profile,
                    .height = rtl_profile.level - rtl_profile.landings.front().z()};
    returns.nearest =
        verify_landings(space_, rtl_profile, compute_max_altitude(legs_, rtl_profile), clearance_);
    queries_ += returns.nearest.queries;
    if (!returns.nearest.is_verified) return failure(returns.nearest, false);
    for (std::size_t i = 0; i < order_.size(); ++i) {
      const ReturnVerification verification =
          verify_returns(space_, legs_[order_[i]], rtl_profile, clearance_, slack_);
      queries_ += verification.queries;
      if (!verification.is_verified) {
        std::rotate(order_.begin(), order_.begin() + static_cast<std::ptrdiff_t>(i),
                    order_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        const Segment position{verification.from, verification.from};
        return failure(verification,
                       verify_returns(space_, position, rtl_profile, clearance_).is_verified);
      }
      if (verification.clearance < returns.nearest.clearance) returns.nearest = verification;
    }
    returns.clearance = returns.nearest.clearance;
    returns.queries = queries_;
    if (returns.nearest.closest.kind != ObstacleKind::none) {
      returns.obstacle = space_.name(returns.nearest.closest);
    }
    return {returns, "", false};
  }

 private:
  ReturnSearch failure(const ReturnVerification& verification, bool is_by_slack) const {
    return {std::nullopt, describe(verification, space_), is_by_slack};
  }

  const FreeSpace& space_;
  const std::vector<Segment>& legs_;
  double clearance_, slack_;
  std::vector<std::size_t> order_;  ///< Order of the legs.
  std::size_t queries_ = 0;
};

/// Returns the first verified altitude.
ReturnSearch min_verified_return(MinReturnAltitude search, const std::vector<Segment>& legs,
                                 RtlProfile rtl_profile, double max_height) {
  const double ground = rtl_profile.landings.front().z();
  char text[96];
  std::snprintf(text, sizeof text, "no return altitude below %.1f m keeps the clearance",
                max_height);
  ReturnSearch result{.found = std::nullopt, .reason = text};
  double top = ground;
  for (const Segment& leg : legs) top = std::max({top, leg.from.z(), leg.to.z()});
  for (const double height :
       heights_to_try(min_height(rtl_profile), top - ground, max_height - ground)) {
    rtl_profile.level = ground + height;
    const bool failed_by_slack = result.fails_by_slack;
    result = search.verify(rtl_profile);
    if (result.found) return result;
    result.fails_by_slack = result.fails_by_slack || failed_by_slack;
    std::snprintf(text, sizeof text, "at a return altitude of %g m ", height);
    result.reason = text + result.reason;
  }
  return result;
}

}  // namespace

ReturnSearch verify_returns(const FreeSpace& space, const std::vector<Segment>& legs,
                            const RtlProfile& rtl_profile, double clearance) {
  ReturnSearch result;
  for (const double slack : slacks) {
    result = MinReturnAltitude(space, legs, clearance, slack).verify(rtl_profile);
    if (!result.fails_by_slack) break;
  }
  return result;
}

ReturnSearch min_return_altitude(const FreeSpace& space, const std::vector<Segment>& legs,
                                 const RtlProfile& rtl_profile, double max_height,
                                 double clearance) {
  ReturnSearch result;
  for (const double slack : slacks) {
    result = min_verified_return({space, legs, clearance, slack}, legs, rtl_profile, max_height);
    if (!result.fails_by_slack) break;
  }
  return result;
}

double return_energy(const Motion& motion, const RtlProfile& rtl_profile,
                     const Vector3d& position) {
  // The lowest landing point has the longest descent.
  double ground = rtl_profile.landings.front().z();
  for (const Vector3d& landing : rtl_profile.landings) ground = std::min(ground, landing.z());
  const double top = std::max(rtl_profile.level, position.z());
  const auto flight_energy = [&](const Vector3d& displacement) {
    return motion.leg_energy(displacement, motion.leg_time(displacement));
  };
  const double upright = flight_energy({0.0, 0.0, top - position.z()}) +
                         motion.hover_energy(waiting_time + motion.landing_time(top - ground));
  double max = 0.0;
  for (const ReturnSegment& segment : return_segments(rtl_profile, position)) {
    if (segment.part != ReturnPart::level) continue;
    max = std::max(max, upright + flight_energy(segment.line.to - segment.line.from));
  }
  return max;
}

}  // namespace skycap::flight
