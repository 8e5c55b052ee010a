/// Candidate photos of a target.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "geometry/pose/pose.h"
#include "survey/photo/visibility.h"
#include "survey/view_limits.h"

namespace skycap::survey::photo {

/// Returns true if the vehicle may be at a position, considering stand-off, clearance and airspace.
/// Must be thread-safe.
using FreePosition = std::function<bool(const Eigen::Vector3d&)>;

/// Positions and directions that a plan may use.
struct PhotoSpace {
  ViewLimits limits;          ///< Limits of height and gimbal, geofence, and no-fly volumes.
  FreePosition is_free;       ///< Null: all positions are free.
  double min_standoff = 0.0;  ///< Minimum distance of a photo from the target [m].

  bool allows(const geometry::View& view) const {
    return limits.allow(view) && (!is_free || is_free(view.position));
  }
};

struct CandidateOptions {
  std::size_t count = 700;  ///< Required number of candidates.
  std::uint64_t seed = 1;
  unsigned threads = 1;  ///< Zero: all processors. Does not affect the result.
};

/// Returns photos that face samples from the view distance d. Directions are the normal and two
/// directions tilted from it by a tangent of up to 0.7. Samples are processed in rounds, in their
/// order, with one sample per cell of 0.35 d in each round. Sampling ends when there are enough
/// photos or no samples remain. If the limits of height and gimbal exclude a direction, its
/// elevation is changed at the same distance. If the position is not free, the distance is
/// multiplied by 0.8 up to four times, but stays above stand-off and nearest focus. Photos with an
/// obstructed sample are skipped.
std::vector<geometry::View> candidate_photos(const Observer& observer, const PhotoSpace& space,
                                             const CandidateOptions& options);

/// Returns a fan of allowed photos between two photos, for example around a corner. Directions and
/// the points at `distance` [m] along them are interpolated, so that the photos remain at this
/// distance from the interpolated points.
std::vector<geometry::View> photos_between(const geometry::View& first,
                                           const geometry::View& second, double distance,
                                           const PhotoSpace& space);

}  // namespace skycap::survey::photo
