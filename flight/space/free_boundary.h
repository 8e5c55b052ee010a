/// Where space that was measured to be free ends.
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace skycap::flight {

/// Of a file that MeasuredSpace::write() wrote, in the world: the middle of each face that a free
/// voxel shares with one that is not. In the order of the file. Throws what MeasuredSpace::read()
/// throws.
std::vector<Eigen::Vector3f> free_boundary(std::istream& stream, const std::string& name);

}  // namespace skycap::flight
