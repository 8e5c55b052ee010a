#include "missions/site_data/terrain.h"

#include <algorithm>

#include "flight/clearance/triangle_tree.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::Vector3d;
using flight::NearestPoints;
using flight::Segment;

/// Exceeds all heights on the Earth [m].
constexpr double far = 2e4;

}  // namespace

geometry::Mesh make_mesh(const std::vector<flight::Triangle>& triangles) {
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
      const auto more = flight::to_triangles(object.mesh);
      triangles.insert(triangles.end(), more.begin(), more.end());
    }
    const std::size_t step = compute_step(prior->grid);
    const HeightGrid coarse = step > 1 ? downsampled(prior->grid, step) : HeightGrid{};
    const HeightGrid& grid = step > 1 ? coarse : prior->grid;
    for (const auto& more : {to_triangles(grid), make_rim_triangles(grid)}) {
      triangles.insert(triangles.end(), more.begin(), more.end());
    }
  }
  impl->surface.index();
  impl_ = std::move(impl);
}

Terrain::~Terrain() = default;

geometry::Mesh Terrain::surface() const { return make_mesh(impl_->surface.triangles); }

std::optional<double> Terrain::height(const Eigen::Vector2d& position) const {
  const Segment plumb{{position.x(), position.y(), -far}, {position.x(), position.y(), far}};
  std::optional<double> max_height;
  double reach = 1e-6;
  const flight::TriangleTree& surface = impl_->surface;
  surface.tree.visit_near(plumb, reach, [&](std::uint32_t t) {
    const NearestPoints pair = nearest(plumb, surface.triangles[t]);
    if (pair.squared_distance > reach * reach) return;
    max_height = std::max(max_height.value_or(-far), pair.on_other.z());
  });
  return max_height;
}

}  // namespace skycap::missions::site_data
