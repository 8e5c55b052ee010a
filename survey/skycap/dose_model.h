/// How much one look at a surface is worth: the probability that the points it leaves cover it.
///
/// A place on the surface is covered when a measured point lies within the coverage radius r_d of
/// it. Rays meet a surface in a regular grid of some density and each return is displaced by noise,
/// so a look covers only a share f of the area. Looks from different places are independent, their
/// grids unrelated, so the uncovered shares multiply, and their *hazards* H = -ln(1 - f) add up:
/// the covered share after all looks is 1 - exp(-sum of H). One quantity thus serves clean data
/// (one dense look covers everything) and noise several times r_d (many looks are needed).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace skycap::survey::skycap {

/// Standard deviations of a measured point about the true one.
struct Noise {
  double isotropic = 0.0;  ///< along each axis
  double along_ray = 0.0;  ///< further noise, along the measuring ray only
  /// Of a sensor whose noise grows with range: the share of the variance at `depth` that grows with
  /// the fourth power of the depth. So the noise of triangulating sensors does (Khoshelham &
  /// Elberink, Accuracy and Resolution of Kinect Depth Data, Sensors 12, 2012, Eq. (10)).
  double growing = 0.0;
  double depth = 1.0;  ///< that the deviations hold at if they grow [m]
  /// Errors of the pose, which all points of a look have alike: of the place along each axis [m],
  /// and small angles about each [rad].
  double place = 0.0, angle = 0.0;

  /// Standard deviation of the points of one look across a surface met at this cosine of the angle
  /// of incidence.
  double across(double cos_incidence) const;
  /// That of a whole look, at a depth [m].
  double across_of_look(double cos_incidence, double z) const;
  /// The noise of what is so deep, which does not grow.
  Noise at(double z) const;
  /// Whether the other one is so much like it that doses are the same: all parts within `tolerance`
  /// of the noise across.
  bool is_like(const Noise& other, double tolerance) const;
};

/// The share covered by one look, for one coverage radius and noise. Immutable.
///
/// For rays in a square grid (seen by the sensor) that meet a plane at the given incidence,
/// 1 - f is the mean over the grid's offset of prod_i (1 - p_i), where p_i is the probability that
/// the return of ray i falls into the ball of radius r_d about the place. An error of the pose
/// moves all returns of a look alike: the mean is over it, too, across the surface; along it the
/// grid's offset already is any. It is tabulated at construction (up to a tenth of a second, half
/// of one with such errors) and interpolated.
class DoseModel {
 public:
  /// `ray_spacing` is that of neighbouring rays at one metre of depth, by which a spacing tells the
  /// depth that noise is of; it may be left out for noise that does not grow, nor has angles.
  DoseModel(double coverage_radius, const Noise& noise, double ray_spacing = 1.0);

  /// -ln(1 - covered share) of a look with `ray_density` rays per square metre of surface (not of
  /// the plane across the rays), at most `most_hazard` (99.9 % covered).
  float hazard(float ray_density, float cos_incidence) const {
    const float rays = ray_density * static_cast<float>(coverage_radius_ * coverage_radius_);
    if (!(rays > 0.0F)) return 0.0F;
    // rays = mantissa * 2^octave with a mantissa in [1, 2), read off the number's bits.
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
    return std::min(per_ray * rays, most_hazard);
  }

  double coverage_radius() const { return coverage_radius_; }
  const Noise& noise() const { return noise_; }

  static constexpr float most_hazard = 7.0F;

 private:
  static constexpr int density_count = 15;    // rays per r_d^2, from 2^-3 to 2^4, two an octave
  static constexpr int incidence_count = 11;  // cosines from 0 to 1
  static constexpr float first_octave = -3.0F;

  double coverage_radius_;
  Noise noise_;
  /// Hazard divided by the rays per r_d^2, which varies slowly.
  std::array<std::array<float, density_count>, incidence_count> hazard_per_ray_;
};

}  // namespace skycap::survey::skycap
