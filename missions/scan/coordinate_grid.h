/// Coordinates as whole multiples of a length from an offset, 32 bits each: how LAS and E57 files
/// keep them, in the mission's frame or on a map.
#pragma once

#include <bit>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "flight/export/utm.h"
#include "sim/sensors/lidar.h"

namespace skycap::missions::scan {

struct CoordinateGrid {
  double scale = 1e-4;                               ///< coordinates are multiples of it [m]
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< near the points as written
  /// Puts points of the mission's frame on the map; without it they stay local.
  std::shared_ptr<const flight::UtmProjection> projection;
  /// The coordinate reference system as OGC WKT; local east-north-up by default.
  std::string crs_wkt =
      "LOCAL_CS[\"local east-north-up\",LOCAL_DATUM[\"mission origin\",0],UNIT[\"metre\",1],"
      "AXIS[\"east\",EAST],AXIS[\"north\",NORTH],AXIS[\"up\",UP]]";

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;

  /// Of coordinates between two places, in multiples of the scale, as they are written. Throws
  /// Error{bad_geometry} if 32 bits do not hold them.
  Eigen::AlignedBox3d bounds(const Eigen::AlignedBox3d& units) const;
};

/// The nearest whole number of one that fits into 32 bits. Adding 1.5 * 2^52 leaves no place for
/// fractions in a double, and the whole number in its lowest bits: no call, no branch.
inline std::int32_t nearest(double number) {
  return static_cast<std::int32_t>(std::bit_cast<std::uint64_t>(number + 6755399441055744.0));
}

/// Smallest and largest coordinates of some points, of which there is at least one.
Eigen::AlignedBox3f box_of(const std::vector<Eigen::Vector3f>& points);

/// Calls `encode(units)`, where `units` gives a point's coordinates in multiples of the scale from
/// the offset; every point has to be asked for. Returns the bounds of the points as written; there
/// is at least one. Throws what CoordinateGrid::bounds() throws.
template <typename Encode>
Eigen::AlignedBox3d encode_on_grid(const CoordinateGrid& grid, const sim::LidarReturns& returns,
                                   const std::vector<Eigen::Vector3f>& points,
                                   const Encode& encode) {
  const double per_unit = 1.0 / grid.scale;
  if (grid.projection == nullptr) {
    const Eigen::Vector3d shift = returns.origin - grid.offset;
    const auto units = [&](const Eigen::Vector3f& point) -> Eigen::Vector3d {
      return (point.cast<double>() + shift) * per_unit;
    };
    encode(units);
    const Eigen::AlignedBox3f relative = box_of(points);
    return grid.bounds({units(relative.min()), units(relative.max())});
  }
  Eigen::AlignedBox3d box;
  const auto units = [&](const Eigen::Vector3f& point) -> Eigen::Vector3d {
    const Eigen::Vector3d local = returns.origin + point.cast<double>();
    Eigen::Vector3d place = (grid.projection->to_map(local) - grid.offset) * per_unit;
    box.extend(place);
    return place;
  };
  encode(units);
  return grid.bounds(box);
}

}  // namespace skycap::missions::scan
