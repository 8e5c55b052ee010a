/// Rigid registration of a scan with the points measured before.
///
/// Point-to-plane error: the sum over the patches of the scan of w (n . (C p - q))^2. q and n are
/// the mean and the normal of the nearest patch of the map (Chen and Medioni, "Object modelling by
/// registration of multiple range images", 1992). The weights w are Tukey's biweights, divided by
/// the variances of the patches.
///
/// The solver is Gauss-Newton over SE(3). A step is a displacement t of the centre m of the patches
/// and a rotation u / L about m. L is the root mean square distance of the patches from m, so that
/// t and u are both lengths. The information matrix is the mean of w J^T J with J = [n, (p - m) x n
/// / L] and has no unit.
///
/// Each eigenvalue states how well the surface constrains a motion along its eigenvector. It is 1
/// if all of the surface faces that direction, and 0 if the surface slides along itself. Source:
/// Gelfand et al., "Geometrically stable sampling for the ICP algorithm", 2003. Directions with an
/// eigenvalue below 0.025 are not corrected.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/points/surface_map.h"

namespace skycap::geometry {

/// Motion direction: displacement of m, and rotation about m, per metre of motion.
struct RigidDirection {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< rotation [rad/m]
  double information = 0.0;                        ///< eigenvalue, 0 to 1
  double amount = 0.0;                             ///< component of the correction [m]

  bool is_observable() const { return information >= 0.025; }
};

struct Registration {
  Eigen::Isometry3d correction =
      Eigen::Isometry3d::Identity();  ///< corrected from given, in the world frame
  std::size_t matches = 0;            ///< patches with a partner in the last iteration
  double first_error = 0.0;           ///< median |n . (p - q)| before the correction [m]
  double error = 0.0;                 ///< median |n . (p - q)| after the correction [m]
  double deviation = 0.0;             ///< median deviation of the partners [m]
  /// Misfit before and after the correction, of the patches with a partner before it: mean of the
  /// squares of |n . (p - q)| in quarters of the map's radius. Larger errors and patches without a
  /// partner count as 1.
  double first_misfit = 0.0, misfit = 0.0;
  Eigen::Vector3d middle =
      Eigen::Vector3d::Zero();  ///< m: centre of the patches before the correction [m]
  double size = 0.0;            ///< L: root mean square distance of the patches from m [m]
  std::array<RigidDirection, 6> directions{};  ///< ascending by information
};

/// Registers the patches of a scan with a map. The search radius for partners decreases from
/// `reach` to twice the radius of the map. If fewer than `min_matches` partners are found in any
/// iteration, only `matches` is set. The result is deterministic.
Registration register_scan(std::span<const SurfacePatch> patches, SurfaceMap& map, double reach,
                           std::size_t min_matches);

}  // namespace skycap::geometry
