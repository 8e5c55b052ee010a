/// Angles are in radians, but for those of readers and writers whose names end in _deg.
#pragma once

#include <numbers>

namespace skycap::geometry {

inline constexpr double radians_per_degree = std::numbers::pi / 180.0;
inline constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

}  // namespace skycap::geometry
