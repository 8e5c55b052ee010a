#include "sim/sensors/sensor.h"

#include <cmath>
#include <numbers>
#include <sstream>
#include <string>

#include "geometry/requirement.h"

namespace skycap::sim {
namespace {

/// Limits far beyond any instrument. Larger values would give rays without a finite origin or
/// direction.
constexpr double longest_arm = 100.0;      // Maximum distance between lasers and origin [m].
constexpr double farthest_range = 1e6;     // Maximum range [m].
constexpr double fastest_rotation = 1e6;   // Maximum rotation rate [revolutions per second].
constexpr double largest_angle = 100.0;    // Maximum angle [rad].
constexpr double shortest_period = 1e-9;   // Minimum time between firings [s].
constexpr double longest_period = 3600.0;  // Maximum time between firings [s].

void require_between(double value, double min, double max, const std::string& field) {
  std::ostringstream rule;
  rule << "between " << min << " and " << max;
  require(value >= min && value <= max, field, value, rule.str());
}

void require_within(double value, double max, const std::string& field) {
  require_between(value, -max, max, field);
}

void validate_channel(const Channel& channel, std::size_t number, double firing_period) {
  const std::string name = "channels[" + std::to_string(number) + "].";
  require(std::abs(channel.elevation) <= 0.5 * std::numbers::pi, name + "elevation",
          channel.elevation, "between -pi/2 and pi/2 radians");
  require_within(channel.azimuth, largest_angle, name + "azimuth");
  require_within(channel.height, longest_arm, name + "height");
  require(channel.delay >= 0.0 && channel.delay <= firing_period, name + "delay", channel.delay,
          "between zero and firing_period");
}

void validate_prism(const WedgePrism& prism, std::size_t number) {
  const std::string name = "prisms[" + std::to_string(number) + "].";
  require(prism.wedge > 0.0 && prism.wedge < 0.25 * std::numbers::pi, name + "wedge", prism.wedge,
          "between 0 and pi/4 radians");
  require(prism.refractive_index > 1.0 && prism.refractive_index < 3.0, name + "refractive_index",
          prism.refractive_index, "between 1 and 3");
  require_within(prism.rotation_rate, fastest_rotation, name + "rotation_rate");
  require_within(prism.phase, largest_angle, name + "phase");
}

}  // namespace

void LidarConfig::validate() const {
  require_between(firing_period, shortest_period, longest_period, "firing_period");
  require(!channels.empty() && channels.size() <= 1024, "channels",
          static_cast<double>(channels.size()), "a list of 1 to 1024 lasers");
  for (std::size_t i = 0; i < channels.size(); ++i) validate_channel(channels[i], i, firing_period);
  for (std::size_t i = 0; i < prisms.size(); ++i) validate_prism(prisms[i], i);
  require_within(rotation_rate, fastest_rotation, "rotation_rate");
  require_within(radial_offset, longest_arm, "radial_offset");
  require(field_of_view > 0.0 && field_of_view <= 2.0 * std::numbers::pi, "field_of_view",
          field_of_view, "more than zero and at most 2 pi radians");
  require_between(min_range, 0.0, farthest_range, "min_range");
  require(max_range > min_range && max_range <= farthest_range, "max_range", max_range,
          "greater than min_range and at most 1e6 m");
  require_between(errors.sigma, 0.0, farthest_range, "errors.sigma");
  require_between(errors.sigma_per_metre, 0.0, farthest_range, "errors.sigma_per_metre");
  require_between(errors.sigma_per_square_metre, 0.0, farthest_range,
                  "errors.sigma_per_square_metre");
  require_between(errors.incidence_power, 0.0, 100.0, "errors.incidence_power");
  errors.table.validate("errors.table");
  require_between(errors.channel_bias_sigma, 0.0, farthest_range, "errors.channel_bias_sigma");
  require_between(errors.range_step, 0.0, farthest_range, "errors.range_step");
  require_between(errors.angle_sigma, 0.0, largest_angle, "errors.angle_sigma");
  require_between(sensitivity.reference_range, 0.0, farthest_range, "sensitivity.reference_range");
  require(sensitivity.reference_reflectance > 0.0 && sensitivity.reference_reflectance <= 1.0,
          "sensitivity.reference_reflectance", sensitivity.reference_reflectance,
          "above 0 and at most 1");
  require_between(sensitivity.attenuation, 0.0, 1e3, "sensitivity.attenuation");
  require(beam.rings >= 0 && beam.rings <= 8, "beam.rings", beam.rings, "between 0 and 8");
  require_between(beam.divergence_horizontal, 0.0, std::numbers::pi, "beam.divergence_horizontal");
  require_between(beam.divergence_vertical, 0.0, std::numbers::pi, "beam.divergence_vertical");
  require_between(beam.pulse_length, 0.0, 1.0, "beam.pulse_length");
  require(beam.max_returns >= 1 && beam.max_returns <= 15, "beam.max_returns", beam.max_returns,
          "between 1 and 15");
}

}  // namespace skycap::sim
