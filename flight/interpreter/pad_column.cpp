#include "flight/interpreter/pad_column.h"

#include <algorithm>
#include <cmath>

namespace skycap::flight {
namespace {

/// Maximum rounding of heights in the formats, including Skycap's own climbs [m].
constexpr double column_rounding = 0.02;

}  // namespace

void append_column(InterpretedRoute& route, const Segment& column,
                   const std::array<std::string, 2>& items, double checked_height) {
  const bool is_climb = column.to.z() >= column.from.z();
  const double foot = std::min(column.from.z(), column.to.z());
  const auto append = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                          bool is_over_pad) {
    route.segments.push_back({{from, from}, to, items[0], items[1], is_over_pad});
  };
  if (std::abs(column.to.z() - column.from.z()) <= checked_height + column_rounding) {
    return append(column.from, column.to, true);
  }
  const Eigen::Vector3d seam(column.to.x(), column.to.y(), foot + checked_height);
  append(column.from, seam, is_climb);
  append(seam, column.to, !is_climb);
}

}  // namespace skycap::flight
