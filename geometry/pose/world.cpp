#include "geometry/pose/world.h"

#include <cstdio>

#include "geometry/error.h"

namespace skycap::geometry {
namespace {

[[noreturn]] void fail(const Eigen::Vector3d& vector, const std::string& what,
                       const std::string& rule) {
  char text[96];
  std::snprintf(text, sizeof text, " is (%g, %g, %g); ", vector.x(), vector.y(), vector.z());
  throw Error(ErrorKind::bad_file, what + text + rule);
}

}  // namespace

void require_valid_position(const Eigen::Vector3d& position, const std::string& what,
                            double farthest) {
  if (is_valid_position(position, farthest)) return;
  char rule[80];
  std::snprintf(rule, sizeof rule, "coordinates must be finite and within %g of zero", farthest);
  fail(position, what, rule);
}

void require_direction(const Eigen::Vector3d& direction, const std::string& what) {
  const double length = direction.stableNorm();
  if (direction.allFinite() && length >= 1e-6 && length <= 1e6) return;
  fail(direction, what, "a direction must be finite and have a length between 1e-6 and 1e6");
}

}  // namespace skycap::geometry
