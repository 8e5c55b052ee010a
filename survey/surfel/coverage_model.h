/// Coverage model: the probability that the points of one observation cover a surface.
///
/// A position on the surface is covered if a measured point lies within the coverage radius r_d of
/// it. Rays hit a surface in a regular grid, and noise displaces each return, so that one
/// observation covers only a fraction f of the area. Observations from different positions are
/// independent, because their grids are unrelated. Hence the uncovered fractions multiply, and the
/// *hazards* H = -ln(1 - f) add up. The covered fraction after all observations is 1 - exp(-sum of
/// H).
///
/// One quantity thus describes clean data, for which one dense observation covers everything, and
/// noise of several r_d, for which many observations are needed.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace skycap::survey::surfel {

/// Standard deviations of a measured point from the ground truth.
struct Noise {
  double isotropic = 0.0;  ///< along each axis [m]
  double along_ray = 0.0;  ///< additional noise along the measuring ray [m]
  /// Fraction of the variance at `depth` that grows with the fourth power of the depth. This models
  /// triangulating sensors (Khoshelham & Elberink, Accuracy and Resolution of Kinect Depth Data,
  /// Sensors 12, 2012, Eq. (10)).
  double growing = 0.0;
  double depth = 1.0;  ///< depth at which the deviations are valid if they grow [m]
  /// Pose errors, which are common to all points of an observation: position along each axis [m]
  /// and small rotation about each axis [rad].
  double position = 0.0, angle = 0.0;

  /// Returns the standard deviation of the points of one observation across a surface with this
  /// cosine of the angle of incidence [m].
  double across(double cos_incidence) const;
  /// Returns the standard deviation of a whole observation, including pose errors, at depth `z`
  /// [m].
  double lateral_error(double cos_incidence, double z) const;
  /// Returns the noise at depth `z` [m] as a model that does not grow with range.
  Noise at(double z) const;
  /// Returns whether both noise models give the same hazards: the deviations differ by at most
  /// `tolerance` times the noise at normal incidence, and the growing fractions by at most
  /// `tolerance`.
  bool is_similar(const Noise& other, double tolerance) const;
};

/// Covered fraction of one observation for a given coverage radius and noise. Immutable.
///
/// Rays form a square grid as seen by the sensor and hit a plane at a given incidence. Then 1 - f
/// is the mean of prod_i (1 - p_i) over the grid offset. Here, p_i is the probability that the
/// return of ray i is within r_d of the position. A pose error moves all returns of an observation
/// alike, so the mean includes the pose error across the surface. The component along the surface
/// is already part of the grid offset.
///
/// The model is tabulated at construction and interpolated. Construction takes up to 0.1 s, or 0.5
/// s with pose errors.
class CoverageModel {
 public:
  /// `ray_spacing` is the distance between neighbouring rays at a depth of 1 m. It relates a ray
  /// spacing to a depth. It is needed only for noise that grows or contains angles.
  CoverageModel(double coverage_radius, const Noise& noise, double ray_spacing = 1.0);

  /// Returns -ln(1 - covered fraction) of an observation with `ray_density` rays per m^2 of surface
  /// (not of the plane perpendicular to the rays). The result is at most `max_hazard` (99.9%
  /// covered).
  float hazard(float ray_density, float cos_incidence) const {
    const float rays = ray_density * static_cast<float>(coverage_radius_ * coverage_radius_);
    if (!(rays > 0.0F)) return 0.0F;
    // rays = mantissa * 2^octave with a mantissa in [1, 2), taken from the bits of the number.
    const auto bits = std::bit_cast<std::uint32_t>(rays);
    const auto mantissa = std::bit_cast<float>((bits & 0x7fffffU) | 0x3f800000U);
    const float octave =
        static_cast<float>(static_cast<std::int32_t>(bits >> 23U) - 127) + (mantissa - 1.0F);
    const float column = std::clamp(2.0F * (octave - first_octave), 0.0F,
                                    static_cast<float>(density_count) - 1.001F);
    const float row = std::clamp(cos_incidence * static_cast<float>(incidence_count - 1), 0.0F,
                                 static_cast<float>(incidence_count) - 1.001F);
    const auto d = static_cast<std::size_t>(column), c = static_cast<std::size_t>(row);
    const float t = column - static_cast<float>(d), u = row - static_cast<float>(c);
    const auto& low = hazard_per_ray_[c];
    const auto& high = hazard_per_ray_[c + 1];
    const float per_ray = (1.0F - u) * ((1.0F - t) * low[d] + t * low[d + 1]) +
                          u * ((1.0F - t) * high[d] + t * high[d + 1]);
    return std::min(per_ray * rays, max_hazard);
  }

  double coverage_radius() const { return coverage_radius_; }
  const Noise& noise() const { return noise_; }

  static constexpr float max_hazard = 7.0F;

 private:
  static constexpr int density_count = 15;    // rays per r_d^2, from 2^-3 to 2^4, two per octave
  static constexpr int incidence_count = 11;  // cosines from 0 to 1
  static constexpr float first_octave = -3.0F;

  double coverage_radius_;
  Noise noise_;
  /// Hazard divided by the rays per r_d^2, which varies slowly.
  std::array<std::array<float, density_count>, incidence_count> hazard_per_ray_;
};

}  // namespace skycap::survey::surfel
