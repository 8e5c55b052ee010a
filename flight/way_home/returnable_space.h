/// Free space from every point of which there is a proven way home: for planning routes that a lost
/// link cannot trap.
#pragma once

#include <vector>

#include "flight/space/clearance.h"
#include "flight/way_home/return_law.h"

namespace skycap::flight {

/// Legs are free here if they are free in another space and all of their returns are proven there.
/// Distances are that space's. Keeps a reference to it.
class ReturnableSpace : public FreeSpace {
 public:
  ReturnableSpace(const FreeSpace& space, ReturnLaw law) : space_(space), law_(std::move(law)) {}

  const ReturnLaw& law() const { return law_; }

  Closest closest(const Segment& leg, double up_to) const override;
  /// Returns are proven at return_clearance().
  bool continues_free(const Segment& leg, double clearance) const override;
  double surface_distance(const Eigen::Vector3d& point, double up_to) const override;
  Eigen::AlignedBox3d extent() const override { return space_.extent(); }
  std::string name(const Closest& closest) const override { return space_.name(closest); }

  /// Whether all returns from the points of a polyline are proven.
  bool has_returns(const std::vector<Eigen::Vector3d>& points, double clearance) const;

  /// Straight up to the height of return, level, and straight down: where the returns from both
  /// places are free, the first and the last piece of this are, and their points' returns too.
  std::vector<Eigen::Vector3d> way_over(const Eigen::Vector3d& from,
                                        const Eigen::Vector3d& to) const;

 private:
  const FreeSpace& space_;
  ReturnLaw law_;
};

}  // namespace skycap::flight
