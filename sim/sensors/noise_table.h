/// Standard deviation of measured ranges as a table of range, incidence and reflectance, as sensors
/// are measured on targets of known reflectance.
#pragma once

#include <string>
#include <vector>

namespace skycap::sim {

struct NoiseTable {
  std::vector<double> ranges;        ///< ascending [m]
  std::vector<double> incidences;    ///< ascending, from 0 at normal incidence to pi/2 [rad]
  std::vector<double> reflectances;  ///< ascending, in [0, 1]
  /// Standard deviations [m]; the reflectance changes fastest, then the incidence.
  std::vector<double> sigmas;

  bool is_on() const { return !sigmas.empty(); }

  /// Returns the standard deviation [m], linearly interpolated along the axes, which end with
  /// constant values.
  float sigma(double range, double cosine, double reflectance) const;

  /// Throws Error{bad_config} that names the first invalid field with the prefix `name`.
  void validate(const std::string& name) const;
};

}  // namespace skycap::sim
