/// Union of the measurements of several surveys in one frame.
///
/// Each survey has a region in which space must be measured to count as free. Regions may overlap.
/// A position is free if no survey has measured a point there. Within regions, at least one survey
/// must also have measured it as free. Outside all regions, space is assumed free and the pilot
/// must check it, as for a single survey.
#pragma once

#include <vector>

#include "flight/clearance/bounding_tree.h"
#include "flight/clearance/clearance.h"
#include "flight/clearance/measured_space.h"

namespace skycap::flight {

class MeasuredUnion : public FreeSpace {
 public:
  /// Throws Error{bad_config} if voxel sizes differ, or if a space has no region.
  explicit MeasuredUnion(std::vector<MeasuredSpace> spaces);

  Closest closest(const Segment& leg, double up_to) const override;
  bool continues_free(const Segment& leg, double clearance) const override;
  Eigen::AlignedBox3d extent() const override;
  std::string name(const Closest& closest) const override;

 private:
  /// Spaces, each with the free space of the others added. A position that is free in all of them
  /// is free in the union.
  std::vector<MeasuredSpace> spaces_;
  /// Extent of each space, outside of which it has no obstacles.
  std::vector<Eigen::AlignedBox3d> extents_;
  BoundingTree tree_;  ///< Search tree over `extents_`.
};

}  // namespace skycap::flight
