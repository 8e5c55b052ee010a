#include <algorithm>

#include "flight/clearance/position_text.h"
#include "flight/route/route.h"
#include "geometry/error.h"

namespace skycap::flight {

using Eigen::Vector3d;

std::vector<LegCertificate> verify_route(const std::vector<Vector3d>& points,
                                         const FreeSpace& space, double clearance, double cap,
                                         const std::stop_token& stop) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].allFinite()) continue;
    throw Error(ErrorKind::bad_geometry,
                "point " + std::to_string(i) + " of the route has a non-finite position");
  }
  std::vector<LegCertificate> certificates;
  const std::size_t legs =
      points.size() == 1 ? 1 : points.size() - std::min<std::size_t>(points.size(), 1);
  for (std::size_t i = 0; i < legs && !stop.stop_requested(); ++i) {
    const Segment leg{points[i], points[std::min(i + 1, points.size() - 1)]};
    const LegVerification verification = verify(space, leg, clearance, cap);
    certificates.push_back({verification, space.name(verification.closest)});
  }
  return certificates;
}

std::vector<Violation> check_route(const std::vector<Vector3d>& points, const FreeSpace& space,
                                   double clearance) {
  std::vector<Violation> violations;
  const auto certificates = verify_route(points, space, clearance, clearance);
  for (std::size_t i = 0; i < certificates.size(); ++i) {
    const auto& [verification, obstacle] = certificates[i];
    if (!verification.is_verified) violations.push_back({i, verification.closest, obstacle});
  }
  return violations;
}

std::string describe(const Violation& violation) {
  return "leg " + std::to_string(violation.leg) + ": " + length_text(violation.closest.distance) +
         " from " + violation.obstacle + " at " + position_text(violation.closest.on_leg);
}

}  // namespace skycap::flight
