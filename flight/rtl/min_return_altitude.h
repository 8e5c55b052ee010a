/// Minimum return altitude at which every return of a mission is verified.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flight/clearance/clearance.h"
#include "flight/motion/motion.h"
#include "flight/rtl/return_verification.h"
#include "flight/rtl/rtl_profile.h"

namespace skycap::flight {

/// Verified returns of a mission.
struct Returns {
  RtlProfile rtl_profile;  ///< Law at the return altitude.
  /// Return altitude above the pad, as set in the autopilot [m]. Whole metres.
  double height = 0.0;
  double clearance = 0.0;        ///< Clearance verified for every return [m].
  ReturnVerification nearest{};  ///< Return with the minimum clearance.
  std::string obstacle{};        ///< Name of the closest obstacle, empty if none is near.
  double energy = 0.0;      ///< Energy of the most expensive return from any stop of the route [J].
  std::size_t queries = 0;  ///< Number of distance queries, as a measure of effort.
};

struct ReturnSearch {
  std::optional<Returns> found;
  std::string
      reason;  ///< Reason why no altitude was found: the obstacle at the last tested altitude.
  /// True if, at some altitude, the clearance is kept and the proof failed only because its balls
  /// are too large.
  bool fails_by_slack = false;
};

/// Minimum return altitude in DJI's apps [m above the pad].
inline constexpr double dji_min_return_altitude = 20.0;

/// Finds the minimum return altitude in whole metres above the pad at which the returns from every
/// point of all legs are verified at `clearance` [m]. The altitude is not below the legs. The
/// search ends at `max_height` (z) or 1 m above the legs, whichever is higher. All altitudes are
/// tested in turn, because under a ceiling a higher one is not always better. `rtl_profile.level`
/// is ignored.
///
/// Route planning leaves little margin and covers legs with different balls than this proof. A
/// proof that fails by no more than the ball size is repeated with smaller balls.
ReturnSearch min_return_altitude(const FreeSpace& space, const std::vector<Segment>& legs,
                                 const RtlProfile& rtl_profile, double max_height,
                                 double clearance);

/// Verifies the returns at the altitude of `rtl_profile`, with smaller balls if necessary.
ReturnSearch verify_returns(const FreeSpace& space, const std::vector<Segment>& legs,
                            const RtlProfile& rtl_profile, double clearance);

/// Returns the electrical energy of the most expensive return from a position [J]. Includes landing
/// and the waits of autopilots before the return and above the landing point.
double return_energy(const Motion& motion, const RtlProfile& rtl_profile,
                     const Eigen::Vector3d& position);

}  // namespace skycap::flight
