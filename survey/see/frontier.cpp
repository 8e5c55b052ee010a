#include "survey/see/frontier.h"

#include <algorithm>
#include <cmath>

namespace skycap::survey::see {

using Eigen::Vector3d;

geometry::View place_view(const Vector3d& frontier, const Vector3d& direction,
                          const ViewPlacement& placement) {
  Vector3d towards_sensor = direction;
  const double lowest_sine =
      std::min(1.0, (placement.lowest_height - frontier.z()) / placement.distance);
  if (direction.z() < lowest_sine) {
    Eigen::Vector2d azimuth = direction.head<2>();
    azimuth = azimuth.norm() > 1e-9 ? azimuth.normalized() : Eigen::Vector2d::UnitX();
    const double cosine = std::sqrt(1.0 - lowest_sine * lowest_sine);
    towards_sensor << cosine * azimuth, lowest_sine;
  }
  return {frontier + placement.distance * towards_sensor, -towards_sensor};
}

}  // namespace skycap::survey::see
