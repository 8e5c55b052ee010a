#include <algorithm>

#include "flight/route/route.h"
#include "flight/space/place_text.h"
#include "geometry/error.h"

namespace skycap::flight {

using Eigen::Vector3d;

std::vector<Violation> check_route(const std::vector<Vector3d>& points, const FreeSpace& space,
                                   double clearance) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].allFinite()) continue;
    throw Error(ErrorKind::bad_geometry,
                "point " + std::to_string(i) + " of the route is not a finite position");
  }
  std::vector<Violation> violations;
  const std::size_t legs =
      points.size() == 1 ? 1 : points.size() - std::min<std::size_t>(points.size(), 1);
  for (std::size_t i = 0; i < legs; ++i) {
    const Segment leg{points[i], points[std::min(i + 1, points.size() - 1)]};
    const LegProof proof = prove(space, leg, clearance, clearance);
    if (!proof.is_proven) violations.push_back({i, proof.closest, space.name(proof.closest)});
  }
  return violations;
}

std::string describe(const Violation& violation) {
  return "leg " + std::to_string(violation.leg) + ": " + length_text(violation.closest.distance) +
         " from " + violation.obstacle + " at " + place_text(violation.closest.on_leg);
}

}  // namespace skycap::flight
