/// Gaussian mixtures by which PB-NBV divides voxels into clusters.
///
/// Method: expectation maximisation with k-means++ initialisation; the number of components is that
/// of the minimum Bayesian information criterion (Schwarz, Annals of Statistics 6, 1978).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "survey/pb_nbv/pb_nbv_config.h"

namespace skycap::survey::pb_nbv {

struct Clusters {
  std::vector<std::uint32_t> component;  ///< component of each point
  std::size_t count = 0;                 ///< number of components
};

/// Divides points at the centres of voxels with the size `voxel` into at most `max_components`
/// components. The component of a point is the likeliest one; components without points are
/// removed. Reading::published uses full covariances with the variance of a voxel added;
/// Reading::released uses spherical covariances, at least five components and a criterion with the
/// largest posterior probabilities.
Clusters find_clusters(std::span<const Eigen::Vector3d> points, double voxel,
                       std::size_t max_components, Reading reading, std::uint64_t seed);

}  // namespace skycap::survey::pb_nbv
