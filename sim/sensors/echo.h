/// Formation of echoes from the ray hits of one laser pulse.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/sensors/sensor.h"

namespace skycap::sim {

/// Hit of one ray of a pulse's beam.
struct RayHit {
  float range;   ///< Range [m].
  float cosine;  ///< Cosine of the angle of incidence, in [0, 1].
  float reflectance;
  float share;  ///< Fraction of the pulse energy in this ray.
  std::uint32_t triangle;
};

struct Echo {
  float range;             ///< Energy-weighted mean range of its rays [m].
  float cosine;            ///< Cosine of incidence of the strongest ray.
  float intensity;         ///< Sum of reflectance * cosine * share, independent of range.
  float power;             ///< Received power relative to the detection threshold.
  std::uint32_t triangle;  ///< Triangle of the strongest ray.
};

/// Returns the received power of one ray relative to the detection threshold, from the LiDAR
/// equation. Infinite for unlimited sensitivity.
float received_power(const RayHit& hit, const Sensitivity& sensitivity);

/// Returns the reported echoes in ascending order of range. Hits closer to the next than half the
/// pulse length, c tau / 2, form one echo. May sort `hits`. Reuses the memory of `buffer`.
std::vector<Echo> form_echoes(std::span<RayHit> hits, const Sensitivity& sensitivity,
                              const Beam& beam, std::vector<Echo> buffer = {});

/// Returns the standard deviation of a measured range [m] (RangeErrors).
float range_sigma(const RangeErrors& errors, float range, float cosine, float reflectance);

/// Ray within a beam's cross-section, in units of the 1/e^2 radius, with its fraction of the
/// energy.
struct BeamSample {
  float horizontal, vertical;
  float share;
};

/// Returns the rays of a Gaussian beam: the axis, and rings of 6, 12, ... rays up to the 1/e^2
/// radius.
std::vector<BeamSample> beam_samples(int rings);

}  // namespace skycap::sim
