#include "tests/flight/clearance/cgal_oracle.h"

#include <cmath>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

namespace skycap::flight {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 to_cgal(const Eigen::Vector3d& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace

struct CgalOracle::Impl {
  Triangles triangles;
  Tree tree;

  Verdict classify(const Segment& segment, double from, double to, double clearance) const {
    const double length = segment.length();
    if ((from + to - length) / 2.0 >= clearance) return Verdict::clear;
    if (from < clearance || to < clearance) return Verdict::violated;
    if (length < 1e-8) return Verdict::grazing;
    const Eigen::Vector3d middle = segment.at(0.5);
    const double between = std::sqrt(tree.squared_distance(to_cgal(middle)));
    const Verdict first = classify({segment.from, middle}, from, between, clearance);
    return first == Verdict::clear ? classify({middle, segment.to}, between, to, clearance) : first;
  }
};

CgalOracle::CgalOracle(const geometry::Mesh& mesh) : impl_(std::make_unique<Impl>()) {
  for (const auto& [a, b, c] : mesh.triangles) {
    impl_->triangles.emplace_back(to_cgal(mesh.vertices[a]), to_cgal(mesh.vertices[b]),
                                  to_cgal(mesh.vertices[c]));
  }
  impl_->tree.insert(impl_->triangles.cbegin(), impl_->triangles.cend());
  impl_->tree.build();
  impl_->tree.accelerate_distance_queries();
}

CgalOracle::~CgalOracle() = default;

double CgalOracle::distance(const Eigen::Vector3d& point) const {
  return std::sqrt(impl_->tree.squared_distance(to_cgal(point)));
}

Verdict CgalOracle::classify(const Segment& leg, double clearance) const {
  return impl_->classify(leg, distance(leg.from), distance(leg.to), clearance);
}

}  // namespace skycap::flight
