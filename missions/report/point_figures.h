/// Per-point figures of a survey's cloud and their distributions.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "geometry/io/cloud_io.h"
#include "geometry/pose/pose.h"

namespace skycap::missions::report {

/// Incidence angles are quantised to integer multiples of this step.
inline constexpr double incidence_step_deg = 10.0;
/// Sentinel for points without a normal or view index.
inline constexpr std::uint16_t no_incidence = 255;

/// Returns the view index of each point, limited to the maximum of 16 bits.
std::vector<std::uint16_t> view_numbers(const geometry::AttributedCloud& cloud);

/// Returns, for each point, the angle between its normal and the direction to the sensor, in steps.
std::vector<std::uint16_t> incidence_steps(const geometry::AttributedCloud& cloud,
                                           std::span<const geometry::View> views);

/// Returns the distance of each point from the sensor that measured it [m]. The distance is NaN if
/// the view is unknown.
std::vector<float> ranges(const geometry::AttributedCloud& cloud,
                          std::span<const geometry::View> views);

/// Returns the state of each point of a coverage map: 0 covered, 1 undersampled, 2 unobserved, 3
/// unreachable. Colours that do not occur in coverage maps are mapped to 0.
std::vector<std::uint16_t> map_states(const geometry::AttributedCloud& map);

/// Returns the state of measured points. It is undersampled within `reach` [m] of an undersampled
/// map point, otherwise covered. Unobserved and unreachable states are not used, because such
/// surface may lie behind measured points.
std::vector<std::uint16_t> point_states(const geometry::AttributedCloud& cloud,
                                        const geometry::AttributedCloud& map, double reach);

/// Standard deviation and direction of measurement noise.
struct PointNoise {
  double head_on = 0.0;  ///< standard deviation along the ray [m]
  /// Whether the noise acts only along the ray; otherwise it is isotropic.
  bool is_along_ray = false;
};

/// Predicts the standard error of the surface [m] at up to 2,500 sample points, for an average over
/// the points within `reach` [m]. It is sqrt(sum of s_i^2) / n over the n points with known
/// incidence. s_i is the noise normal to the surface: `head_on`, multiplied by the cosine of the
/// incidence if the noise is along the ray. Correlated errors, such as position errors of the
/// sensor, are not included. Empty if the noise or `reach` is zero.
std::vector<float> surface_errors(const geometry::AttributedCloud& cloud,
                                  std::span<const std::uint16_t> incidence, const PointNoise& noise,
                                  double reach);

/// Counts the values in each of `bins` equal intervals of [low, high). Values outside are counted
/// in the first or last interval; NaN is ignored.
std::vector<std::size_t> histogram(std::span<const float> values, double low, double high,
                                   std::size_t bins);

/// Returns the meaning of the points' numbers: {"states", "incidence_step_deg", "no_incidence"}.
/// The states are named as in files.
nlohmann::ordered_json point_scales();

/// Returns {"incidence_deg", "range_m", "error_m"}, each with {"low", "high", "counts"}. Unknown
/// values are omitted. All points are counted, not only those displayed.
nlohmann::ordered_json accuracy_json(std::span<const std::uint16_t> incidence,
                                     std::span<const float> ranges, std::span<const float> errors);

}  // namespace skycap::missions::report
