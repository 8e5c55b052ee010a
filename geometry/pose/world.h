/// Valid range of positions. Every position from a file is checked here first, so that sums,
/// squares and voxel indices cannot overflow.
#pragma once

#include <string>

#include <Eigen/Core>

namespace skycap::geometry {

/// Maximum absolute coordinate of a position [m]. It is a quarter of a meridian, so that map
/// coordinates such as UTM are valid.
inline constexpr double farthest_coordinate = 1e7;

/// Maximum absolute coordinate of a mesh vertex before scaling, because mesh files may be in
/// millimetres.
inline constexpr double farthest_vertex = 1e3 * farthest_coordinate;

/// Returns whether all coordinates are finite and their absolute values do not exceed `farthest`.
inline bool is_valid_position(const Eigen::Vector3d& position,
                              double farthest = farthest_coordinate) {
  return (position.array().abs() <= farthest).all();  // false for NaN
}

/// Throws Error{bad_file} unless is_valid_position(). The message begins with `what`, such as
/// "flight.pad".
void require_valid_position(const Eigen::Vector3d& position, const std::string& what,
                            double farthest = farthest_coordinate);

/// Throws Error{bad_file} unless the vector is finite and can be normalised.
void require_direction(const Eigen::Vector3d& direction, const std::string& what);

}  // namespace skycap::geometry
