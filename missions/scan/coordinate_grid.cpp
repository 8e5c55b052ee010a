#include "missions/scan/coordinate_grid.h"

#include <cmath>
#include <limits>

#include "geometry/error.h"

namespace skycap::missions::scan {

void CoordinateGrid::validate() const {
  if (!(scale > 0.0 && std::isfinite(scale))) {
    throw Error(ErrorKind::bad_config,
                "scale is " + std::to_string(scale) + "; it must be a finite number above zero");
  }
  if (!offset.allFinite()) throw Error(ErrorKind::bad_config, "offset is not finite");
}

Eigen::AlignedBox3d CoordinateGrid::bounds(const Eigen::AlignedBox3d& units) const {
  constexpr double max = std::numeric_limits<std::int32_t>::max();
  if (!(units.min().array() >= -max).all() || !(units.max().array() <= max).all()) {
    throw Error(ErrorKind::bad_geometry,
                "a point is more than " + std::to_string(max * scale) +
                    " m from the coordinate offset of the file; set an offset near the scene");
  }
  Eigen::AlignedBox3d written;
  for (const Eigen::Vector3d& corner : {units.min(), units.max()}) {
    const Eigen::Vector3d whole(nearest(corner.x()), nearest(corner.y()), nearest(corner.z()));
    written.extend(whole * scale + offset);
  }
  return written;
}

Eigen::AlignedBox3f compute_bounds(const std::vector<Eigen::Vector3f>& points) {
  using FourPoints = Eigen::Array<float, 12, 1>;  // Fills whole vector registers.
  FourPoints min_corner = points[0].replicate<4, 1>(), max_corner = min_corner;
  const std::size_t whole = points.size() / 4 * 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    const FourPoints some = Eigen::Map<const FourPoints>(points[i].data());
    min_corner = min_corner.min(some);
    max_corner = max_corner.max(some);
  }
  Eigen::AlignedBox3f box;
  for (int i = 0; i < 4; ++i) {
    box.extend(min_corner.segment<3>(3 * i).matrix()).extend(max_corner.segment<3>(3 * i).matrix());
  }
  for (std::size_t i = whole; i < points.size(); ++i) box.extend(points[i]);
  return box;
}

}  // namespace skycap::missions::scan
