#include "geometry/points/cloud_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "geometry/points/scan.h"
#include "geometry/points/surface_map.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Points of a side of a building and a position in front of it, from which they may have been
/// measured.
struct Side {
  Vector3d front;
  std::vector<Vector3f> points;
};

constexpr std::size_t side_count = 8;

std::array<Side, side_count> divide(std::span<const Vector3f> points, const Vector3d& centre,
                                    double distance) {
  constexpr double diagonal = 0.70710678118654752;
  constexpr std::array<std::array<double, 2>, side_count> directions = {{{1.0, 0.0},
                                                                         {diagonal, diagonal},
                                                                         {0.0, 1.0},
                                                                         {-diagonal, diagonal},
                                                                         {-1.0, 0.0},
                                                                         {-diagonal, -diagonal},
                                                                         {0.0, -1.0},
                                                                         {diagonal, -diagonal}}};
  std::array<Side, side_count> sides;
  for (std::size_t i = 0; i < side_count; ++i) {
    sides[i].front = centre + distance * Vector3d(directions[i][0], directions[i][1], 0.7);
  }
  for (const Vector3f& point : points) {
    const Vector3d offset = point.cast<double>() - centre;
    std::size_t best = 0;
    double best_product = -1.0;
    for (std::size_t i = 0; i < side_count; ++i) {
      const double product = offset.x() * directions[i][0] + offset.y() * directions[i][1];
      if (product <= best_product) continue;
      best = i;
      best_product = product;
    }
    sides[best].points.push_back(point);
  }
  return sides;
}

}  // namespace

std::optional<Registration> align_clouds(std::span<const Vector3f> moved,
                                         std::span<const Vector3f> reference,
                                         const Vector3d& centre, double radius, double reach) {
  double distance = 0.0;
  for (const Vector3f& point : reference) {
    distance = std::max(distance, (point.cast<double>() - centre).norm());
  }
  distance *= 10.0;
  SurfaceMap map(radius);
  for (const Side& side : divide(reference, centre, distance)) map.add(side.points, side.front);
  std::vector<SurfacePatch> patches;
  constexpr std::size_t max_points = 200'000, max_patches = 500, min_matches = 20;
  for (const Side& side : divide(moved, centre, distance)) {
    if (side.points.empty()) continue;
    ScanSpan scan;
    scan.points = side.points;
    scan.world_from_sensor.translation() = side.front;
    const ScanPatches found = scan_patches(scan, radius, max_points, max_patches);
    patches.insert(patches.end(), found.patches.begin(), found.patches.end());
  }
  const Registration found = register_scan(patches, map, reach, min_matches);
  if (found.matches < min_matches) return std::nullopt;
  return found;
}

}  // namespace skycap::geometry
