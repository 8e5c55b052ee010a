/// Common parts of the tests of the largest empty cap.
#pragma once

#include <algorithm>
#include <random>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

using Directions = std::vector<Eigen::Vector3d>;

inline Eigen::Vector3d random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> coordinate;
  return Eigen::Vector3d{coordinate(random), coordinate(random), coordinate(random)}.normalized();
}

/// Returns the largest cosine between `s` and any direction in `occluded`.
inline double h(const Directions& occluded, const Eigen::Vector3d& s) {
  double largest = -1.0;
  for (const Eigen::Vector3d& q : occluded) largest = std::max(largest, q.dot(s));
  return largest;
}

}  // namespace skycap::geometry
