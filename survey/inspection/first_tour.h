/// First route of an inspection: viewpoints by greedy cover, joined by a short open tour.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "geometry/random_numbers.h"
#include "survey/inspection/reachable_space.h"
#include "survey/inspection/sight_cells.h"
#include "survey/inspection/smooth_route.h"

namespace skycap::survey::inspection {

/// Gimbal range of views [rad].
struct PitchRange {
  double min = -1.5707963267948966;
  double max = 1.5707963267948966;
};

struct TourOptions {
  std::size_t candidates = 2500;  ///< Random positions of viewpoints.
  std::size_t targets = 0;        ///< Number of points, from the first, that count.
  std::uint32_t level = 3;        ///< Level at which a point counts as seen (PointSight).
  double share = 0.98;            ///< Fraction of the attainable targets at which the cover ends.
  PitchRange pitch;
  unsigned threads = 1;  ///< Zero: all processors. Does not affect the result.
};

/// Positions for views, and what can be seen from at least one of them.
struct ViewCandidates {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::uint8_t> attainable;  ///< Per point: highest level from any position.
};

/// Draws reachable positions at distances from the clearance to the range, and computes what each
/// point's best level is. `attainable` is a lower bound: other positions may see more. Throws
/// Error{bad_geometry} if no position is between clearance and range.
ViewCandidates draw_candidates(const ReachableSpace& space, const SightCells& cells,
                               const TourOptions& options, geometry::RandomNumbers& random);

/// Returns the vertices of the first route. Throws Error{bad_geometry} if no candidate sees a
/// target, and Interrupted after a stop request.
std::vector<Vertex> make_first_tour(const ReachableSpace& space, const SightCells& cells,
                                    const ViewCandidates& candidates, const TourOptions& options,
                                    const std::stop_token& stop);

}  // namespace skycap::survey::inspection
