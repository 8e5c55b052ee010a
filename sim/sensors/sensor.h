/// Laser scanners as data: what a sensor description (sim/sensors/presets/*.yaml) says of one.
///
/// Sensor frame: x forward, y left, z up. A spinning sensor turns about z, anticlockwise seen from
/// above when its rate is positive; azimuth is the angle from x towards y, elevation the angle
/// above the x-y plane. A rosette sensor looks along x.
#pragma once

#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

namespace skycap::sim {

/// One laser. A firing is one shot of each.
struct Channel {
  double elevation = 0.0;  ///< [rad]
  double azimuth = 0.0;    ///< added to that of the rotation [rad]
  double delay = 0.0;      ///< after the firing's start, in [0, firing_period] [s]
  double height = 0.0;     ///< of the laser above the sensor's origin, along z [m]
};

/// A turning wedge of glass: one face square to the optical axis, one inclined.
struct WedgePrism {
  double wedge = 0.0;  ///< angle between the faces [rad]
  double refractive_index = 1.51;
  double rotation_rate = 0.0;        ///< about the optical axis, signed [turns per second]
  double phase = 0.0;                ///< at time zero [rad]
  bool is_inclined_at_entry = true;  ///< whether the beam meets the inclined face first
};

/// Errors of a measured distance, each zero when off. The standard deviation of the noise at
/// distance R and incidence theta is
/// sqrt(sigma^2 + (sigma_per_metre R)^2 + (sigma_per_square_metre R^2)^2) /
/// cos(theta)^incidence_power.
struct RangeErrors {
  double sigma = 0.0;  ///< [m]
  double sigma_per_metre = 0.0;
  double sigma_per_square_metre = 0.0;  ///< stereo: s / (f B)  [1/m]
  double incidence_power = 0.0;
  double channel_bias_sigma = 0.0;  ///< of an offset that each channel keeps [m]
  double range_step = 0.0;          ///< distances are rounded to multiples of it, last of all [m]
  double angle_sigma = 0.0;         ///< of the reported azimuth and of the elevation [rad]
};

/// When a shot returns enough light, by the LiDAR equation for an extended diffuse surface: power
/// falls with reflectance * cos(incidence) * exp(-2 attenuation R) / R^2. A shot is lost when that
/// is less than of `reference_reflectance`, faced squarely, at `reference_range` in clear air.
struct Sensitivity {
  double reference_range = 0.0;  ///< [m]; zero: nothing is lost
  double reference_reflectance = 0.1;
  double attenuation = 0.0;  ///< of the air [1/m]
};

/// Which echoes are kept when there are more than the sensor reports.
enum class EchoChoice { first, strongest, last, strongest_and_last };

/// The width of the laser beam. A beam with sub-rays is a Gaussian cone sampled by rays on
/// concentric rings, each with its share of the energy. Echoes nearer to each other than half the
/// pulse's length merge into one at their energy-weighted distance (mixed pixels).
struct Beam {
  int rings = 0;  ///< of sub-rays around the axis, ring i with 6 i of them; zero: one ray, no width
  double divergence_horizontal = 0.0;  ///< full angle between the 1/e^2 points, along azimuth [rad]
  double divergence_vertical = 0.0;    ///< the same along elevation [rad]
  double pulse_length = 5e-9;          ///< [s]
  int max_returns = 1;
  EchoChoice choice = EchoChoice::strongest;
};

/// A laser scanner. Its shots are numbered: firing k starts at k * firing_period after the
/// trajectory's start.
struct LidarConfig {
  double firing_period = 1e-4;                    ///< [s]
  std::vector<Channel> channels = {{}};           ///< in the order in which they fire
  double rotation_rate = 10.0;                    ///< signed [turns per second]
  double radial_offset = 0.0;                     ///< of the lasers from the axis of rotation [m]
  double field_of_view = 2.0 * std::numbers::pi;  ///< around x: no shots outside of it [rad]
  std::vector<WedgePrism> prisms;  ///< not empty: a rosette sensor, which does not spin
  double min_range = 0.0;          ///< [m]; nearer surfaces hide what is behind and give no return
  double max_range = 200.0;        ///< [m]
  RangeErrors errors;
  Sensitivity sensitivity;
  Beam beam;
  std::uint64_t seed = 0;

  /// Throws Error{bad_config} naming the first field that is out of its interval.
  void validate() const;
};

}  // namespace skycap::sim
