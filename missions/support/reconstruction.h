/// From a measured cloud to the surface that it samples.
///
/// Poisson surface reconstruction (Kazhdan, Bolitho, Hoppe 2006; PCL's), which closes every hole,
/// trimmed where there are no measurements: as the SEE++ paper shows its surveys (Fig. 1).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::missions::support {

struct ReconstructionConfig {
  int depth = 0;         ///< of the octree: 2^depth cells a side; 0: cells as wide as spacing
  double spacing = 0.0;  ///< points are thinned to one a cube of this side; 0: they are not
  std::size_t neighbours = 20;  ///< that a normal is estimated from, where none are given
  /// Surface with less than this share of the cloud's usual density around it is trimmed.
  double least_density = 0.2;
  unsigned threads = 0;  ///< zero: all processors

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

struct Reconstruction {
  geometry::Mesh mesh;
  std::size_t points = 0;             ///< after thinning
  double spacing = 0.0;               ///< median distance of a point to the next [m]
  int depth = 0;                      ///< of the octree that was used
  std::size_t trimmed_triangles = 0;  ///< closed holes
};

/// `normals`, outwards, are one for each point or none; if none, they are those of planes through
/// the nearest points, turned to agree with each other along the surface from the highest point
/// on, where they point up (Hoppe et al. 1992). Throws Error{bad_geometry} if there are fewer than
/// 100 points, or nothing is left after trimming, and Error{bad_file} if PCL is not there. The same
/// on any number of threads.
Reconstruction reconstruct(std::span<const Eigen::Vector3f> points,
                           std::span<const Eigen::Vector3f> normals,
                           const ReconstructionConfig& config);

}  // namespace skycap::missions::support
