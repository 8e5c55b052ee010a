/// Positions and lengths as text for messages.
#pragma once

#include <cmath>
#include <cstdio>
#include <string>

#include <Eigen/Core>

namespace skycap::flight {

/// Returns the coordinates [m] as "(1.25, -3.00, 12.50)".
inline std::string position_text(const Eigen::Vector3d& position) {
  char text[96];
  const auto hundredths = [](double value) { return std::round(value * 100.0) / 100.0 + 0.0; };
  std::snprintf(text, sizeof text, "(%.2f, %.2f, %.2f)", hundredths(position.x()),
                hundredths(position.y()), hundredths(position.z()));
  return text;
}

/// Returns the length [m] with millimetres: "1.995 m".
inline std::string length_text(double length) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3f m", length);
  return text;
}

}  // namespace skycap::flight
