#include "survey/see/frontier.h"

#include <algorithm>
#include <cmath>

namespace skycap::survey::see {

using Eigen::Vector3d;

geometry::View place_view(const Vector3d& frontier, const Vector3d& direction,
                          const ViewPlacement& placement) {
  const auto view_towards = [&](const Vector3d& sensor) -> geometry::View {
    return {frontier + placement.distance * sensor, -sensor};
  };
  if (!placement.min_height) return view_towards(direction);
  const double min_sine =
      std::min(1.0, (*placement.min_height - frontier.z()) / placement.distance);
  if (direction.z() >= min_sine) return view_towards(direction);
  Eigen::Vector2d azimuth = direction.head<2>();
  azimuth = azimuth.norm() > 1e-9 ? azimuth.normalized() : Eigen::Vector2d::UnitX();
  const double cosine = std::sqrt(1.0 - min_sine * min_sine);
  return view_towards({cosine * azimuth.x(), cosine * azimuth.y(), min_sine});
}

geometry::View reobserve_view(const Frontier& frontier, const ViewPlacement& placement) {
  const Vector3d line = frontier.observed_from - frontier.position;
  const double range = line.norm();
  const Vector3d direction = line.normalized();
  double away = std::min(placement.distance, range);
  if (placement.min_height && direction.z() > 0.0) {
    const double high_enough = (*placement.min_height - frontier.position.z()) / direction.z();
    away = std::min(range, std::max(away, high_enough));
  }
  return {frontier.position + away * direction, -direction};
}

}  // namespace skycap::survey::see
