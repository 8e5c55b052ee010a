#include "missions/package/verification/true_space.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "flight/clearance/segment_distance.h"

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;

/// Returns the triangles that are at least partly above `height`.
geometry::Mesh above(geometry::Mesh mesh, double height) {
  std::erase_if(mesh.triangles, [&](const auto& triangle) {
    return std::ranges::all_of(triangle,
                               [&](auto vertex) { return mesh.vertices[vertex].z() < height; });
  });
  return mesh;
}

/// Returns the triangles within `radius` of a position in plan view.
std::vector<flight::Triangle> triangles_at(const geometry::Mesh& mesh, const Vector3d& position,
                                           double radius) {
  const Eigen::AlignedBox2d around(position.head<2>().array() - radius,
                                   position.head<2>().array() + radius);
  std::vector<flight::Triangle> near;
  for (const auto& [a, b, c] : mesh.triangles) {
    const flight::Triangle triangle{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
    Eigen::AlignedBox2d box;
    for (const Vector3d& corner : triangle) box.extend(corner.head<2>());
    if (around.intersects(box)) near.push_back(triangle);
  }
  return near;
}

/// Returns the height of the mesh nearest to `z` within `reach`, which is one metre plus the height
/// difference of a slope of 45 degrees.
std::optional<double> height_at(const std::vector<flight::Triangle>& triangles,
                                const Eigen::Vector2d& at, double z, double reach) {
  const flight::Segment plumb{{at.x(), at.y(), z - reach}, {at.x(), at.y(), z + reach}};
  constexpr double touching = 1e-6;
  std::optional<double> height;
  for (const flight::Triangle& triangle : triangles) {
    const flight::NearestPoints pair = flight::nearest(plumb, triangle);
    if (pair.squared_distance > touching * touching) continue;
    const double met = pair.on_other.z();
    if (!height || std::abs(met - z) < std::abs(*height - z)) height = met;
  }
  return height;
}

}  // namespace

TrueSpace true_space(const flight::FlightOptions& options, const geometry::Mesh& model,
                     double pad_height) {
  flight::Obstacles obstacles = options.rules();
  obstacles.mesh = model;
  flight::KnownSpace everywhere(obstacles);
  obstacles.mesh = above(model, pad_height + flight::pad_roughness);
  return {std::move(everywhere), flight::KnownSpace(without_ground(std::move(obstacles)))};
}

std::vector<flight::LandingSurface> true_landing_surfaces(const flight::FlightOptions& options,
                                                          const geometry::Mesh& model,
                                                          const Vector3d& pad) {
  const double radius = options.pad_radius();
  std::vector<flight::LandingSurface> found;
  for (const Vector3d& position : options.landings(pad)) {
    const std::vector<flight::Triangle> near = triangles_at(model, position, radius);
    std::vector<Vector3d> heights;
    for (const Eigen::Vector2d& at : flight::landing_points(position, radius)) {
      const auto height = height_at(near, at, position.z(), radius + 1.0);
      if (height) heights.emplace_back(at.x(), at.y(), *height);
    }
    const auto ground = flight::pad_ground(position, heights, flight::GroundSource::scene);
    if (ground) found.push_back(*ground);
  }
  return options.landing_surfaces(pad, found);
}

}  // namespace skycap::missions::package
