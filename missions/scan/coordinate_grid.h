/// Integer coordinates with 32 bits, scaled and relative to an offset, as in LAS and E57 files.
/// They are in the mission frame or projected.
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
  double scale = 1e-4;  ///< Length of one integer step [m].
  /// Position near the points in file coordinates [m].
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  /// Map projection of the points. Null keeps the mission frame.
  std::shared_ptr<const flight::UtmProjection> projection;
  /// Coordinate reference system as OGC WKT. The default is a local east-north-up system.
  std::string crs_wkt =
      "LOCAL_CS[\"local east-north-up\",LOCAL_DATUM[\"mission origin\",0],UNIT[\"metre\",1],"
      "AXIS[\"east\",EAST],AXIS[\"north\",NORTH],AXIS[\"up\",UP]]";

  /// Throws Error{bad_config} naming the first field outside its valid interval.
  void validate() const;

  /// Returns the written bounds [m] for bounds in integer steps. Throws Error{bad_geometry} if 32
  /// bits do not suffice.
  Eigen::AlignedBox3d bounds(const Eigen::AlignedBox3d& units) const;
};

/// Returns the nearest integer of a number in the 32-bit range. Adding 1.5 * 2^52 leaves no
/// fraction bits in a double and places the integer in its lowest bits. This avoids calls and
/// branches.
inline std::int32_t nearest(double number) {
  return static_cast<std::int32_t>(std::bit_cast<std::uint64_t>(number + 6755399441055744.0));
}

/// Returns the bounding box of `points`, which must not be empty.
Eigen::AlignedBox3f compute_bounds(const std::vector<Eigen::Vector3f>& points);

/// Calls `encode(units)`. `units` converts a point to integer steps relative to the offset and must
/// be called for every point. Returns the bounds of the points as written; `points` must not be
/// empty. Throws all errors of CoordinateGrid::bounds().
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
    const Eigen::AlignedBox3f relative = compute_bounds(points);
    return grid.bounds({units(relative.min()), units(relative.max())});
  }
  Eigen::AlignedBox3d box;
  const auto units = [&](const Eigen::Vector3f& point) -> Eigen::Vector3d {
    const Eigen::Vector3d local = returns.origin + point.cast<double>();
    Eigen::Vector3d position = (grid.projection->to_map(local) - grid.offset) * per_unit;
    box.extend(position);
    return position;
  };
  encode(units);
  return grid.bounds(box);
}

}  // namespace skycap::missions::scan
