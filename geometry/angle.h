/// Angles are in radians, but for those of readers and writers whose names end in _deg.
#pragma once

#include <numbers>

namespace skycap::geometry {

inline constexpr double radians_per_degree = std::numbers::pi / 180.0;

}  // namespace skycap::geometry
