/// Point cloud of a planner as a structure of arrays. Point indices never change.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

struct PointCloud {
  std::vector<Eigen::Vector3f> positions;  ///< world frame [m]
  std::vector<std::uint32_t> views;        ///< zero-based index of the scan of each point

  std::size_t size() const { return positions.size(); }
};

}  // namespace skycap::geometry
