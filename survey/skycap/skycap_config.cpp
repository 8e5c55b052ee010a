#include <cmath>
#include <numbers>
#include <optional>
#include <sstream>

#include "geometry/error.h"
#include "survey/skycap/skycap_planner.h"

namespace skycap::survey::skycap {
namespace {

void require(bool holds, const char* field, const char* rule, double value) {
  if (holds) return;
  std::ostringstream message;
  message << "planner." << field << " is " << value << "; it must be " << rule;
  throw Error(ErrorKind::bad_config, message.str());
}

bool is_positive(double value) { return value > 0.0 && std::isfinite(value); }

}  // namespace

void SkycapConfig::validate() const {
  require(is_positive(coverage_radius), "coverage_radius", "a positive number of metres",
          coverage_radius);
  const auto require_optional = [](const std::optional<double>& value, const char* field) {
    require(!value || is_positive(*value), field, "a positive number of metres",
            value.value_or(0.0));
  };
  require_optional(spacing, "spacing");
  require_optional(view_distance, "view_distance");
  require_optional(view_price, "view_price");
  require_optional(resolution, "resolution");
  require(max_incidence > 0.0 && max_incidence <= 0.5 * std::numbers::pi, "max_incidence",
          "above 0 and at most pi/2 radians", max_incidence);
  require(stop.wanted_coverage > 0.0 && stop.wanted_coverage <= 1.0, "stop.wanted_coverage",
          "above 0 and at most 1", stop.wanted_coverage);
  require(stop.least_gain >= 0.0 && stop.least_gain < 1.0, "stop.least_gain",
          "at least 0 and below 1", stop.least_gain);
  require_optional(stop.most_length, "stop.most_length");
  require(!stop.most_time || is_positive(*stop.most_time), "stop.most_time",
          "a positive number of seconds", stop.most_time.value_or(0.0));
  require(is_positive(stop.speed), "stop.speed", "a positive number of metres per second",
          stop.speed);
  require(stop.time_per_view >= 0.0 && std::isfinite(stop.time_per_view), "stop.time_per_view",
          "zero or more seconds", stop.time_per_view);
  require(continuation_steps >= 1 && continuation_steps <= 5, "continuation_steps",
          "between 1 and 5", continuation_steps);
  require(!scene_box || !scene_box->isEmpty(), "scene_box", "a box of positive size", 0.0);
  limits.validate();
}

}  // namespace skycap::survey::skycap
