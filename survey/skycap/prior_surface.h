/// What is thought to be there before it is measured, whoever says so: for the planner to guess by.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace skycap::survey::skycap {

/// Points spread over a surface. Structure of arrays, all of one length.
struct PriorSurface {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  ///< unit, towards the free side
  std::vector<float> areas;              ///< that each stands for
  std::vector<float> uncertainties;      ///< bound of how far off each may be

  std::size_t size() const { return positions.size(); }
};

}  // namespace skycap::survey::skycap
