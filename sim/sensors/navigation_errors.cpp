#include "sim/sensors/navigation_errors.h"

#include <cmath>
#include <limits>
#include <string>

#include "geometry/requirement.h"
#include "sim/sensors/noise.h"

namespace skycap::sim {
namespace {

void require_sigma(double value, const std::string& field) {
  require(value >= 0.0 && std::isfinite(value), "navigation." + field, value, "zero or more");
}

}  // namespace

void NavigationErrors::validate() const {
  require_sigma(horizontal_sigma, "horizontal_sigma");
  require_sigma(vertical_sigma, "vertical_sigma");
  require_sigma(tilt_sigma, "tilt_sigma");
  require_sigma(heading_sigma, "heading_sigma");
  require_sigma(correlation_time, "correlation_time");
}

NavigationProcess::NavigationProcess(const NavigationErrors& errors)
    : errors_(errors), sigmas_{errors.horizontal_sigma, errors.horizontal_sigma,
                               errors.vertical_sigma,   errors.tilt_sigma,
                               errors.tilt_sigma,       errors.heading_sigma} {
  errors.validate();
}

std::array<double, 6> NavigationProcess::next(double elapsed) {
  constexpr std::uint32_t first_stream = 0x4E415600;  // Separate from the streams of the sensors.
  if (moment_ == 0) elapsed = std::numeric_limits<double>::infinity();
  const double kept =
      errors_.correlation_time > 0.0 ? std::exp(-elapsed / errors_.correlation_time) : 0.0;
  std::array<double, 6> now;
  for (std::uint32_t kind = 0; kind < sigmas_.size(); ++kind) {
    if (moment_ % block == 0) {
      fill_normals(noise_key(errors_.seed, first_stream + kind, 0), moment_, normals_[kind]);
    }
    states_[kind] = kept * states_[kind] + std::sqrt(1.0 - kept * kept) *
                                               static_cast<double>(normals_[kind][moment_ % block]);
    now[kind] = sigmas_[kind] * states_[kind];
  }
  ++moment_;
  return now;
}

}  // namespace skycap::sim
