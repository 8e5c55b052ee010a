#include "survey/see/occlusion.h"

#include <algorithm>
#include <cmath>

namespace skycap::survey::see {

using Eigen::Vector3d;

double OcclusionTest::clear_offset(const Vector3d& frontier, const Vector3d& direction,
                                   double limit) const {
  const double end = std::min(config_.search_distance, limit);
  for (int step = 0; step * config_.radius < end; ++step) {
    const double along = step * config_.radius;
    const Vector3d centre = frontier + along * direction;
    if (!grid_.any_within(centre.cast<float>(), config_.radius)) return along;
  }
  return end;
}

bool OcclusionTest::is_occluded(const Vector3d& frontier, double offset,
                                const Vector3d& sensor) const {
  const Vector3d line = sensor - frontier;
  const double length = line.norm();
  if (length == 0.0) return false;
  const Vector3d direction = line / length;
  const double from = config_.end == MarchEnd::search_distance ? 0.0 : offset;
  const double end = std::min(from + config_.search_distance, length);

  // Samples are at offset + step * radius. The tolerance includes a last sample exactly at the end.
  const double last_step = std::floor((end - offset) / config_.radius + 1e-9);
  double step = 0.0;
  while (step <= last_step) {
    const Vector3d centre = frontier + (offset + step * config_.radius) * direction;
    if (grid_.any_within(centre.cast<float>(), config_.radius)) return true;
    // Skips empty space in a single step, except for one step as a margin for rounding errors of
    // positions.
    const double empty = grid_.empty_length(centre.cast<float>(), direction.cast<float>());
    step += std::max(1.0, std::floor(empty / config_.radius));
  }
  return false;
}

std::vector<Vector3d> directions_to_near(const geometry::PointGrid& points,
                                         const Eigen::Vector3f& position, double radius,
                                         const Vector3d& from) {
  std::vector<geometry::Neighbour> near;
  points.find_within(position, radius, near);
  std::vector<Vector3d> directions;
  directions.reserve(near.size());
  for (const geometry::Neighbour& neighbour : near) {
    const Vector3d ray = points.point(neighbour.index).cast<double>() - from;
    const double range = ray.norm();
    if (range > 1e-9) directions.push_back(ray / range);
  }
  return directions;
}

}  // namespace skycap::survey::see
