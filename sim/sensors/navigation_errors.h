/// How well a platform knows where it is.
#pragma once

#include <cstdint>

namespace skycap::sim {

/// Errors of a navigation solution, each a stationary first-order Gauss-Markov process: standard
/// deviation sigma, and a correlation that falls to 1/e within `correlation_time`.
struct NavigationErrors {
  double horizontal_sigma = 0.0;   ///< of east and of north [m]
  double vertical_sigma = 0.0;     ///< [m]
  double tilt_sigma = 0.0;         ///< of roll and of pitch [rad]
  double heading_sigma = 0.0;      ///< [rad]
  double correlation_time = 60.0;  ///< [s]
  std::uint64_t seed = 0;

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

}  // namespace skycap::sim
