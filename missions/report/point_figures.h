/// Figures of single points of a survey's cloud, and how they are spread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>

#include "geometry/io/cloud_io.h"
#include "geometry/place/pose.h"

namespace skycap::missions::report {

/// Incidence is kept in whole steps of this many degrees.
inline constexpr double incidence_step_deg = 10.0;
/// Of a point whose normal or view is not known.
inline constexpr std::uint16_t no_incidence = 255;

/// The views of the points, those beyond 16 bits as the last.
std::vector<std::uint16_t> view_numbers(const geometry::AttributedCloud& cloud);

/// For each point the angle between its normal and the way to the sensor that took it, in steps.
std::vector<std::uint16_t> incidence_steps(const geometry::AttributedCloud& cloud,
                                           std::span<const geometry::View> views);

/// For each point how far the sensor was that took it [m]; NaN of an unknown view.
std::vector<float> ranges(const geometry::AttributedCloud& cloud,
                          std::span<const geometry::View> views);

/// What a map of coverage says of each of its points: 0 covered, 1 seen too thinly, 2 never seen,
/// 3 out of reach; of colours that no such map has, 0.
std::vector<std::uint16_t> map_states(const geometry::AttributedCloud& map);

/// The state of measured points: thin within `reach` of a piece of the map that is seen too thinly,
/// else covered. Surface that is out of reach or was never seen may lie behind what was measured.
std::vector<std::uint16_t> point_states(const geometry::AttributedCloud& cloud,
                                        const geometry::AttributedCloud& map, double reach);

/// How far a measurement strays from its place.
struct PointNoise {
  double head_on = 0.0;       ///< standard deviation along the ray [m]
  bool is_along_ray = false;  ///< nowhere else; or the same in all directions
};

/// For a sample of at most 2,500 points the predicted standard error of the surface there, if the
/// points within `reach` are averaged, [m]: sqrt(sum of s_i^2) / n of those n whose incidence is
/// known, s_i being the noise across the surface: `head_on`, times the cosine of the incidence if
/// the noise is along the ray. Errors that neighbours share, such as of the sensor's place, are not
/// in it. Empty without noise or reach.
std::vector<float> surface_errors(const geometry::AttributedCloud& cloud,
                                  std::span<const std::uint16_t> incidence, const PointNoise& noise,
                                  double reach);

/// How many values fall into each of `bins` equal parts of [low, high); those outside count in the
/// first and the last, NaN nowhere.
std::vector<std::size_t> histogram(std::span<const float> values, double low, double high,
                                   std::size_t bins);

/// What the numbers of points stand for: {"states", "incidence_step_deg", "no_incidence"}, the
/// states by the words that files have for them.
nlohmann::ordered_json point_scales();

/// {"incidence_deg", "range_m", "error_m"}: {"low", "high", "counts"} each, without those that
/// nothing is known of; of all points, not only those that a page shows.
nlohmann::ordered_json accuracy_json(std::span<const std::uint16_t> incidence,
                                     std::span<const float> ranges, std::span<const float> errors);

}  // namespace skycap::missions::report
