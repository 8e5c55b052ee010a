#include "missions/online/live/scan_filter.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace skycap::missions::online {
namespace {

constexpr double max_slope = 5.67;  // Tangent of 80 degrees.
// Fraction of the depth, larger than the quantisation steps of depth images.
constexpr double min_jump = 0.03;

/// Depths by pixel; 0 for no-return pixels.
class DepthGrid {
 public:
  DepthGrid(const geometry::Scan& scan, const geometry::Camera& camera)
      : width_(camera.width()),
        height_(camera.height()),
        pixel_size_(1.0 / camera.focal_length_px().minCoeff()),
        depths_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_), 0.0F) {
    const Eigen::Isometry3d sensor_from_world = scan.world_from_sensor.inverse();
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      const Eigen::Vector3d point = sensor_from_world * scan.points[i].cast<double>();
      depths_[scan.pixels[i]] = static_cast<float>(point.z());
    }
  }

  bool is_flying(std::uint32_t pixel) const {
    const int row = pixel_row(pixel), column = pixel_column(pixel);
    constexpr std::array<std::array<int, 2>, 4> directions{{{0, 1}, {1, 0}, {1, 1}, {1, -1}}};
    for (const auto& [down, right] : directions) {
      for (int far = 1; far <= 2; ++far) {
        if (is_between(row, column, far * down, far * right)) return true;
      }
    }
    return false;
  }

  bool is_isolated(std::uint32_t pixel) const {
    constexpr int min = 3;
    const int row = pixel_row(pixel), column = pixel_column(pixel);
    const double depth = at(row, column);
    int others = 0;
    for (int down = -2; down <= 2; ++down) {
      for (int right = -2; right <= 2; ++right) {
        const double other = at(row + down, column + right);
        const int far = std::max(std::abs(down), std::abs(right));
        others += far > 0 && other > 0.0 && std::abs(other - depth) <= far * step(depth) ? 1 : 0;
      }
    }
    return others < min;
  }

 private:
  int pixel_row(std::uint32_t pixel) const {
    return static_cast<int>(pixel / static_cast<std::uint32_t>(width_));
  }
  int pixel_column(std::uint32_t pixel) const {
    return static_cast<int>(pixel % static_cast<std::uint32_t>(width_));
  }
  double at(int row, int column) const {
    if (row < 0 || column < 0 || row >= height_ || column >= width_) return 0.0;
    return depths_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                   static_cast<std::size_t>(column)];
  }
  /// Returns the maximum depth change between adjacent pixels on a single surface.
  double step(double depth) const { return max_slope * pixel_size_ * depth; }

  bool is_between(int row, int column, int down, int right) const {
    const double depth = at(row, column);
    const double before = at(row - down, column - right), after = at(row + down, column + right);
    if (before == 0.0 || after == 0.0) return false;
    const double max =
        std::max(step(depth) * std::max(std::abs(down), std::abs(right)), min_jump * depth);
    const bool is_steep = (before < depth - max && after > depth + max) ||
                          (before > depth + max && after < depth - max);
    return is_steep && goes_on(before, at(row - 2 * down, column - 2 * right), max) &&
           goes_on(after, at(row + 2 * down, column + 2 * right), max);
  }
  static bool goes_on(double depth, double beyond, double max) {
    return beyond == 0.0 || std::abs(beyond - depth) <= max;
  }

  int width_, height_;
  double pixel_size_;  // Pixel size at depth 1.
  std::vector<float> depths_;
};

}  // namespace

LeftOut remove_flying_pixels(geometry::Scan& scan, const geometry::Camera& camera) {
  LeftOut left_out;
  if (scan.pixels.empty()) return left_out;
  const DepthGrid grid(scan, camera);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < scan.pixels.size(); ++i) {
    const bool is_isolated = grid.is_isolated(scan.pixels[i]);
    const bool is_flying = !is_isolated && grid.is_flying(scan.pixels[i]);
    left_out.isolated += is_isolated ? 1 : 0;
    left_out.flying += is_flying ? 1 : 0;
    if (is_isolated || is_flying) continue;
    scan.points[kept] = scan.points[i];
    scan.pixels[kept++] = scan.pixels[i];
  }
  scan.points.resize(kept);
  scan.pixels.resize(kept);
  return left_out;
}

}  // namespace skycap::missions::online
