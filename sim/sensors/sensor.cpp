#include "sim/sensors/sensor.h"

#include <cmath>
#include <sstream>
#include <string>

#include "geometry/error.h"

namespace skycap::sim {
namespace {

void require(bool holds, const std::string& field, double value, const char* rule) {
  if (holds) return;
  std::ostringstream message;
  message << "sensor." << field << " is " << value << "; it must be " << rule;
  throw Error(ErrorKind::bad_config, message.str());
}

void require_not_negative(double value, const char* field) {
  require(value >= 0.0 && std::isfinite(value), field, value, "zero or more");
}

void validate_channel(const Channel& channel, std::size_t number, double firing_period) {
  const std::string name = "channels[" + std::to_string(number) + "].";
  require(std::abs(channel.elevation) <= 0.5 * std::numbers::pi, name + "elevation",
          channel.elevation, "between -pi/2 and pi/2 radians");
  require(std::isfinite(channel.azimuth), name + "azimuth", channel.azimuth, "a finite angle");
  require(std::isfinite(channel.height), name + "height", channel.height, "a finite length");
  require(channel.delay >= 0.0 && channel.delay <= firing_period, name + "delay", channel.delay,
          "between zero and firing_period");
}

void validate_prism(const WedgePrism& prism, std::size_t number) {
  const std::string name = "prisms[" + std::to_string(number) + "].";
  require(prism.wedge > 0.0 && prism.wedge < 0.25 * std::numbers::pi, name + "wedge", prism.wedge,
          "between 0 and pi/4 radians");
  require(prism.refractive_index > 1.0 && prism.refractive_index < 3.0, name + "refractive_index",
          prism.refractive_index, "between 1 and 3");
  require(std::isfinite(prism.rotation_rate), name + "rotation_rate", prism.rotation_rate,
          "a finite number of turns per second");
  require(std::isfinite(prism.phase), name + "phase", prism.phase, "a finite angle");
}

}  // namespace

void LidarConfig::validate() const {
  require(firing_period > 0.0 && std::isfinite(firing_period), "firing_period", firing_period,
          "more than zero seconds");
  require(!channels.empty() && channels.size() <= 1024, "channels",
          static_cast<double>(channels.size()), "a list of 1 to 1024 lasers");
  for (std::size_t i = 0; i < channels.size(); ++i) validate_channel(channels[i], i, firing_period);
  for (std::size_t i = 0; i < prisms.size(); ++i) validate_prism(prisms[i], i);
  require(std::isfinite(rotation_rate), "rotation_rate", rotation_rate,
          "a finite number of turns per second");
  require(std::isfinite(radial_offset), "radial_offset", radial_offset, "a finite length");
  require(field_of_view > 0.0 && field_of_view <= 2.0 * std::numbers::pi, "field_of_view",
          field_of_view, "more than zero and at most 2 pi radians");
  require_not_negative(min_range, "min_range");
  require(max_range > min_range && std::isfinite(max_range), "max_range", max_range,
          "finite and greater than min_range");
  require_not_negative(errors.sigma, "errors.sigma");
  require_not_negative(errors.sigma_per_metre, "errors.sigma_per_metre");
  require_not_negative(errors.sigma_per_square_metre, "errors.sigma_per_square_metre");
  require_not_negative(errors.incidence_power, "errors.incidence_power");
  require_not_negative(errors.channel_bias_sigma, "errors.channel_bias_sigma");
  require_not_negative(errors.range_step, "errors.range_step");
  require_not_negative(errors.angle_sigma, "errors.angle_sigma");
  require_not_negative(sensitivity.reference_range, "sensitivity.reference_range");
  require(sensitivity.reference_reflectance > 0.0 && sensitivity.reference_reflectance <= 1.0,
          "sensitivity.reference_reflectance", sensitivity.reference_reflectance,
          "above 0 and at most 1");
  require_not_negative(sensitivity.attenuation, "sensitivity.attenuation");
  require(beam.rings >= 0 && beam.rings <= 8, "beam.rings", beam.rings, "between 0 and 8");
  require_not_negative(beam.divergence_horizontal, "beam.divergence_horizontal");
  require_not_negative(beam.divergence_vertical, "beam.divergence_vertical");
  require_not_negative(beam.pulse_length, "beam.pulse_length");
  require(beam.max_returns >= 1 && beam.max_returns <= 15, "beam.max_returns", beam.max_returns,
          "between 1 and 15");
}

}  // namespace skycap::sim
