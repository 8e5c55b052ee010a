/// Laser scanner models, as described in sim/sensors/presets/*.yaml.
///
/// Sensor frame: x forward, y left, z up. A rotating sensor turns around z, anticlockwise from
/// above for a positive rate. Azimuth is the angle from x towards y; elevation is the angle above
/// the x-y plane. A rosette sensor looks along x.
#pragma once

#include <cstdint>
#include <limits>
#include <numbers>
#include <vector>

#include "sim/sensors/noise_table.h"

namespace skycap::sim {

/// One laser. A firing consists of one pulse per channel.
struct Channel {
  double elevation = 0.0;  ///< Elevation [rad].
  double azimuth = 0.0;    ///< Azimuth relative to the rotation [rad].
  double delay = 0.0;      ///< Delay after the start of the firing, in [0, firing_period] [s].
  double height = 0.0;     ///< Height of the laser above the sensor's origin, along z [m].
};

/// Rotating glass wedge with one face perpendicular to the optical axis and one inclined face.
struct WedgePrism {
  double wedge = 0.0;  ///< Angle between the faces [rad].
  double refractive_index = 1.51;
  double rotation_rate = 0.0;  ///< Rate around the optical axis, signed [revolutions per second].
  double phase = 0.0;          ///< Phase at time zero [rad].
  bool is_inclined_at_entry = true;  ///< True if the beam enters through the inclined face.
};

/// Range errors. Zero disables a term. The standard deviation at range R and incidence theta is
/// sqrt(sigma^2 + (sigma_per_metre R)^2 + (sigma_per_square_metre R^2)^2) /
/// cos(theta)^incidence_power, or that of the table.
struct RangeErrors {
  double sigma = 0.0;  ///< Constant term [m].
  double sigma_per_metre = 0.0;
  double sigma_per_square_metre = 0.0;  ///< For stereo: s / (f B) [1/m].
  double incidence_power = 0.0;
  /// Standard deviation of the constant bias of each channel [m].
  double channel_bias_sigma = 0.0;
  double range_step = 0.0;  ///< Final rounding step of ranges [m].
  /// Standard deviation of the reported azimuth and of the elevation [rad].
  double angle_sigma = 0.0;
  NoiseTable table = {};  ///< Replaces the first four terms.
};

/// Detection limit from the LiDAR equation for an extended diffuse surface. The received power is
/// proportional to reflectance * cos(incidence) * exp(-2 attenuation R) / R^2. A pulse is lost
/// below the power of `reference_reflectance` at normal incidence and `reference_range` in clear
/// air.
struct Sensitivity {
  double reference_range = 0.0;  ///< Reference range [m]. 0: no pulse is lost.
  double reference_reflectance = 0.1;
  double attenuation = 0.0;  ///< Attenuation of the air [1/m].
};

/// Selection of echoes if there are more than the sensor reports.
enum class EchoChoice { first, strongest, last, strongest_and_last };

/// Laser beam with finite width: a Gaussian cone, sampled by rays on concentric rings with their
/// fractions of the energy. Echoes separated by less than half the pulse length merge at their
/// energy-weighted range (mixed pixels).
struct Beam {
  /// Number of rings of sub-rays around the axis; ring i has 6 i rays. 0: a single ray without
  /// width.
  int rings = 0;
  double divergence_horizontal = 0.0;  ///< Full angle between the 1/e^2 points along azimuth [rad].
  double divergence_vertical = 0.0;  ///< Full angle between the 1/e^2 points along elevation [rad].
  double pulse_length = 5e-9;        ///< Pulse duration [s].
  int max_returns = 1;
  EchoChoice choice = EchoChoice::strongest;
};

/// Laser scanner. Firing k starts k * firing_period after the start of the trajectory.
struct LidarConfig {
  double firing_period = 1e-4;           ///< Time between firings [s].
  std::vector<Channel> channels = {{}};  ///< In firing order.
  double rotation_rate = 10.0;           ///< Signed rate [revolutions per second].
  double radial_offset = 0.0;            ///< Distance of the lasers from the rotation axis [m].
  /// Field of view around x; there are no pulses outside [rad].
  double field_of_view = 2.0 * std::numbers::pi;
  /// If not empty, the scanner is a rosette sensor without rotation.
  std::vector<WedgePrism> prisms;
  double min_range = 0.0;    ///< Minimum range [m]. Nearer surfaces block the ray without a return.
  double max_range = 200.0;  ///< Maximum range [m].
  RangeErrors errors;
  Sensitivity sensitivity;
  Beam beam;
  std::uint64_t seed = 0;

  /// Throws Error{bad_config} naming the first field outside its interval.
  void validate() const;
};

}  // namespace skycap::sim
