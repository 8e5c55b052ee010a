/// How well a pose is known.
///
/// A covariance as ROS's PoseWithCovariance has it: of x, y, z and of the turns about x, y and z,
/// in this order, in m^2, m rad and rad^2. All six are along and about the axes of the mission's
/// frame, whichever way the sensor looks, and the turns are about the sensor: true from given is
/// p + t and exp(w) R with (t, w) of this covariance.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

namespace skycap::missions::online {

struct PoseCovariance {
  using Matrix = Eigen::Matrix<double, 6, 6>;
  using Vector = Eigen::Matrix<double, 6, 1>;

  Matrix matrix = Matrix::Zero();  ///< symmetric, positive semidefinite

  /// One standard deviation [m] along and [rad] about each axis.
  static PoseCovariance of(double position, double angle);

  double position() const;  ///< largest standard deviation along any axis [m]
  double angle() const;     ///< and about any [rad]

  double deviation(const Vector& direction) const;  ///< of direction . (t, w)

  /// How many standard deviations an error (t, w) is, Mahalanobis's distance, if it has independent
  /// errors of `position` and `angle`, both above zero, along and about each axis as well.
  double distance(const Vector& error, double position, double angle) const;

  /// 21 numbers: the upper triangle by rows.
  std::vector<double> triangle() const;
};

/// Reads "metres degrees". Throws Error{bad_usage}, `what` opens the message.
PoseCovariance parse_pose_sigma(const std::string& text, const std::string& what);

/// Reads 36 numbers, by rows, or the 21 of the upper triangle by rows. Throws Error{bad_usage} for
/// what is no covariance: not symmetric, not positive semidefinite, or beyond 100 m or 90 degrees.
PoseCovariance parse_pose_covariance(const std::string& text, const std::string& what);

}  // namespace skycap::missions::online
