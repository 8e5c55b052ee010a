/// Prior surface from external data, used by the planner to predict surface before it is measured.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace skycap::survey::surfel {

/// Points distributed over a surface. Structure of arrays of equal length.
struct PriorSurface {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  ///< unit vectors towards the free side
  std::vector<float> areas;              ///< area represented by each point [m^2]
  std::vector<float> uncertainties;      ///< upper bound of the position error of each point [m]

  std::size_t size() const { return positions.size(); }
};

}  // namespace skycap::survey::surfel
