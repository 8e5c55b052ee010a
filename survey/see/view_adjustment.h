/// How SEE moves a view that did not resolve its frontier: the reactive handling of occlusions.
///
/// Source: the authors' released code, which SEE++ keeps from SEE; the paper says only that
/// "incremental view adjustments" are applied. Letters as in docs/explanation/see.md.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "survey/see/frontier.h"
#include "survey/see/readings.h"

namespace skycap::survey::see {

/// What has been tried for a frontier. Kept when the point loses its label, so that a frontier
/// that comes back has only the attempts left that it had.
struct AttemptRecord {
  double gain = 1.0;                                               ///< s
  double best_distance = std::numeric_limits<double>::infinity();  ///< of scan centroids so far
  bool may_switch = true;  ///< whether the second start, from the observing line, is still to come
  int views = 0;           ///< aimed at the frontier
};

Eigen::Vector3d centroid(std::span<const Eigen::Vector3f> points);
/// Those of the points that lie in a box, in their order.
std::vector<Eigen::Vector3f> points_inside(std::span<const Eigen::Vector3f> points,
                                           const Eigen::AlignedBox3d& box);

/// Moves the view of a frontier that a scan with the centroid `scan_centroid` failed to resolve.
/// While the centroids come nearer to the frontier, the view is shifted away from them, over the
/// edge of the measured surface; once they do not, it starts again on the line that the point was
/// first seen along; then there is nothing more to try. Whether there was something to try.
bool adjust_view(Frontier& frontier, AttemptRecord& record, const Eigen::Vector3d& scan_centroid,
                 const ViewPlacement& placement, Adjustment adjustment);

}  // namespace skycap::survey::see
