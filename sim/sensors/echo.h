/// From what the rays of one laser shot meet to the echoes that the receiver reports.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/sensors/sensor.h"

namespace skycap::sim {

/// What one ray of a shot's beam has met.
struct RayHit {
  float range;   ///< [m]
  float cosine;  ///< of the angle of incidence, in [0, 1]
  float reflectance;
  float share;  ///< of the pulse's energy that this ray carries
  std::uint32_t triangle;
};

struct Echo {
  float range;      ///< energy-weighted mean of its rays
  float cosine;     ///< of the strongest ray
  float intensity;  ///< reflectance * cosine * share, summed: the range does not matter for it
  float power;      ///< received, relative to the least that is detected
  std::uint32_t triangle;  ///< of the strongest ray
};

/// Received power of one ray relative to the least that is detected; the LiDAR equation. Infinite
/// where the sensitivity has no limit.
float received_power(const RayHit& hit, const Sensitivity& sensitivity);

/// The echoes that are reported, by ascending range. Rays nearer to the next than half the pulse
/// length, c tau / 2, belong to one echo. May sort `hits`; uses the memory of `recycled` again.
std::vector<Echo> form_echoes(std::span<RayHit> hits, const Sensitivity& sensitivity,
                              const Beam& beam, std::vector<Echo> recycled = {});

/// Standard deviation of a measured range (RangeErrors).
float range_sigma(const RangeErrors& errors, float range, float cosine);

/// A ray of a beam's cross-section, in units of the 1/e^2 radius, and its share of the energy.
struct BeamSample {
  float horizontal, vertical;
  float share;
};

/// The rays of a Gaussian beam: its axis, and rings of 6, 12, ... up to the 1/e^2 radius.
std::vector<BeamSample> beam_samples(int rings);

}  // namespace skycap::sim
