/// The measurements that a planner keeps, structure of arrays; a point's index never changes.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

struct PointCloud {
  std::vector<Eigen::Vector3f> positions;  ///< world frame
  std::vector<std::uint32_t> views;        ///< for each point, the scan (counted from 0) it is from

  std::size_t size() const { return positions.size(); }
};

}  // namespace skycap::geometry
