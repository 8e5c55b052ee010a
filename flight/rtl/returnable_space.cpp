#include "flight/rtl/returnable_space.h"

#include <algorithm>

#include "flight/rtl/return_verification.h"

namespace skycap::flight {

using Eigen::Vector3d;

Closest ReturnableSpace::closest(const Segment& leg, double up_to) const {
  return space_.closest(leg, up_to);
}

bool ReturnableSpace::continues_free(const Segment& leg, double clearance) const {
  return space_.continues_free(leg, clearance) &&
         verify_returns(space_, leg, rtl_profile_, return_clearance(clearance)).is_verified;
}

double ReturnableSpace::surface_distance(const Vector3d& point, double up_to) const {
  return space_.surface_distance(point, up_to);
}

bool ReturnableSpace::has_returns(const std::vector<Vector3d>& points, double clearance) const {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Segment leg{points[i - 1], points[i]};
    if (!verify_returns(space_, leg, rtl_profile_, return_clearance(clearance)).is_verified)
      return false;
  }
  return true;
}

std::vector<Vector3d> ReturnableSpace::path_over(const Vector3d& from, const Vector3d& to) const {
  const auto above = [&](const Vector3d& position) {
    return Vector3d(position.x(), position.y(), std::max(rtl_profile_.level, position.z()));
  };
  std::vector<Vector3d> points{from, above(from), above(to), to};
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

}  // namespace skycap::flight
