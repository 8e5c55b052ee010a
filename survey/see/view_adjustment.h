/// Adjustment of views that did not resolve their frontiers: the reactive handling of occlusions in
/// SEE.
///
/// Source: the authors' released code, which SEE++ inherits from SEE. The paper only states that
/// "incremental view adjustments" are applied. Symbols as in docs/explanation/see.md.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "survey/see/frontier.h"
#include "survey/see/method_variants.h"

namespace skycap::survey::see {

/// Attempts to resolve a frontier. Kept when the point loses its label, so that a frontier that
/// appears again does not get more attempts.
struct AttemptRecord {
  double gain = 1.0;  ///< s: gain of the next adjustment
  double best_distance =
      std::numeric_limits<double>::infinity();  ///< minimum distance of a scan centroid from the
                                                ///< frontier so far [m]
  bool may_switch = true;  ///< the second start, from the observing line, is still available
  int views = 0;           ///< number of views aimed at the frontier
};

Eigen::Vector3d centroid(std::span<const Eigen::Vector3f> points);
/// Returns the points inside a box, in the same order.
std::vector<Eigen::Vector3f> points_inside(std::span<const Eigen::Vector3f> points,
                                           const Eigen::AlignedBox3d& box);

/// Adjusts the view of a frontier after a scan with the centroid `scan_centroid` did not resolve
/// it. Returns false if no adjustment is left.
///
/// While the centroids approach the frontier, the view is shifted away from them, beyond the edge
/// of the measured surface. When they stop approaching, the adjustment restarts on the line from
/// which the point was first measured. After that, no adjustment is left.
bool adjust_view(Frontier& frontier, AttemptRecord& record, const Eigen::Vector3d& scan_centroid,
                 const ViewPlacement& placement, Adjustment adjustment);

}  // namespace skycap::survey::see
