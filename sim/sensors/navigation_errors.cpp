#include "sim/sensors/navigation_errors.h"

#include <cmath>
#include <string>

#include "geometry/requirement.h"

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

}  // namespace skycap::sim
