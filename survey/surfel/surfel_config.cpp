#include "survey/surfel/surfel_config.h"

#include <cmath>
#include <numbers>
#include <optional>

#include "geometry/requirement.h"

namespace skycap::survey::surfel {
namespace {

bool is_positive(double value) { return value > 0.0 && std::isfinite(value); }

}  // namespace

void SurfelConfig::validate() const {
  require(is_positive(coverage_radius), "coverage_radius", coverage_radius,
          "a positive number of metres");
  const auto require_optional = [](const std::optional<double>& value, const char* field) {
    require(!value || is_positive(*value), field, value.value_or(0.0),
            "a positive number of metres");
  };
  require_optional(spacing, "spacing");
  require_optional(view_distance, "view_distance");
  require_optional(view_price, "view_price");
  require_optional(resolution, "resolution");
  require(max_incidence > 0.0 && max_incidence <= 0.5 * std::numbers::pi, "max_incidence",
          max_incidence, "above 0 and at most pi/2 radians");
  require(stop.target_coverage > 0.0 && stop.target_coverage <= 1.0, "stop.target_coverage",
          stop.target_coverage, "above 0 and at most 1");
  require(stop.min_gain >= 0.0 && stop.min_gain < 1.0, "stop.min_gain", stop.min_gain,
          "at least 0 and below 1");
  require_optional(stop.max_length, "stop.max_length");
  require(!stop.max_time || is_positive(*stop.max_time), "stop.max_time",
          stop.max_time.value_or(0.0), "a positive number of seconds");
  require(is_positive(stop.speed), "stop.speed", stop.speed,
          "a positive number of metres per second");
  require(stop.time_per_view >= 0.0 && std::isfinite(stop.time_per_view), "stop.time_per_view",
          stop.time_per_view, "zero or more seconds");
  require(continuation_steps >= 1 && continuation_steps <= 5, "continuation_steps",
          continuation_steps, "between 1 and 5");
  require(position_error >= 0.0 && std::isfinite(position_error), "position_error", position_error,
          "zero or more metres");
  require(angle_error >= 0.0 && std::isfinite(angle_error), "angle_error", angle_error,
          "zero or more radians");
  require(frame_spacing >= 0.0 && std::isfinite(frame_spacing), "frame_spacing", frame_spacing,
          "zero or more metres");
  require(!scene_box || !scene_box->isEmpty(), "scene_box", 0.0, "a box of positive size");
  limits.validate();
}

}  // namespace skycap::survey::surfel
