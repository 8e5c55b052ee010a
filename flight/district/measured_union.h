/// What several surveys of one frame have measured, as one space.
///
/// Each survey has a region in which space has to be measured to be free; regions may overlap. A
/// place is free if no survey has measured a point there and, wherever it is in the region of some
/// survey, at least one survey has measured it to be free. Outside of all regions somebody vouches
/// for the airspace, as for that of a single survey.
#pragma once

#include <vector>

#include "flight/space/bounding_tree.h"
#include "flight/space/clearance.h"
#include "flight/space/measured_space.h"

namespace skycap::flight {

class MeasuredUnion : public FreeSpace {
 public:
  /// Throws Error{bad_config} if voxels are of different sizes, or a space has no region.
  explicit MeasuredUnion(std::vector<MeasuredSpace> spaces);

  Closest closest(const Segment& leg, double up_to) const override;
  bool continues_free(const Segment& leg, double clearance) const override;
  Eigen::AlignedBox3d extent() const override;
  std::string name(const Closest& closest) const override;

 private:
  /// Each with what the others have measured to be free: then what is free in all of them is free
  /// together.
  std::vector<MeasuredSpace> spaces_;
  std::vector<Eigen::AlignedBox3d> extents_;  ///< of each, outside of which nothing is in the way
  BoundingTree tree_;                         ///< of these
};

}  // namespace skycap::flight
