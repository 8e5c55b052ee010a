/// How well a platform knows where it is.
#pragma once

#include <array>
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

  bool are_on() const {
    return horizontal_sigma > 0.0 || vertical_sigma > 0.0 || tilt_sigma > 0.0 ||
           heading_sigma > 0.0;
  }
};

/// The errors of one flight, moment after moment.
class NavigationProcess {
 public:
  /// Throws what NavigationErrors::validate() throws.
  explicit NavigationProcess(const NavigationErrors& errors);

  /// Those of the next moment, so long after the one before [s], which may be infinite: east, north
  /// and up [m], then small angles about the platform's three axes [rad].
  std::array<double, 6> next(double elapsed);

 private:
  static constexpr std::size_t block = 32;  ///< of normals that are drawn at once
  NavigationErrors errors_;
  std::array<double, 6> sigmas_;
  std::array<double, 6> states_{};  ///< in units of their sigmas
  std::array<std::array<float, block>, 6> normals_;
  std::uint32_t moment_ = 0;
};

}  // namespace skycap::sim
