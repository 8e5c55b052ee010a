/// Where anything can be. Every position that comes from a file passes through here before it is
/// worked with, so that no sum, square or voxel index of it overflows.
#pragma once

#include <string>

#include <Eigen/Core>

namespace skycap::geometry {

/// Distance from the origin on each axis that no place of a survey exceeds [m]: a quarter of a
/// meridian, so that map coordinates such as UTM's are places, too.
inline constexpr double farthest_place = 1e7;

/// Mesh files may be in millimetres before they are placed.
inline constexpr double farthest_vertex = 1e3 * farthest_place;

/// Whether all coordinates are finite and within `farthest` of zero.
inline bool is_place(const Eigen::Vector3d& place, double farthest = farthest_place) {
  return (place.array().abs() <= farthest).all();  // false for NaN
}

/// Throws Error{bad_file} unless is_place(); `what` begins the message, as in "flight.pad".
void require_place(const Eigen::Vector3d& place, const std::string& what,
                   double farthest = farthest_place);

/// Throws Error{bad_file} unless the vector is finite and has a length to be divided by.
void require_direction(const Eigen::Vector3d& direction, const std::string& what);

}  // namespace skycap::geometry
