/// Conversion factors between degrees and radians. Angles are in radians unless a reader or writer
/// name ends in `_deg`.
#pragma once

#include <numbers>

namespace skycap::geometry {

inline constexpr double radians_per_degree = std::numbers::pi / 180.0;
inline constexpr double degrees_per_radian = 180.0 / std::numbers::pi;

}  // namespace skycap::geometry
