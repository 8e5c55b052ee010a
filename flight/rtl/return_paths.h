/// Tests whether a path has returns, and finds paths that have them. Used in route planning.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/curve.h"
#include "flight/motion/motion.h"
#include "flight/rtl/returnable_space.h"
#include "flight/rtl/rtl_profile.h"

namespace skycap::flight {

/// Reason for a missing verified return, with its remedy.
struct NoReturn {
  std::string reason;  ///< Obstacle and position. Empty: a return exists.
  std::string remedy;  ///< Instruction to the user.

  explicit operator bool() const { return !reason.empty(); }
};

/// Keeps a reference to `space`.
class ReturnPaths {
 public:
  /// `home` is the position above the pad where routes start and end. `rtl_profile` is the law to
  /// assume in planning, see planning_rtl_profile().
  ReturnPaths(const FreeSpace& space, const RtlProfile& rtl_profile, const Eigen::Vector3d& home,
              double clearance)
      : space_(space), returnable_(space, rtl_profile), home_(home), clearance_(clearance) {}

  const RtlProfile& rtl_profile() const { return returnable_.rtl_profile(); }

  /// Returns the obstacle of a return from `position`, or of the path straight up and across to the
  /// pad, which is the fallback of with_returns(). Empty if both are free.
  NoReturn no_return_reason(const Eigen::Vector3d& position) const;

  /// Returns `path` if every point of it has a verified return, otherwise a short path that
  /// satisfies this. Both ends must have a return, see no_return_reason().
  std::vector<Eigen::Vector3d> with_returns(std::vector<Eigen::Vector3d> path,
                                            double worthwhile_saving) const;

 private:
  const FreeSpace& space_;
  ReturnableSpace returnable_;
  Eigen::Vector3d home_;
  double clearance_;
};

/// Returns true if all returns from a curve are verified. Each piece lies within the hull of its
/// control points.
bool has_returns(const FreeSpace& space, const Curve& curve, const RtlProfile& rtl_profile,
                 double clearance);

}  // namespace skycap::flight
