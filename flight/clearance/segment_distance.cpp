#include "flight/clearance/segment_distance.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Returns the fraction of the segment that is closest to a point.
double nearest_fraction(const Segment& segment, const Vector3d& point) {
  const Vector3d along = segment.to - segment.from;
  const double squared_length = along.squaredNorm();
  if (squared_length == 0.0) return 0.0;
  return std::clamp((point - segment.from).dot(along) / squared_length, 0.0, 1.0);
}

/// Ericson 5.1.5: finds the Voronoi region of the triangle's corners, edges or face that contains
/// the point.
Vector3d nearest_in_triangle(const Vector3d& p, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0.0 && d2 <= 0.0) return a;

  const Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0.0 && d4 <= d3) return b;

  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 && d1 > d3) return a + d1 / (d1 - d3) * ab;

  const Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0.0 && d5 <= d6) return c;

  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 && d2 > d6) return a + d2 / (d2 - d6) * ac;

  const double va = d3 * d6 - d5 * d4;
  const double along_bc = d4 - d3, beyond_bc = d5 - d6;
  if (va <= 0.0 && along_bc >= 0.0 && beyond_bc >= 0.0 && along_bc + beyond_bc > 0.0) {
    return b + along_bc / (along_bc + beyond_bc) * (c - b);
  }
  const double sum = va + vb + vc;
  if (!(sum > 0.0)) return a;  // No area: the caller's edge tests find the closest point.
  return a + vb / sum * ab + vc / sum * ac;
}

/// Returns the intersection of the segment with the triangle's face. Rounding near the border of
/// the face or an end of the segment is harmless, because the edge and end tests find that
/// distance.
std::optional<Vector3d> piercing_point(const Segment& segment, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const Vector3d normal = (b - a).cross(c - a);
  const double before = normal.dot(segment.from - a), after = normal.dot(segment.to - a);
  if (before == after || (before > 0.0) == (after > 0.0)) return std::nullopt;
  const Vector3d point = segment.at(before / (before - after));
  const bool inside = normal.dot((b - a).cross(point - a)) >= 0.0 &&
                      normal.dot((c - b).cross(point - b)) >= 0.0 &&
                      normal.dot((a - c).cross(point - c)) >= 0.0;
  if (!inside) return std::nullopt;
  return point;
}

NearestPoints between(const Vector3d& on_segment, const Vector3d& on_other) {
  return {(on_segment - on_other).squaredNorm(), on_segment, on_other};
}

void keep_nearer(NearestPoints& best, const NearestPoints& candidate) {
  if (candidate.squared_distance < best.squared_distance) best = candidate;
}

}  // namespace

NearestPoints nearest(const Segment& segment, const Vector3d& point) {
  return between(segment.at(nearest_fraction(segment, point)), point);
}

// Ericson 5.1.9: the unconstrained solution is clamped to one segment, projected onto the other,
// and vice versa. It is inaccurate for nearly parallel segments (below 1e-5 rad). Therefore the
// four ends, which are exact for any angle, are compared with it.
NearestPoints nearest(const Segment& segment, const Segment& other) {
  const Vector3d d1 = segment.to - segment.from, d2 = other.to - other.from;
  const Vector3d r = segment.from - other.from;
  const double a = d1.squaredNorm(), e = d2.squaredNorm(), b = d1.dot(d2);
  const double determinant = a * e - b * b;  // a e times the squared sine of the angle.

  const auto through = [&](double s) {
    const Vector3d on_other = other.at(nearest_fraction(other, segment.at(s)));
    return nearest(segment, on_other);
  };
  if (determinant > 1e-10 * a * e) {
    return through(std::clamp((b * d2.dot(r) - e * d1.dot(r)) / determinant, 0.0, 1.0));
  }
  NearestPoints best = nearest(segment, other.from);
  keep_nearer(best, nearest(segment, other.to));
  keep_nearer(best, through(0.0));
  keep_nearer(best, through(1.0));
  if (determinant > 0.0) {
    const double s = (b * d2.dot(r) - e * d1.dot(r)) / determinant;
    keep_nearer(best, through(std::clamp(s, 0.0, 1.0)));
  }
  return best;
}

NearestPoints nearest(const Segment& segment, const Triangle& triangle) {
  if (const auto point = piercing_point(segment, triangle)) return {0.0, *point, *point};
  NearestPoints best = between(segment.from, nearest_in_triangle(segment.from, triangle));
  keep_nearer(best, between(segment.to, nearest_in_triangle(segment.to, triangle)));
  for (int edge = 0; edge < 3; ++edge) {
    keep_nearer(best, nearest(segment, Segment{triangle[edge], triangle[(edge + 1) % 3]}));
  }
  return best;
}

// The squared distance to a box is a convex function of the fraction t along the segment. It is
// quadratic between the crossings of the six planes of the box, with a continuous, piecewise linear
// derivative.
NearestPoints nearest(const Segment& segment, const Eigen::AlignedBox3d& box) {
  const Vector3d along = segment.to - segment.from;
  const auto outside = [&](double t) -> Vector3d {
    const Vector3d point = segment.at(t);
    return point - point.cwiseMax(box.min()).cwiseMin(box.max());
  };
  const auto slope = [&](double t) { return outside(t).dot(along); };
  const auto answer = [&](double t) {
    const Vector3d point = segment.at(t);
    return between(point, point.cwiseMax(box.min()).cwiseMin(box.max()));
  };

  double low = 0.0, low_slope = slope(0.0);
  if (low_slope >= 0.0) return answer(0.0);
  double high = 1.0, high_slope = slope(1.0);
  if (high_slope <= 0.0) return answer(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    if (along[axis] == 0.0) continue;
    for (const double plane : {box.min()[axis], box.max()[axis]}) {
      const double t = (plane - segment.from[axis]) / along[axis];
      if (t <= low || t >= high) continue;
      const double t_slope = slope(t);
      if (t_slope < 0.0) {
        low = t, low_slope = t_slope;
      } else {
        high = t, high_slope = t_slope;
      }
    }
  }
  if (high_slope <= 0.0) return answer(high);
  return answer(low + (high - low) * low_slope / (low_slope - high_slope));
}

bool may_be_nearer(const Segment& segment, const Triangle& triangle, double reach) {
  const auto& [a, b, c] = triangle;
  const Vector3d normal = (b - a).cross(c - a);
  const double from = normal.dot(segment.from - a), to = normal.dot(segment.to - a);
  if ((from > 0.0) != (to > 0.0)) return true;
  const double min = std::min(std::abs(from), std::abs(to));
  return min * min < reach * reach * normal.squaredNorm() || normal.isZero(0.0);
}

}  // namespace skycap::flight
