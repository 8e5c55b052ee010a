#include "survey/skycap/noise_estimate.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace skycap::survey::skycap {
namespace {

constexpr std::size_t least_blocks = 40;  // for a quartile worth its name
constexpr double least_cosine = 0.5;      // beyond 60 degrees few rays make the window too coarse
constexpr double head_on = 0.75;

/// Growth is not believed below this: curvature and chance make some.
constexpr double least_growth = 2.5;  // of the variance from the nearest depths to the farthest
constexpr int least_span = 2;         // half octaves between their middles

/// Exact, so that it is the same everywhere: [2^(n/2), 2^((n+1)/2)) has the number n.
int half_octave(float depth) {
  int exponent = 0;
  const float mantissa = std::frexp(depth, &exponent);  // in [1/2, 1)
  return 2 * (exponent - 1) + (mantissa < 0.70710678F ? 0 : 1);
}

double middle_of(int half_octave) { return std::exp2(0.5 * half_octave + 0.25); }

double cosine_of(const BlockImage& image, const Block& block) {
  return (image.projection.sensor_position - block.mean).normalized().dot(block.normal);
}

/// The square of the lower quartile.
double low_variance(std::vector<float>& residuals) {
  const auto quartile = residuals.begin() + static_cast<std::ptrdiff_t>(residuals.size() / 4);
  std::nth_element(residuals.begin(), quartile, residuals.end());
  return static_cast<double>(*quartile) * *quartile;
}

}  // namespace

void NoiseEstimate::add(const BlockImage& image) {
  std::array<std::vector<float>, range_count> residuals;
  for (const Block& block : image.blocks) {
    if (block.residual <= 0.0F) continue;
    const double cosine = cosine_of(image, block);
    if (cosine < least_cosine) continue;
    const int range =
        static_cast<int>((cosine - least_cosine) / (1.0 - least_cosine) * range_count);
    residuals[std::min(range, range_count - 1)].push_back(block.residual);
  }
  for (int i = 0; i < range_count; ++i) {
    std::vector<float>& values = residuals[i];
    if (values.size() < least_blocks) continue;
    const double variance = low_variance(values);
    least_variance_[i] = std::min(least_variance_[i].value_or(variance), variance);
  }
  add_by_depth(image);
}

void NoiseEstimate::add_by_depth(const BlockImage& image) {
  std::map<int, std::vector<float>> residuals;
  for (const Block& block : image.blocks) {
    if (block.residual <= 0.0F || !(block.depth > 0.0F)) continue;
    if (cosine_of(image, block) >= head_on) {
      residuals[half_octave(block.depth)].push_back(block.residual);
    }
  }
  for (auto& [depth, values] : residuals) {
    if (values.size() < least_blocks) continue;
    const double variance = low_variance(values);
    const auto [known, is_new] = variance_by_depth_.emplace(depth, variance);
    if (!is_new) known->second = std::min(known->second, variance);
  }
}

/// Least squares of relative errors: (a + b z^4) / variance = 1.
void NoiseEstimate::let_grow(Noise& noise, double depth) const {
  if (variance_by_depth_.empty()) return;
  const auto& [nearest, near_variance] = *variance_by_depth_.begin();
  const auto& [farthest, far_variance] = *variance_by_depth_.rbegin();
  if (farthest - nearest < least_span || far_variance < least_growth * near_variance) return;
  double aa = 0.0, ab = 0.0, bb = 0.0, a1 = 0.0, b1 = 0.0;
  for (const auto& [number, variance] : variance_by_depth_) {
    const double one = 1.0 / variance, fourth = std::pow(middle_of(number), 4) / variance;
    aa += one * one, ab += one * fourth, bb += fourth * fourth;
    a1 += one, b1 += fourth;
  }
  const double determinant = aa * bb - ab * ab;
  double a = (a1 * bb - b1 * ab) / determinant, b = (aa * b1 - ab * a1) / determinant;
  if (a < 0.0) a = 0.0, b = b1 / bb;
  if (!(b > 0.0)) return;
  const double grown = b * std::pow(depth, 4), variance = a + grown;
  const double factor = std::sqrt(variance) / noise.across(1.0);
  noise = {.isotropic = factor * noise.isotropic,
           .along_ray = factor * noise.along_ray,
           .growing = grown / variance,
           .depth = depth};
}

std::optional<Noise> NoiseEstimate::noise(double negligible, double depth) const {
  // Least squares for variance = a + b c^2, the line through the ranges' middles.
  double n = 0.0, sum_x = 0.0, sum_y = 0.0, sum_xx = 0.0, sum_xy = 0.0;
  for (int i = 0; i < range_count; ++i) {
    if (!least_variance_[i]) continue;
    const double cosine = least_cosine + (1.0 - least_cosine) * (i + 0.5) / range_count;
    const double x = cosine * cosine, y = *least_variance_[i];
    n += 1.0;
    sum_x += x;
    sum_y += y;
    sum_xx += x * x;
    sum_xy += x * y;
  }
  if (n == 0.0) return std::nullopt;
  const double spread = n * sum_xx - sum_x * sum_x;
  // One range cannot tell the two apart: isotropic is the careful guess, it needs more looks.
  const double slope = n >= 2.0 ? std::max(0.0, (n * sum_xy - sum_x * sum_y) / spread) : 0.0;
  double isotropic = (sum_y - slope * sum_x) / n, along_ray = slope;
  if (isotropic < 0.0) {
    isotropic = 0.0;
    along_ray = sum_xy / sum_xx;
  }
  Noise noise{.isotropic = std::sqrt(isotropic), .along_ray = std::sqrt(along_ray)};
  if (noise.across(1.0) > 0.0) let_grow(noise, depth);
  return noise.across(1.0) < negligible ? Noise{} : noise;
}

}  // namespace skycap::survey::skycap
