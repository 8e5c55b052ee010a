#include "survey/photo/stereo_quality.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/LU>

#include "geometry/requirement.h"

namespace skycap::survey::photo {
namespace {

double logistic(double x, double slope, double centre) {
  return 1.0 / (1.0 + std::exp(-slope * (x - centre)));
}

/// Returns the value of a table for k. The first entry applies to k < 0, the last one to all larger
/// k.
template <std::size_t size>
double at(const std::array<double, size>& table, int partners) {
  return table[static_cast<std::size_t>(std::clamp(partners + 1, 0, static_cast<int>(size) - 1))];
}

}  // namespace

void StereoRule::validate() const {
  const double degree = geometry::degrees_per_radian;
  const double rounding = 1e-9;
  require(view_distance > 0.0 && std::isfinite(view_distance), "view_distance", view_distance,
          "more than 0 m");
  require(min_partners >= 2 && min_partners <= 6, "min_partners", min_partners, "between 2 and 6");
  require(degree * max_incidence >= 45.0 - rounding && degree * max_incidence <= 85.0 + rounding,
          "max_incidence_deg", degree * max_incidence, "between 45 and 85 degrees");
  require(degree * min_parallax >= 1.0 - rounding && degree * min_parallax <= 60.0 + rounding,
          "parallax_deg", degree * min_parallax, "between 1 and 60 degrees");
  require(degree * max_parallax >= 1.0 - rounding && degree * max_parallax <= 60.0 + rounding,
          "parallax_deg", degree * max_parallax, "between 1 and 60 degrees");
  require(min_parallax < max_parallax, "parallax_deg", degree * min_parallax,
          "less than the maximum parallax; swap the two angles");
}

StereoPairs::StereoPairs(const StereoRule& rule)
    : rule_(rule),
      min_cosine_(static_cast<float>(std::cos(rule.max_parallax))),
      max_cosine_(static_cast<float>(std::cos(rule.min_parallax))),
      inverse_range_(static_cast<float>(1.0 / rule.max_distance())),
      by_chord_{} {
  for (int i = 0; i <= steps; ++i) {
    const double parallax = 2.0 * std::asin(static_cast<double>(i) / steps);
    by_chord_[static_cast<std::size_t>(i)] =
        static_cast<float>(logistic(parallax, 32.0, std::numbers::pi / 16.0) *
                           (1.0 - logistic(parallax, 8.0, std::numbers::pi / 4.0)));
  }
  by_chord_[steps + 1] = by_chord_[steps];
}

float StereoPairs::reconstructability(const Observation& a, const Observation& b) const {
  const float chord = (a.ray - b.ray).norm();
  const float at = std::min(0.5F * chord, 1.0F) * static_cast<float>(steps);
  const auto step = static_cast<std::size_t>(at);
  const float share = at - static_cast<float>(step);
  const float of_parallax = by_chord_[step] + share * (by_chord_[step + 1] - by_chord_[step]);
  const float of_distance = 1.0F - std::max(a.distance, b.distance) * inverse_range_;
  return of_parallax * std::max(of_distance, 0.0F) * std::min(a.cosine, b.cosine);
}

int stereo_partners(std::span<const Observation> observations, const StereoPairs& pairs) {
  if (observations.empty()) return -2;
  if (observations.size() == 1) return -1;
  int max = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    int partners = 0;
    for (std::size_t j = 0; j < observations.size(); ++j) {
      if (i != j && pairs.are_partners(observations[i], observations[j])) ++partners;
    }
    max = std::max(max, partners);
  }
  return max;
}

double reconstructability(std::span<const Observation> observations, const StereoPairs& pairs) {
  constexpr std::size_t max_observations = 32;
  std::vector<Observation> best(observations.begin(), observations.end());
  if (best.size() > max_observations) {
    std::ranges::stable_sort(best, [](const Observation& a, const Observation& b) {
      return a.distance * b.cosine < b.distance * a.cosine;
    });
    best.resize(max_observations);
  }
  double sum = 0.0;
  for (std::size_t i = 0; i < best.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) sum += pairs.reconstructability(best[i], best[j]);
  }
  return sum;
}

double expected_completeness(int partners) {
  constexpr std::array table{0.0, 0.35, 0.55, 0.80, 0.95, 0.97, 0.99, 0.99};
  return at(table, partners);
}

double expected_threefold(int partners) {
  constexpr std::array table{0.0, 0.16, 0.35, 0.73, 0.86, 0.91, 0.96, 0.98};
  return at(table, partners);
}

double normal_sigma(std::span<const Observation> observations, const Eigen::Vector3f& normal,
                    double focal_length_px, double image_sigma_px) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const Observation& observation : observations) {
    const Eigen::Vector3d ray = observation.ray.cast<double>();
    const double sigma = image_sigma_px * observation.distance / focal_length_px;
    information += (Eigen::Matrix3d::Identity() - ray * ray.transpose()) / (sigma * sigma);
  }
  const Eigen::FullPivLU<Eigen::Matrix3d> decomposed(information);
  if (observations.size() < 2 || !decomposed.isInvertible()) {
    return std::numeric_limits<double>::infinity();
  }
  const Eigen::Vector3d n = normal.cast<double>();
  return std::sqrt(n.dot(decomposed.solve(n)));
}

std::vector<std::uint32_t> same_positions(std::span<const Eigen::Vector3d> positions,
                                          double distance) {
  std::vector<std::uint32_t> same(positions.size());
  std::vector<std::uint32_t> distinct;
  for (std::uint32_t i = 0; i < positions.size(); ++i) {
    const auto first = std::ranges::find_if(distinct, [&](std::uint32_t other) {
      return (positions[i] - positions[other]).norm() < distance;
    });
    same[i] = first == distinct.end() ? i : *first;
    if (first == distinct.end()) distinct.push_back(i);
  }
  return same;
}

}  // namespace skycap::survey::photo
