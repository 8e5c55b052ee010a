/// Prediction of how well photogrammetry reconstructs a surface point from the photos that observe
/// it.
///
/// Sources: the rules for stereo partners k and expected completeness were fitted to simulated
/// reconstructions. Reconstructability h is that of Smith et al., "Aerial path planning for urban
/// scene reconstruction: a continuous optimization method and benchmark", ACM TOG 37(6), 2018.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "geometry/angle.h"

namespace skycap::survey::photo {

/// Conditions of an observation and of a stereo pair.
struct StereoRule {
  double view_distance = 10.0;  ///< View distance d that results in the required GSD [m].
  double nearest_focus = 1.0;   ///< Minimum distance of an observation [m].
  double max_incidence =
      75.0 * geometry::radians_per_degree;  ///< Maximum angle between ray and normal [rad].
  double min_parallax =
      5.0 * geometry::radians_per_degree;  ///< Minimum parallax of a pair at the surface [rad].
  double max_parallax =
      40.0 * geometry::radians_per_degree;  ///< Maximum parallax of a pair at the surface [rad].
  int min_partners = 3;  ///< Minimum number K of stereo partners of a satisfied point.

  /// Returns the maximum distance of an observation: twice the view distance [m].
  double max_distance() const { return 2.0 * view_distance; }
  /// Returns the distance below which photos are at the same position and count once [m].
  double same_position() const { return 0.05 * view_distance; }

  /// Throws Error{bad_config} with the name of the first field outside its interval: min_partners 2
  /// to 6, max_incidence 45 to 85 degrees, min_parallax < max_parallax, both 1 to 60 degrees.
  void validate() const;
};

/// Observation of a surface point by a photo.
struct Observation {
  Eigen::Vector3f ray = Eigen::Vector3f::UnitZ();  ///< Unit vector from the point to the photo.
  float distance = 0.0F;                           ///< Distance from the point to the photo [m].
  float cosine = 0.0F;                             ///< Cosine of the angle of incidence.
  std::uint32_t photo = 0;
};

/// Tests of stereo pairs under a rule, with precomputed cosines and a table of Smith's parallax
/// function.
class StereoPairs {
 public:
  explicit StereoPairs(const StereoRule& rule);

  const StereoRule& rule() const { return rule_; }

  /// Returns true if two observations of a point are stereo partners: the parallax is within its
  /// limits and the distances differ by at most a factor of 2.
  bool are_partners(const Observation& a, const Observation& b) const {
    const float cosine = a.ray.dot(b.ray);
    return cosine >= min_cosine_ && cosine <= max_cosine_ && a.distance <= 2.0F * b.distance &&
           b.distance <= 2.0F * a.distance;
  }

  /// Returns the pair's term in Smith's sum: L(a; 32, pi/16) (1 - L(a; 8, pi/4)) (1 - max(l) / 2d)
  /// min(cos t), where L(x; s, c) = 1 / (1 + exp(-s (x - c))). a is the parallax, l are the
  /// distances and t the angles of incidence.
  float reconstructability(const Observation& a, const Observation& b) const;

 private:
  StereoRule rule_;
  float min_cosine_, max_cosine_, inverse_range_;
  static constexpr int steps = 1800;
  std::array<float, steps + 2> by_chord_;  ///< Table over the chord between unit rays, 0 to 2.
};

/// Returns the largest number of stereo partners of an observation: -2 without observations, -1
/// with one. The photos of the observations must not be at the same position.
int stereo_partners(std::span<const Observation> observations, const StereoPairs& pairs);

/// Returns Smith's h: the sum over all pairs of the 32 observations with the smallest distance /
/// cosine.
double reconstructability(std::span<const Observation> observations, const StereoPairs& pairs);

/// Returns the expected fraction of points with k stereo partners at which a multi-view matcher
/// finds at least one depth within two GSD. Fitted to simulated reconstructions of buildings.
double expected_completeness(int partners);
/// Returns the expected fraction of points with k stereo partners at which a multi-view matcher
/// finds at least three depths within two GSD.
double expected_threefold(int partners);

/// Returns the standard deviation along the normal of a point intersected from these observations
/// [m]: sqrt(n^T A^-1 n) with A = sum_i (I - r_i r_i^T) / (s l_i / f)^2. f is the focal length and
/// s the error of a measured image point, both in pixels. Returns infinity with fewer than two
/// directions.
double normal_sigma(std::span<const Observation> observations, const Eigen::Vector3f& normal,
                    double focal_length_px, double image_sigma_px = 0.5);

/// Groups photos at the same position. Photo i is represented by photo result[i] <= i: the first
/// photo that is closer than `distance` [m] and represents itself.
std::vector<std::uint32_t> same_positions(std::span<const Eigen::Vector3d> positions,
                                          double distance);

}  // namespace skycap::survey::photo
