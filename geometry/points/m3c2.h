/// Signed distances between two point clouds along the normals of the first (M3C2: D. Lague,
/// N. Brodu and J. Leroux, "Accurate 3D comparison of complex topography with terrestrial laser
/// scanner", ISPRS Journal of Photogrammetry and Remote Sensing 82, 2013).
///
/// At each core point, the normal is that of the best-fitting plane of the points of the first
/// cloud within half the normal scale D. The points of both clouds inside a cylinder of diameter d
/// along the normal are projected onto it. The distance is the difference between the mean
/// projections. Its level of detection at 95% confidence is
///
///     1.96 (sqrt(s1^2 / n1 + s2^2 / n2) + reg).
///
/// The s are the standard deviations and the n the numbers of the projections. The registration
/// error is reg. A distance beyond this level is a significant change.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

struct M3c2Options {
  double normal_scale = 0.0;        ///< D [m]
  double cylinder_diameter = 0.0;   ///< d [m]
  double max_distance = 0.0;        ///< half the length of the cylinder [m]
  double registration_error = 0.0;  ///< reg [m]
  std::size_t min_points = 4;       ///< of each cloud in a cylinder, for a distance

  /// Throws Error{bad_config} that names the first invalid field.
  void validate() const;
};

struct M3c2Distance {
  static constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< zero if it has too few neighbours
  double distance = unknown;                         ///< positive: the second cloud is in front [m]
  double level_of_detection = unknown;               ///< [m]
  std::size_t points1 = 0, points2 = 0;
  double deviation1 = unknown, deviation2 = unknown;  ///< standard deviations [m]

  bool is_known() const { return distance == distance; }
  bool is_significant() const {
    return is_known() && (distance > level_of_detection || -distance > level_of_detection);
  }
};

/// Returns the distances at `cores` of `second` from `first`. Normals point away from `centre`. The
/// result does not depend on the number of threads.
std::vector<M3c2Distance> m3c2_distances(std::span<const Eigen::Vector3f> cores,
                                         std::span<const Eigen::Vector3f> first,
                                         std::span<const Eigen::Vector3f> second,
                                         const Eigen::Vector3d& centre, const M3c2Options& options,
                                         unsigned threads);

}  // namespace skycap::geometry
