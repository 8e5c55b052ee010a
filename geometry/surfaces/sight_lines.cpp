#include "geometry/surfaces/sight_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "geometry/surfaces/facet_tree.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

/// Ray with its maximum length.
struct Ray {
  Ray(const Vector3d& origin, const Vector3d& direction, double length)
      : from(origin), along(direction), end(length) {
    constexpr double tiny = 1e-200;  // Quotients by this value are large but finite.
    for (int axis = 0; axis < 3; ++axis) {
      const double part = direction[axis];
      inverse[axis] = 1.0 / (std::abs(part) > tiny ? part : std::copysign(tiny, part));
    }
  }

  Vector3d from, along, inverse;
  double end;
};

/// Returns the intersection of the ray with a triangle: Moller and Trumbore, "Fast, minimum storage
/// ray/triangle intersection", 1997. Triangles are slightly enlarged, so that rays do not pass
/// between neighbours.
std::optional<double> crossing(const Facet& facet, const Ray& ray) {
  constexpr double border = 1e-10;
  const Vector3d corner(facet.corner), second(facet.to_second), third(facet.to_third);
  const Vector3d across = ray.along.cross(third);
  const double determinant = second.dot(across);
  if (determinant == 0.0) return std::nullopt;
  const double inverse = 1.0 / determinant;
  const Vector3d from_corner = ray.from - corner;
  const double u = inverse * from_corner.dot(across);
  if (!(u >= -border && u <= 1.0 + border)) return std::nullopt;
  const Vector3d normal = from_corner.cross(second);
  const double v = inverse * ray.along.dot(normal);
  if (!(v >= -border && u + v <= 1.0 + border)) return std::nullopt;
  const double distance = inverse * third.dot(normal);
  if (!(distance > 0.0 && distance < ray.end)) return std::nullopt;
  return distance;
}

using Lanes = Eigen::Array<double, FacetNode::lanes, 1>;

/// Returns the children whose boxes the ray intersects. The test allows for the rounding of the
/// quotients. The box of a missing child is at infinity, where no ray of finite length intersects
/// it.
Eigen::Array<bool, FacetNode::lanes, 1> meets(const FacetNode& node, const Ray& ray) {
  Lanes begin = Lanes::Zero(), end = Lanes::Constant(ray.end);
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_up = ray.inverse[axis] >= 0.0;
    const Eigen::Map<const Eigen::Array<float, FacetNode::lanes, 1>> entry(is_up ? node.low[axis]
                                                                                 : node.high[axis]);
    const Eigen::Map<const Eigen::Array<float, FacetNode::lanes, 1>> leaving(
        is_up ? node.high[axis] : node.low[axis]);
    begin = begin.max((entry.cast<double>() - ray.from[axis]) * ray.inverse[axis]);
    end = end.min((leaving.cast<double>() - ray.from[axis]) * ray.inverse[axis]);
  }
  constexpr double rounding = 1e-12;
  return begin <= end * (1.0 + rounding);
}

}  // namespace

struct SightLines::Impl {
  FacetTree tree;

  /// Calls `found(distance)` for intersections closer than `ray.end` until it returns true.
  template <typename Found>
  void visit(Ray& ray, Found&& found) const {
    if (tree.nodes.empty()) return;
    std::array<std::uint32_t, max_pending> waiting;
    std::size_t count = 0;
    waiting[count++] = 0;
    while (count > 0) {
      const FacetNode& node = tree.nodes[waiting[--count]];
      const auto is_met = meets(node, ray);
      for (int lane = 0; lane < FacetNode::lanes; ++lane) {
        if (!is_met[lane]) continue;
        const std::uint32_t child = node.child[lane];
        if ((child & FacetNode::is_facet) == 0) {
          waiting[count++] = child;
        } else if (const auto at = crossing(tree.facets[child & ~FacetNode::is_facet], ray)) {
          if (found(*at)) return;
        }
      }
    }
  }
};

SightLines::SightLines(const Mesh& mesh, unsigned threads) : impl_(std::make_unique<Impl>()) {
  if (!mesh.triangles.empty()) impl_->tree = facet_tree(mesh, threads);
}

SightLines::SightLines(SightLines&&) noexcept = default;
SightLines& SightLines::operator=(SightLines&&) noexcept = default;
SightLines::~SightLines() = default;

std::optional<double> SightLines::first_hit(const Vector3d& origin, const Vector3d& direction,
                                            double max_distance) const {
  Ray ray(origin, direction, max_distance);
  std::optional<double> first;
  impl_->visit(ray, [&](double distance) {
    first = ray.end = distance;
    return false;
  });
  return first;
}

bool SightLines::is_clear(const Vector3d& from, const Vector3d& to, double fraction) const {
  const Vector3d line = to - from;
  const double length = line.norm();
  if (!(length > 0.0)) return true;
  Ray ray(from, line / length, fraction * length);
  bool is_obstructed = false;
  impl_->visit(ray, [&](double) { return is_obstructed = true; });
  return !is_obstructed;
}

}  // namespace skycap::geometry
