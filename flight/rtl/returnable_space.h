/// Free space with a verified return from every point, for routes on which link loss cannot trap
/// the vehicle.
#pragma once

#include <vector>

#include "flight/clearance/clearance.h"
#include "flight/rtl/rtl_profile.h"

namespace skycap::flight {

/// Legs are free if they are free in the underlying space and all their returns are verified there.
/// Distances are those of the underlying space. Keeps a reference to it.
class ReturnableSpace : public FreeSpace {
 public:
  ReturnableSpace(const FreeSpace& space, RtlProfile rtl_profile)
      : space_(space), rtl_profile_(std::move(rtl_profile)) {}

  const RtlProfile& rtl_profile() const { return rtl_profile_; }

  Closest closest(const Segment& leg, double up_to) const override;
  /// Verifies returns at return_clearance().
  bool continues_free(const Segment& leg, double clearance) const override;
  double surface_distance(const Eigen::Vector3d& point, double up_to) const override;
  Eigen::AlignedBox3d extent() const override { return space_.extent(); }
  std::string name(const Closest& closest) const override { return space_.name(closest); }

  /// Returns true if all returns from the points of a polyline are verified.
  bool has_returns(const std::vector<Eigen::Vector3d>& points, double clearance) const;

  /// Returns the path straight up to the return altitude, level, and straight down. If the returns
  /// from both positions are free, so are the first and last lines and the returns from them.
  std::vector<Eigen::Vector3d> path_over(const Eigen::Vector3d& from,
                                         const Eigen::Vector3d& to) const;

 private:
  const FreeSpace& space_;
  RtlProfile rtl_profile_;
};

}  // namespace skycap::flight
