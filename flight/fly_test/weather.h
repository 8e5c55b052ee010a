/// Wind with gusts, and the error of a receiver, as a vehicle meets them on its way.
///
/// Gusts are those of the Dryden model at low altitude (MIL-F-8785C, section 3.7.3.4), each
/// component a first-order process of the model's strength and length: its spectra for the two
/// cross components are of second order. Strengths follow from the mean wind.
#pragma once

#include <Eigen/Core>

#include "geometry/random_numbers.h"

namespace skycap::flight {

/// The air over a site. Velocities are east, north and up [m/s].
class Weather {
 public:
  /// A steady wind, which gusts come on top of; `wind` is the velocity of the air.
  Weather(const Eigen::Vector2d& wind, geometry::RandomNumbers& random)
      : wind_(wind), random_(random) {}

  /// The velocity of the air after `step` [s] more at a height above the ground, for a vehicle that
  /// moves through it with `airspeed`.
  Eigen::Vector3d next(double step, double height, double airspeed);

 private:
  Eigen::Vector2d wind_;
  geometry::RandomNumbers& random_;
  Eigen::Vector3d gust_ = Eigen::Vector3d::Zero();  ///< along the wind, across, up
  bool has_begun_ = false;
};

/// How far off the vehicle takes itself to be: a first-order Gauss-Markov process in each axis, the
/// whole error never greater than `bound`, which is three of its standard deviations.
class ReceiverError {
 public:
  ReceiverError(double bound, geometry::RandomNumbers& random) : bound_(bound), random_(random) {}

  Eigen::Vector3d next(double step);

 private:
  double bound_;
  geometry::RandomNumbers& random_;
  Eigen::Vector3d error_ = Eigen::Vector3d::Zero();
  bool has_begun_ = false;
};

}  // namespace skycap::flight
