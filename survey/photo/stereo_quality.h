/// How well photogrammetry can reconstruct a surface point from the photos that observe it.
///
/// Sources: stereo partners k and the expected completeness are rules fitted to simulated
/// reconstructions; reconstructability h is that of Smith et al., "Aerial path planning for urban
/// scene reconstruction: a continuous optimization method and benchmark", ACM TOG 37(6), 2018.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/angle.h"

namespace skycap::survey::photo {

/// Conditions of an observation, and of a stereo pair.
struct StereoRule {
  double view_distance = 10.0;  ///< d, at which a surface that faces the camera has the GSD [m]
  double nearest_focus = 1.0;   ///< minimum distance of an observation [m]
  double max_incidence = 75.0 * geometry::radians_per_degree;  ///< between ray and normal [rad]
  double min_parallax = 5.0 * geometry::radians_per_degree;    ///< of a pair, at the surface [rad]
  double max_parallax = 40.0 * geometry::radians_per_degree;   ///< [rad]
  int min_partners = 3;  ///< K, stereo partners of a satisfied point

  /// Distance from which on a photo observes nothing: twice the view distance [m].
  double max_distance() const { return 2.0 * view_distance; }
  /// Photos closer to one another than this count once [m].
  double same_position() const { return 0.05 * view_distance; }

  /// Throws Error{bad_config} naming the first field that is out of its interval: min_partners 2 to
  /// 6, max_incidence 45 to 85 degrees, parallax increasing within 1 to 60 degrees.
  void validate() const;
};

/// An observation of a surface point by a photo.
struct Observation {
  Eigen::Vector3f ray = Eigen::Vector3f::UnitZ();  ///< unit, from the point to the photo
  float distance = 0.0F;                           ///< [m]
  float cosine = 0.0F;                             ///< of the angle of incidence
  std::uint32_t photo = 0;
};

/// The pair tests of a rule with its cosines and the table of Smith's function of parallax.
class StereoPairs {
 public:
  explicit StereoPairs(const StereoRule& rule);

  const StereoRule& rule() const { return rule_; }

  /// Whether two observations of a point are stereo partners: parallax within its limits and
  /// distances within a factor of 2.
  bool are_partners(const Observation& a, const Observation& b) const {
    const float cosine = a.ray.dot(b.ray);
    return cosine >= min_cosine_ && cosine <= max_cosine_ && a.distance <= 2.0F * b.distance &&
           b.distance <= 2.0F * a.distance;
  }

  /// The pair's term of Smith's sum: L(a; 32, pi/16) (1 - L(a; 8, pi/4)) (1 - max(l) / 2d) min(cos
  /// t) with L(x; s, c) = 1 / (1 + exp(-s (x - c))) of the parallax a.
  float reconstructability(const Observation& a, const Observation& b) const;

 private:
  StereoRule rule_;
  float min_cosine_, max_cosine_, inverse_range_;
  static constexpr int steps = 1800;
  std::array<float, steps + 2> by_chord_;  ///< over the chord between unit rays, 0 to 2
};

/// Largest number of stereo partners that one observation has: -2 without observations, -1 with
/// one. Observations must be of photos that are not at the same position.
int stereo_partners(std::span<const Observation> observations, const StereoPairs& pairs);

/// Smith's h: sum over pairs of the 32 observations of least distance / cosine.
double reconstructability(std::span<const Observation> observations, const StereoPairs& pairs);

/// Expected fraction of points with k stereo partners where a multi-view matcher finds at least one
/// depth within two GSD (fitted on simulated reconstructions of buildings).
double expected_completeness(int partners);
/// The same for at least three depths.
double expected_threefold(int partners);

/// Standard deviation along the normal of a point that is intersected from these observations [m]:
/// sqrt(n^T A^-1 n) with A = sum_i (I - r_i r_i^T) / (s l_i / f)^2, where f is the focal length and
/// s the error of a measured image point, both in pixels. Infinite with fewer than two directions.
double normal_sigma(std::span<const Observation> observations, const Eigen::Vector3f& normal,
                    double focal_length_px, double image_sigma_px = 0.5);

/// Which photos stand for which: photo i counts as photo result[i] <= i, the first that is nearer
/// to it than `distance` and stands for itself.
std::vector<std::uint32_t> same_positions(std::span<const Eigen::Vector3d> positions,
                                          double distance);

}  // namespace skycap::survey::photo
