/// Uncertainty of a pose.
///
/// Covariance as in ROS's PoseWithCovariance: x, y, z and rotations about x, y, z, in this order,
/// in m^2, m rad and rad^2. All six refer to the axes of the mission frame, independent of the
/// sensor's orientation. Rotations are about the sensor. The true pose is p + t and exp(w) R, where
/// p and R are the given pose and (t, w) has this covariance.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace skycap::missions::online {

struct PoseCovariance {
  using Matrix = Eigen::Matrix<double, 6, 6>;
  using Vector = Eigen::Matrix<double, 6, 1>;

  /// Symmetric, positive semidefinite covariance of (x, y, z, rx, ry, rz).
  Matrix matrix = Matrix::Zero();

  /// Returns a diagonal covariance with the given standard deviations along each axis [m] and about
  /// each axis [rad].
  static PoseCovariance of(double position, double angle);

  double position() const;  ///< Returns the maximum standard deviation along any axis [m].
  double angle() const;     ///< Returns the maximum standard deviation about any axis [rad].

  /// Returns the standard deviation of direction . (t, w).
  double deviation(const Vector& direction) const;

  /// Returns the Mahalanobis distance of an error (t, w). Independent errors with standard
  /// deviations `position` [m] along and `angle` [rad] about each axis are added to the covariance.
  /// Both must be positive.
  double distance(const Vector& error, double position, double angle) const;

  /// Returns the 21 numbers of the upper triangle, row by row.
  std::vector<double> triangle() const;
};

/// Parses "metres degrees". Throws Error{bad_usage} with `what` as the prefix of the message.
PoseCovariance parse_pose_sigma(const std::string& text, const std::string& what);

/// Parses 36 numbers, row by row, or the 21 numbers of the upper triangle, row by row. Throws
/// Error{bad_usage} unless the matrix is symmetric and positive semidefinite with standard
/// deviations up to 100 m and 90 degrees.
PoseCovariance parse_pose_covariance(const std::string& text, const std::string& what);

}  // namespace skycap::missions::online
