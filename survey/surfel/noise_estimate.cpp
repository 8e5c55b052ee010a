#include "survey/surfel/noise_estimate.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace skycap::survey::surfel {
namespace {

constexpr std::size_t min_blocks = 40;  // minimum for a reliable quartile
constexpr double min_cosine =
    0.5;  // beyond 60 degrees, low ray density makes the window too coarse

/// Minimum growth. Smaller growth is caused by curvature and chance.
constexpr double min_growth = 2.5;  // ratio of the variances at the farthest and the nearest depths
constexpr double worst_fit = 0.6;   // relative error of a variance; relief exceeds it
constexpr double farther = 2.0;     // factor for depths beyond the typical depth
constexpr int min_span = 2;         // minimum difference of half octaves

/// Returns n for depths in [2^(n/2), 2^((n+1)/2)). Exact, so that the result does not depend on the
/// platform.
int half_octave(float depth) {
  int exponent = 0;
  const float mantissa = std::frexp(depth, &exponent);  // in [1/2, 1)
  return 2 * (exponent - 1) + (mantissa < 0.70710678F ? 0 : 1);
}

double compute_cosine(const BlockImage& image, const Block& block) {
  return (image.projection.sensor_position - block.mean).normalized().dot(block.normal);
}

/// Returns the lower quartile.
template <typename Value>
Value low_quartile(std::vector<Value>& values) {
  const auto quartile = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
  std::nth_element(values.begin(), quartile, values.end());
  return *quartile;
}

double squared(float value) { return static_cast<double>(value) * value; }

}  // namespace

void NoiseEstimate::add(const BlockImage& image) {
  std::array<std::vector<float>, range_count> residuals;
  for (const Block& block : image.blocks) {
    if (block.residual <= 0.0F) continue;
    const double cosine = compute_cosine(image, block);
    if (cosine < min_cosine) continue;
    const int range = static_cast<int>((cosine - min_cosine) / (1.0 - min_cosine) * range_count);
    residuals[std::min(range, range_count - 1)].push_back(block.residual);
  }
  for (int i = 0; i < range_count; ++i) {
    std::vector<float>& values = residuals[i];
    if (values.size() < min_blocks) continue;
    const double variance = squared(low_quartile(values));
    min_variance_[i] = std::min(min_variance_[i].value_or(variance), variance);
  }
  add_by_depth(image);
}

void NoiseEstimate::add_by_depth(const BlockImage& image) {
  // The quartile of a bin mostly belongs to its nearer part, so the depth of the quartile is stored
  // with it.
  std::map<int, std::vector<std::pair<float, float>>> residuals;
  for (const Block& block : image.blocks) {
    if (block.residual <= 0.0F || !(block.depth > 0.0F)) continue;
    const double cosine = compute_cosine(image, block);
    if (cosine < min_cosine) continue;
    const auto along_ray = static_cast<float>(block.residual / cosine);
    residuals[half_octave(block.depth)].emplace_back(along_ray, block.depth);
  }
  for (auto& [number, values] : residuals) {
    if (values.size() < min_blocks) continue;
    const auto [residual, depth] = low_quartile(values);
    const VarianceAt found{squared(residual), depth};
    VarianceAt& min = by_depth_.emplace(number, found).first->second;
    if (found.variance < min.variance) min = found;
  }
}

/// Fits (a + b z^4) / variance = 1 by least squares of relative errors.
void NoiseEstimate::let_grow(Noise& noise, double depth) const {
  if (by_depth_.empty()) return;
  const auto& [nearest, near] = *by_depth_.begin();
  const auto& [farthest, far] = *by_depth_.rbegin();
  if (farthest - nearest < min_span || far.variance < min_growth * near.variance) return;
  double aa = 0.0, ab = 0.0, bb = 0.0, a1 = 0.0, b1 = 0.0;
  for (const auto& [number, at] : by_depth_) {
    const double one = 1.0 / at.variance, fourth = std::pow(at.depth, 4) / at.variance;
    aa += one * one, ab += one * fourth, bb += fourth * fourth;
    a1 += one, b1 += fourth;
  }
  const double determinant = aa * bb - ab * ab;
  double a = (a1 * bb - b1 * ab) / determinant, b = (aa * b1 - ab * a1) / determinant;
  if (a < 0.0) a = 0.0, b = b1 / bb;
  if (!(b > 0.0)) return;
  const auto fitted = [&](const VarianceAt& at) { return a + b * std::pow(at.depth, 4); };
  if (fitted(far) < min_growth * fitted(near)) return;
  for (const auto& [number, at] : by_depth_) {
    if (std::abs(fitted(at) / at.variance - 1.0) > worst_fit) return;
  }
  const double grown = b * std::pow(depth, 4), variance = a + grown;
  noise = {.along_ray = std::sqrt(variance), .growing = grown / variance, .depth = depth};
}

std::optional<Noise> NoiseEstimate::noise(double negligible, double depth) const {
  std::optional<Noise> noise = constant_noise();
  if (!noise) return std::nullopt;
  if (noise->across(1.0) > 0.0) let_grow(*noise, depth);
  return noise->at(farther * depth).across(1.0) < negligible ? Noise{} : *noise;
}

std::optional<Noise> NoiseEstimate::constant_noise() const {
  // Least-squares fit of variance = a + b c^2 through the centres of the ranges.
  double n = 0.0, sum_x = 0.0, sum_y = 0.0, sum_xx = 0.0, sum_xy = 0.0;
  for (int i = 0; i < range_count; ++i) {
    if (!min_variance_[i]) continue;
    const double cosine = min_cosine + (1.0 - min_cosine) * (i + 0.5) / range_count;
    const double x = cosine * cosine, y = *min_variance_[i];
    n += 1.0;
    sum_x += x;
    sum_y += y;
    sum_xx += x * x;
    sum_xy += x * y;
  }
  if (n == 0.0) return std::nullopt;
  const double spread = n * sum_xx - sum_x * sum_x;
  // A single range cannot distinguish both parts. Isotropic noise is the conservative assumption,
  // because it requires more observations.
  const double slope = n >= 2.0 ? std::max(0.0, (n * sum_xy - sum_x * sum_y) / spread) : 0.0;
  double isotropic = (sum_y - slope * sum_x) / n, along_ray = slope;
  if (isotropic < 0.0) {
    isotropic = 0.0;
    along_ray = sum_xy / sum_xx;
  }
  return Noise{.isotropic = std::sqrt(isotropic), .along_ray = std::sqrt(along_ray)};
}

}  // namespace skycap::survey::surfel
