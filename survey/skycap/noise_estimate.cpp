#include "survey/skycap/noise_estimate.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace skycap::survey::skycap {
namespace {

constexpr std::size_t least_blocks = 40;  // for a quartile worth its name
constexpr double least_cosine = 0.5;      // beyond 60 degrees few rays make the window too coarse

}  // namespace

void NoiseEstimate::add(const BlockImage& image) {
  std::array<std::vector<float>, range_count> residuals;
  for (const Block& block : image.blocks) {
    if (block.residual <= 0.0F) continue;
    const Eigen::Vector3f towards_sensor =
        (image.projection.sensor_position - block.mean).normalized();
    const double cosine = towards_sensor.dot(block.normal);
    if (cosine < least_cosine) continue;
    const int range =
        static_cast<int>((cosine - least_cosine) / (1.0 - least_cosine) * range_count);
    residuals[std::min(range, range_count - 1)].push_back(block.residual);
  }
  for (int i = 0; i < range_count; ++i) {
    std::vector<float>& values = residuals[i];
    if (values.size() < least_blocks) continue;
    const auto quartile = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 4);
    std::nth_element(values.begin(), quartile, values.end());
    const double variance = static_cast<double>(*quartile) * *quartile;
    least_variance_[i] = std::min(least_variance_[i].value_or(variance), variance);
  }
}

std::optional<Noise> NoiseEstimate::noise(double negligible) const {
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
  const Noise noise{.isotropic = std::sqrt(isotropic), .along_ray = std::sqrt(along_ray)};
  return noise.across(1.0) < negligible ? Noise{} : noise;
}

}  // namespace skycap::survey::skycap
