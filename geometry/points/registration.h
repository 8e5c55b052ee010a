/// The rigid motion that brings a scan onto what was measured before.
///
/// Point to plane: sum over the scan's patches of w (n . (C p - q))^2, with q and n the nearest
/// patch of the map (Chen and Medioni, "Object modelling by registration of multiple range images",
/// 1992), the weights w Tukey's over the patches' variances. Gauss-Newton over SE(3): a step is a
/// displacement t of the middle m of the patches and a turn u / L about it, L being their root mean
/// square distance from m, so that both are lengths and the information matrix, the mean of w J^T J
/// with J = [n, (p - m) x n / L], has no unit. Its eigenvalues say how much of a motion along each
/// eigenvector the surface shows: 1 if all of it faces that way, 0 if the surface slides along
/// itself (Gelfand et al., "Geometrically stable sampling for the ICP algorithm", 2003). Along
/// those below a twentieth nothing is corrected.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/points/surface_map.h"

namespace skycap::geometry {

/// A way to move: m + displacement, and a turn about m, for each metre of the motion.
struct RigidDirection {
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< [rad/m]
  double information = 0.0;                        ///< eigenvalue, 0 to 1
  double amount = 0.0;                             ///< of the correction along it [m]

  bool is_observable() const { return information >= 0.025; }
};

struct Registration {
  Eigen::Isometry3d correction = Eigen::Isometry3d::Identity();  ///< true from given, in the world
  std::size_t matches = 0;                           ///< patches with a partner at the end
  double first_error = 0.0;                          ///< median |n . (p - q)| as given
  double error = 0.0;                                ///< and as corrected
  double deviation = 0.0;                            ///< median of the partners' own
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< m, as given
  double size = 0.0;                                 ///< L
  std::array<RigidDirection, 6> directions{};        ///< ascending by information
};

/// Registers a scan's patches with a map. Partners are looked for within `reach` at first and
/// within twice the map's radius at the end. With fewer than `least_matches` at any time the result
/// has their number and nothing else. Deterministic.
Registration register_scan(std::span<const SurfacePatch> patches, SurfaceMap& map, double reach,
                           std::size_t least_matches);

}  // namespace skycap::geometry
