#include "missions/prior/terrain.h"

#include <algorithm>
#include <cmath>

#include "flight/space/triangle_tree.h"

namespace skycap::missions::prior {
namespace {

using Eigen::Vector3d;
using flight::NearestPoints;
using flight::Segment;

/// Beyond every height on the Earth [m].
constexpr double far = 2e4;

/// Cells of one grid that are kept in memory as they are; larger grids are thinned.
constexpr double most_cells = 2e6;

std::size_t step_of(const HeightGrid& grid) {
  const double cells = static_cast<double>(grid.columns) * static_cast<double>(grid.rows);
  return static_cast<std::size_t>(std::max(1.0, std::ceil(std::sqrt(cells / most_cells))));
}

}  // namespace

std::vector<flight::Triangle> triangles_of(const HeightGrid& grid, std::size_t step) {
  std::vector<flight::Triangle> triangles;
  const auto add = [&](const Vector3d& a, const Vector3d& b, const Vector3d& c) {
    if (a.allFinite() && b.allFinite() && c.allFinite()) triangles.push_back({a, b, c});
  };
  for (std::size_t row = 0; row + step < grid.rows; row += step) {
    for (std::size_t column = 0; column + step < grid.columns; column += step) {
      const auto node = [&](std::size_t down, std::size_t right) -> Vector3d {
        return grid.nodes[(row + down) * grid.columns + column + right].cast<double>();
      };
      add(node(0, 0), node(0, step), node(step, step));
      add(node(0, 0), node(step, step), node(step, 0));
    }
  }
  return triangles;
}

geometry::Mesh mesh_of(const std::vector<flight::Triangle>& triangles) {
  geometry::Mesh mesh;
  mesh.vertices.reserve(3 * triangles.size());
  for (const flight::Triangle& triangle : triangles) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), triangle.begin(), triangle.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

struct Terrain::Impl {
  flight::TriangleTree surface;
};

Terrain::Terrain(const std::vector<const Prior*>& priors) {
  auto impl = std::make_unique<Impl>();
  auto& triangles = impl->surface.triangles;
  for (const Prior* prior : priors) {
    for (const Object& object : prior->objects) {
      const auto more = flight::triangles_of(object.mesh);
      triangles.insert(triangles.end(), more.begin(), more.end());
    }
    const auto more = triangles_of(prior->grid, step_of(prior->grid));
    triangles.insert(triangles.end(), more.begin(), more.end());
  }
  impl->surface.index();
  impl_ = std::move(impl);
}

Terrain::~Terrain() = default;

geometry::Mesh Terrain::surface() const { return mesh_of(impl_->surface.triangles); }

std::optional<double> Terrain::height(const Eigen::Vector2d& place) const {
  const Segment plumb{{place.x(), place.y(), -far}, {place.x(), place.y(), far}};
  std::optional<double> highest;
  double reach = 1e-6;
  const flight::TriangleTree& surface = impl_->surface;
  surface.tree.visit_near(plumb, reach, [&](std::uint32_t t) {
    const NearestPoints pair = nearest(plumb, surface.triangles[t]);
    if (pair.squared_distance > reach * reach) return;
    highest = std::max(highest.value_or(-far), pair.on_other.z());
  });
  return highest;
}

}  // namespace skycap::missions::prior
