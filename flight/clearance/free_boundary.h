/// Boundary of the free space in a measured space.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace skycap::flight {

/// Returns the centres of all faces between a free and a non-free voxel, in world coordinates [m]
/// and file order. The stream contains the output of MeasuredSpace::write(). Throws the same errors
/// as MeasuredSpace::read().
std::vector<Eigen::Vector3f> free_boundary(std::istream& stream, const std::string& name);

}  // namespace skycap::flight
