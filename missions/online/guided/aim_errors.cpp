#include "missions/online/guided/aim_errors.h"

#include <cmath>

#include <fmt/format.h>

namespace skycap::missions::online {

std::string describe_failures(const AimErrors& errors, double arrival) {
  const auto degrees = [](double angle) { return angle / geometry::radians_per_degree; };
  std::string text;
  const auto add = [&](const std::string& failure) {
    text += (text.empty() ? "" : "; ") + failure;
  };
  if (errors.position > arrival) {
    add(fmt::format("position error {:.2f} m (at most {:.2f})", errors.position, arrival));
  }
  if (errors.speed > rest_speed) {
    add(fmt::format("speed {:.2f} m/s (at most {:.1f})", errors.speed, rest_speed));
  }
  if (errors.turn > aim_tolerance) {
    add(fmt::format("heading error {:.1f} degrees (at most {:.0f})", degrees(errors.turn),
                    degrees(aim_tolerance)));
  }
  if (std::abs(errors.pitch - errors.asked_pitch) > aim_tolerance) {
    add(fmt::format(
        "gimbal pitch {:.1f} degrees instead of {:.1f} (tolerance {:.0f}), vehicle pitch {:.1f}",
        degrees(errors.pitch), degrees(errors.asked_pitch), degrees(aim_tolerance),
        degrees(errors.vehicle_pitch)));
  }
  return text;
}

}  // namespace skycap::missions::online
