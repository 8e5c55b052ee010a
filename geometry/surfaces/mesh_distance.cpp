#include "geometry/surfaces/mesh_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Traits = CGAL::AABB_traits<Kernel, Primitive>;
using Tree = CGAL::AABB_tree<Traits>;
using Node = CGAL::AABB_node<Traits>;

Kernel::Point_3 to_cgal(const Vector3d& p) { return {p.x(), p.y(), p.z()}; }
Vector3d to_eigen(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }

// Apart, a segment and a triangle are nearest at an end of the one or on an edge of the other.
double squared_distance(const Kernel::Segment_3& segment, const Kernel::Triangle_3& triangle) {
  if (CGAL::do_intersect(segment, triangle)) return 0.0;
  double nearest = std::min(CGAL::squared_distance(segment.source(), triangle),
                            CGAL::squared_distance(segment.target(), triangle));
  for (int i = 0; i < 3; ++i) {
    const Kernel::Segment_3 edge(triangle.vertex(i), triangle.vertex(i + 1));
    nearest = std::min(nearest, CGAL::squared_distance(segment, edge));
  }
  return nearest;
}

// Walks the tree past every node that cannot hold a triangle nearer than the nearest so far: the
// distance of the box's centre from the segment, less the box's half diagonal, bounds it.
class SegmentTraversal {
 public:
  explicit SegmentTraversal(double squared_distance) : nearest2_(squared_distance) {}

  bool go_further() const { return nearest2_ > 0.0; }
  bool do_intersect(const Kernel::Segment_3& segment, const Node& node) const {
    const CGAL::Bbox_3& box = node.bbox();
    const Vector3d low(box.xmin(), box.ymin(), box.zmin()),
        high(box.xmax(), box.ymax(), box.zmax());
    const Vector3d centre = 0.5 * (low + high);
    const double bound =
        std::sqrt(CGAL::squared_distance(segment, to_cgal(centre))) - 0.5 * (high - low).norm();
    return bound <= std::sqrt(nearest2_);
  }
  void intersection(const Kernel::Segment_3& segment, const Primitive& primitive) {
    nearest2_ = std::min(nearest2_, squared_distance(segment, *primitive.id()));
  }

  double nearest2() const { return nearest2_; }

 private:
  double nearest2_;
};

}  // namespace

struct MeshDistance::Impl {
  Triangles triangles;
  std::vector<std::uint32_t> indices;  // in the mesh, of each of `triangles`
  Tree tree;
};

MeshDistance::MeshDistance(const Mesh& mesh) : impl_(std::make_unique<Impl>()) {
  validate(mesh);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const Kernel::Triangle_3 triangle(to_cgal(mesh.vertices[a]), to_cgal(mesh.vertices[b]),
                                      to_cgal(mesh.vertices[c]));
    if (triangle.is_degenerate()) continue;
    impl_->triangles.push_back(triangle);
    impl_->indices.push_back(t);
  }
  impl_->tree.rebuild(impl_->triangles.cbegin(), impl_->triangles.cend());
  // Here rather than at the first query, which would not be safe from several threads.
  impl_->tree.build();
  impl_->tree.accelerate_distance_queries();
}

MeshDistance::MeshDistance(MeshDistance&&) noexcept = default;
MeshDistance& MeshDistance::operator=(MeshDistance&&) noexcept = default;
MeshDistance::~MeshDistance() = default;

MeshDistance::Closest MeshDistance::closest(const Vector3d& point) const {
  const auto [on_surface, primitive] = impl_->tree.closest_point_and_primitive(to_cgal(point));
  const Vector3d nearest = to_eigen(on_surface);
  const auto index = static_cast<std::size_t>(primitive - impl_->triangles.cbegin());
  return {nearest, impl_->indices[index], (nearest - point).norm()};
}

double MeshDistance::distance(const Vector3d& from, const Vector3d& to) const {
  const double at_ends = std::min(distance(from), distance(to));
  const Kernel::Segment_3 segment(to_cgal(from), to_cgal(to));
  if (segment.is_degenerate()) return at_ends;
  SegmentTraversal traversal(at_ends * at_ends);
  impl_->tree.traversal(segment, traversal);
  return std::sqrt(traversal.nearest2());
}

}  // namespace skycap::geometry
