#include "geometry/pose/brown_distortion.h"

namespace skycap::geometry {

using Eigen::Vector2d;

Vector2d distort(const BrownDistortion& intrinsics, const Vector2d& slope) {
  const double x = slope.x(), y = slope.y(), r2 = slope.squaredNorm();
  const double radial = 1.0 + r2 * (intrinsics.k1 + r2 * (intrinsics.k2 + r2 * intrinsics.k3));
  return {x * radial + 2.0 * intrinsics.p1 * x * y + intrinsics.p2 * (r2 + 2.0 * x * x),
          y * radial + intrinsics.p1 * (r2 + 2.0 * y * y) + 2.0 * intrinsics.p2 * x * y};
}

Vector2d undistort(const BrownDistortion& intrinsics, const Vector2d& distorted) {
  constexpr int max_iterations = 100;
  constexpr double near_enough = 1e-13;
  Vector2d slope = distorted;
  for (int i = 0; i < max_iterations; ++i) {
    const Vector2d error = distort(intrinsics, slope) - distorted;
    slope -= error;
    if (error.squaredNorm() < near_enough * near_enough) break;
  }
  return slope;
}

}  // namespace skycap::geometry
