/// Errors of a platform's navigation solution.
#pragma once

#include <array>
#include <cstdint>

namespace skycap::sim {

/// Error magnitudes of a navigation solution. Each component is a stationary first-order
/// Gauss-Markov process with standard deviation sigma, whose correlation falls to 1/e within
/// `correlation_time`.
struct NavigationErrors {
  double horizontal_sigma = 0.0;   ///< East and north, each [m].
  double vertical_sigma = 0.0;     ///< Vertical [m].
  double tilt_sigma = 0.0;         ///< Roll and pitch, each [rad].
  double heading_sigma = 0.0;      ///< Heading [rad].
  double correlation_time = 60.0;  ///< Correlation time [s].
  std::uint64_t seed = 0;

  /// Throws Error{bad_config} naming the first field outside its interval.
  void validate() const;

  bool are_on() const {
    return horizontal_sigma > 0.0 || vertical_sigma > 0.0 || tilt_sigma > 0.0 ||
           heading_sigma > 0.0;
  }
};

/// Sequence of errors of one flight.
class NavigationProcess {
 public:
  /// Throws the same errors as NavigationErrors::validate().
  explicit NavigationProcess(const NavigationErrors& errors);

  /// Returns the errors `elapsed` [s] after the previous call, possibly infinite: east, north and
  /// up [m], then small angles around the platform's three axes [rad].
  std::array<double, 6> next(double elapsed);

 private:
  static constexpr std::size_t block = 32;  ///< Number of normal variates drawn together.
  NavigationErrors errors_;
  std::array<double, 6> sigmas_;
  std::array<double, 6> states_{};  ///< In units of their standard deviations.
  std::array<std::array<float, block>, 6> normals_;
  std::uint32_t moment_ = 0;
};

}  // namespace skycap::sim
