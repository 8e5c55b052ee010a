#include "missions/report/point_figures.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <nlohmann/json.hpp>

#include "geometry/angle.h"
#include "geometry/points/spatial_index.h"
#include "missions/package/coverage_map.h"
#include "missions/package/holes.h"

namespace skycap::missions::report {
namespace {

using Eigen::Vector3f;

bool has_view(const geometry::AttributedCloud& cloud, std::span<const geometry::View> views,
              std::size_t point) {
  return point < cloud.views.size() && cloud.views[point] < views.size();
}

Vector3f to_sensor(const geometry::AttributedCloud& cloud, std::span<const geometry::View> views,
                   std::size_t point) {
  return views[cloud.views[point]].position.cast<float>() - cloud.positions[point];
}

}  // namespace

std::vector<std::uint16_t> view_numbers(const geometry::AttributedCloud& cloud) {
  std::vector<std::uint16_t> views;
  views.reserve(cloud.views.size());
  for (const std::uint32_t view : cloud.views) {
    views.push_back(static_cast<std::uint16_t>(std::min<std::uint32_t>(view, 0xffff)));
  }
  return views;
}

std::vector<std::uint16_t> incidence_steps(const geometry::AttributedCloud& cloud,
                                           std::span<const geometry::View> views) {
  // Compares cosines with those of the step limits, which is faster than computing arc cosines.
  std::vector<float> min_cosines;
  for (double angle = incidence_step_deg; angle < 180.0; angle += incidence_step_deg) {
    min_cosines.push_back(static_cast<float>(std::cos(angle * geometry::radians_per_degree)));
  }
  std::vector<std::uint16_t> steps(cloud.positions.size(), no_incidence);
  if (cloud.normals.empty()) return steps;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!has_view(cloud, views, i)) continue;
    const Vector3f ray = to_sensor(cloud, views, i);
    const float lengths = ray.norm() * cloud.normals[i].norm();
    if (!(lengths > 0.0F)) continue;
    const float cosine = ray.dot(cloud.normals[i]) / lengths;
    const auto end = std::ranges::find_if(min_cosines, [&](float min) { return cosine > min; });
    steps[i] = static_cast<std::uint16_t>(end - min_cosines.begin());
  }
  return steps;
}

std::vector<float> ranges(const geometry::AttributedCloud& cloud,
                          std::span<const geometry::View> views) {
  std::vector<float> ranges(cloud.positions.size(), std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    if (has_view(cloud, views, i)) ranges[i] = to_sensor(cloud, views, i).norm();
  }
  return ranges;
}

std::vector<std::uint16_t> map_states(const geometry::AttributedCloud& map) {
  std::vector<std::uint16_t> states;
  states.reserve(map.positions.size());
  for (std::size_t i = 0; i < map.positions.size(); ++i) {
    const auto reason =
        i < map.colours.size() ? package::find_reason(map.colours[i]) : std::nullopt;
    states.push_back(
        static_cast<std::uint16_t>(reason.value_or(survey::surfel::MissingReason::none)));
  }
  return states;
}

std::vector<std::uint16_t> point_states(const geometry::AttributedCloud& cloud,
                                        const geometry::AttributedCloud& map, double reach) {
  std::vector<std::uint16_t> states(cloud.positions.size(), 0);
  if (!(reach > 0.0)) return states;
  constexpr auto undersampled =
      static_cast<std::uint16_t>(survey::surfel::MissingReason::seen_too_thinly);
  const std::vector<std::uint16_t> surface_states = map_states(map);
  geometry::SpatialIndex undersampled_patches(reach);
  for (std::size_t i = 0; i < surface_states.size(); ++i) {
    if (surface_states[i] == undersampled) undersampled_patches.insert(map.positions[i]);
  }
  if (undersampled_patches.size() == 0) return states;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const std::uint32_t found = undersampled_patches.grid().first_within(cloud.positions[i], reach);
    if (found != geometry::PointGrid::none) states[i] = undersampled;
  }
  return states;
}

std::vector<float> surface_errors(const geometry::AttributedCloud& cloud,
                                  std::span<const std::uint16_t> incidence, const PointNoise& noise,
                                  double reach) {
  if (!(noise.head_on > 0.0) || !(reach > 0.0) || cloud.positions.empty()) return {};
  constexpr std::size_t max_samples = 2'500;
  const std::size_t stride = (cloud.positions.size() + max_samples - 1) / max_samples;
  geometry::PointGrid samples(reach);
  for (std::size_t i = 0; i < cloud.positions.size(); i += stride) {
    samples.insert(cloud.positions[i]);
  }
  std::vector<double> squares(samples.size(), 0.0), counts(samples.size(), 0.0);
  std::vector<geometry::Neighbour> near;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    if (incidence[i] == no_incidence) continue;
    const double angle = (incidence[i] + 0.5) * incidence_step_deg * geometry::radians_per_degree;
    const double across = noise.is_along_ray ? std::abs(std::cos(angle)) : 1.0;
    near.clear();
    samples.find_within(cloud.positions[i], reach, near);
    for (const geometry::Neighbour& sample : near) {
      squares[sample.index] += across * across;
      counts[sample.index] += 1.0;
    }
  }
  std::vector<float> errors;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] == 0.0) continue;
    errors.push_back(static_cast<float>(noise.head_on * std::sqrt(squares[i]) / counts[i]));
  }
  return errors;
}

std::vector<std::size_t> histogram(std::span<const float> values, double low, double high,
                                   std::size_t bins) {
  std::vector<std::size_t> counts(bins, 0);
  const double scale = high > low ? static_cast<double>(bins) / (high - low) : 0.0;
  for (const float value : values) {
    if (std::isnan(value)) continue;
    const double bin = std::floor((static_cast<double>(value) - low) * scale);
    ++counts[static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(bins - 1)))];
  }
  return counts;
}

nlohmann::ordered_json point_scales() {
  using enum survey::surfel::MissingReason;
  nlohmann::ordered_json states = nlohmann::ordered_json::array();
  for (const auto state : {none, seen_too_thinly, never_seen, unreachable}) {
    states[static_cast<std::size_t>(state)] = package::to_string(state);
  }
  return {{"states", states},
          {"incidence_step_deg", incidence_step_deg},
          {"no_incidence", no_incidence}};
}

nlohmann::ordered_json accuracy_json(std::span<const std::uint16_t> incidence,
                                     std::span<const float> ranges, std::span<const float> errors) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  const auto add = [&](const char* name, std::span<const float> values, double high,
                       std::size_t bins) {
    json[name] = {{"low", 0.0}, {"high", high}, {"counts", histogram(values, 0.0, high, bins)}};
  };
  const auto largest = [](std::span<const float> values) {
    float max = 0.0F;  // unlike std::max_element, handles NaN values
    for (const float value : values) max = value > max ? value : max;
    return static_cast<double>(max);
  };
  std::vector<float> degrees;
  for (const std::uint16_t step : incidence) {
    if (step == no_incidence) continue;
    degrees.push_back(static_cast<float>((step + 0.5) * incidence_step_deg));
  }
  if (!degrees.empty()) add("incidence_deg", degrees, 90.0, 9);
  if (largest(ranges) > 0.0) add("range_m", ranges, largest(ranges), 20);
  if (largest(errors) > 0.0) add("error_m", errors, largest(errors), 20);
  return json;
}

}  // namespace skycap::missions::report
