#include "flight/clearance/triangle_tree.h"

namespace skycap::flight {

void TriangleTree::index() {
  std::vector<Eigen::AlignedBox3d> boxes(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const Eigen::Vector3d& corner : triangles[t]) boxes[t].extend(corner);
  }
  tree = BoundingTree(boxes);
}

std::vector<Triangle> to_triangles(const geometry::Mesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    triangles.push_back({mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]});
  }
  return triangles;
}

}  // namespace skycap::flight
