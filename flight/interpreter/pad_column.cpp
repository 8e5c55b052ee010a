#include "flight/interpreter/pad_column.h"

namespace skycap::flight {
namespace {

/// Formats round heights by less than this, own climbs included [m].
constexpr double rounding = 0.02;

}  // namespace

void append_column(FlownRoute& route, const Segment& column,
                   const std::array<std::string, 2>& items, double vouched) {
  const double height = column.to.z() - column.from.z();
  Eigen::Vector3d seam = column.to;
  if (height > vouched + rounding) seam.z() = column.from.z() + vouched;
  route.pieces.push_back({{column.from, column.from}, seam, items[0], items[1], true});
  if (seam == column.to) return;
  route.pieces.push_back({{seam, seam}, column.to, items[0], items[1], false});
}

}  // namespace skycap::flight
