/// What a route planner asks about ways home: whether there is one, and how else to go.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/motion/curve.h"
#include "flight/motion/motion.h"
#include "flight/way_home/return_law.h"
#include "flight/way_home/returnable_space.h"

namespace skycap::flight {

/// Keeps a reference to `space`.
class WaysHome {
 public:
  /// `home` is the place above the pad where routes begin and end; `law` is one to plan by.
  WaysHome(const FreeSpace& space, const ReturnLaw& law, const Eigen::Vector3d& home,
           double clearance)
      : space_(space), returnable_(space, law), home_(home), clearance_(clearance) {}

  const ReturnLaw& law() const { return returnable_.law(); }

  /// What is in the way of a return from there, or of the straight way up and over to the pad,
  /// which is what with_returns() falls back on; empty: nothing.
  std::string why_none(const Eigen::Vector3d& place) const;

  /// The way, or, if there is not a proven way home from every point of it, a short one from all of
  /// whose points there is. Both ends must have one, by why_none().
  std::vector<Eigen::Vector3d> with_returns(std::vector<Eigen::Vector3d> way,
                                            double worthwhile_saving) const;

 private:
  const FreeSpace& space_;
  ReturnableSpace returnable_;
  Eigen::Vector3d home_;
  double clearance_;
};

/// Whether all returns from a curve are proven: it lies in the hull of each piece's control points.
bool has_returns(const FreeSpace& space, const Curve& curve, const ReturnLaw& law,
                 double clearance);

}  // namespace skycap::flight
