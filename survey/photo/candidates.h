/// Where photos could be taken from.
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

/// Whether the vehicle may be at a position: stand-off, clearance, airspace. Safe to call from
/// several threads.
using FreePosition = std::function<bool(const Eigen::Vector3d&)>;

/// The airspace of a plan.
struct PhotoSpace {
  ViewLimits limits;          ///< heights, gimbal, geofence, no-fly volumes
  FreePosition is_free;       ///< null: every position is free
  double min_standoff = 0.0;  ///< minimum distance of a photo from its target [m]

  bool allows(const geometry::View& view) const {
    return limits.allow(view) && (!is_free || is_free(view.position));
  }
};

struct CandidateOptions {
  std::size_t count = 700;  ///< wanted
  std::uint64_t seed = 1;
  unsigned threads = 1;  ///< zero: all processors; does not change the result
};

/// Photos that look back at samples from view distance d, along the normal and along two directions
/// tilted from it by up to 0.7 in tangent. Samples are taken in their order, one in each cell of
/// 0.35 d, round by round, until there are enough photos or no sample is left. Where the limits of
/// height and gimbal do not allow the direction, its elevation is changed at the same distance;
/// where the position is not free, the distance is shortened by 0.8 up to four times, never below
/// stand-off and nearest focus. Photos whose sample is obstructed are skipped.
std::vector<geometry::View> candidate_photos(const Observer& observer, const PhotoSpace& space,
                                             const CandidateOptions& options);

}  // namespace skycap::survey::photo
