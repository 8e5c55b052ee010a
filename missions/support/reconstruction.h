/// Reconstructs a mesh from a measured cloud.
///
/// The method is Poisson surface reconstruction (Kazhdan, Bolitho, Hoppe 2006; PCL implementation),
/// which closes all holes. Surface without measurements is then trimmed, as in Fig. 1 of the SEE++
/// paper.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/mesh.h"

namespace skycap::missions::support {

struct ReconstructionConfig {
  int depth = 0;         ///< octree depth, with 2^depth cells per side; 0: cells of size `spacing`
  double spacing = 0.0;  ///< voxel size for downsampling [m]; 0: no downsampling
  std::size_t neighbours = 20;  ///< number of neighbours for normal estimation
  /// Minimum density of the cloud near the surface, as a fraction of its typical density. Surface
  /// below it is trimmed.
  double min_density = 0.2;
  unsigned threads = 0;  ///< zero: one per processor

  /// Throws Error{bad_config} with the name of the first field that is out of range.
  void validate() const;
};

struct Reconstruction {
  geometry::Mesh mesh;
  std::size_t points = 0;             ///< number of points after downsampling
  double spacing = 0.0;               ///< median distance between neighbouring points [m]
  int depth = 0;                      ///< octree depth used
  std::size_t trimmed_triangles = 0;  ///< number of triangles removed from closed holes
};

/// Reconstructs a mesh. `normals` contains an outward normal for each point, or is empty. Missing
/// normals are estimated from planes through neighbouring points. They are oriented consistently
/// along the surface, starting at the highest point, whose normal points up (Hoppe et al. 1992).
/// Throws Error{bad_geometry} for fewer than 100 points or if trimming removes the whole surface.
/// Throws Error{bad_file} if PCL is not installed. The result does not depend on the number of
/// threads.
Reconstruction reconstruct(std::span<const Eigen::Vector3f> points,
                           std::span<const Eigen::Vector3f> normals,
                           const ReconstructionConfig& config);

}  // namespace skycap::missions::support
