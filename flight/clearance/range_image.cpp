#include "flight/clearance/range_image.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/error.h"
#include "geometry/parallel.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

/// Returns the storage index of a pixel.
std::size_t slot(int row, int column, int width) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(column);
}

/// Returns the minimum of each cell and its neighbours, across the seam behind the sensor. The
/// result is 0 (no depth) next to the poles.
std::vector<float> min_filter(const std::vector<float>& depths, int width, int height) {
  std::vector<float> min(depths.size(), 0.0F);
  for (int row = 1; row + 1 < height; ++row) {
    for (int column = 0; column < width; ++column) {
      float nearest = std::numeric_limits<float>::infinity();
      for (int r = row - 1; r <= row + 1; ++r) {
        for (const int c : {(column + width - 1) % width, column, (column + 1) % width}) {
          nearest = std::min(nearest, depths[slot(r, c, width)]);
        }
      }
      min[slot(row, column, width)] = nearest;
    }
  }
  return min;
}

}  // namespace

RangeImage::RangeImage(const geometry::Scan& scan, const geometry::Camera& camera,
                       double depth_without_return, double max_depth, unsigned threads)
    : sensor_from_world_(scan.world_from_sensor.inverse()),
      camera_(camera),
      width_(camera.width()),
      height_(camera.height()) {
  if (scan.pixels.size() != scan.points.size()) {
    throw Error(ErrorKind::bad_geometry,
                "a scan has " + std::to_string(scan.points.size()) + " points but " +
                    std::to_string(scan.pixels.size()) +
                    " pixels; determining free space requires one pixel per point");
  }
  const auto count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_);
  std::vector<float> depths(count, static_cast<float>(std::min(depth_without_return, max_depth)));
  const auto beyond =
      std::ranges::find_if(scan.pixels, [&](std::uint32_t pixel) { return pixel >= count; });
  if (beyond != scan.pixels.end()) {
    throw Error(ErrorKind::bad_geometry, "a scan refers to pixel " + std::to_string(*beyond) +
                                             ", but the camera has only " + std::to_string(count) +
                                             " pixels");
  }
  constexpr std::size_t part_size = 1 << 16;
  const std::size_t parts = (scan.points.size() + part_size - 1) / part_size;
  geometry::parallel_for(parts, threads, [&](std::size_t part) {
    const std::size_t end = std::min(scan.points.size(), (part + 1) * part_size);
    for (std::size_t i = part * part_size; i < end; ++i) {
      const Vector3d in_sensor = sensor_from_world_ * scan.points[i].cast<double>();
      depths[scan.pixels[i]] = static_cast<float>(std::min(in_sensor.z(), max_depth));
    }
  });
  build_pyramid(std::move(depths), threads);
}

RangeImage::RangeImage(const geometry::Scan& scan, const SweepRays& rays, double max_depth,
                       unsigned threads)
    : sensor_from_world_(Eigen::Quaterniond::FromTwoVectors(rays.axis, Vector3d::UnitY()) *
                         scan.world_from_sensor.inverse()),
      origin_spread_(rays.origin_spread) {
  const double ray_spacing = rays.spacing;
  if (!(ray_spacing > 0.0 && ray_spacing < 1.0)) {
    throw Error(ErrorKind::bad_config, "the ray spacing is " + std::to_string(ray_spacing) +
                                           " rad; it must be between 0 and 1 (exclusive)");
  }
  // Cells as wide as the ray spacing contain at least one ray in each scanned direction.
  width_ = static_cast<int>(std::floor(2.0 * pi / ray_spacing));
  pixels_per_radian_ = width_ / (2.0 * pi);
  height_ = static_cast<int>(std::ceil(pi * pixels_per_radian_)) + 1;
  std::vector<float> depths(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_),
                            0.0F);
  for (const Eigen::Vector3f& point : scan.points) {
    const Vector3d p = sensor_from_world_ * point.cast<double>();
    const double range = p.norm();
    if (range == 0.0) continue;
    const double u = (std::atan2(p.x(), p.z()) + pi) * pixels_per_radian_;
    const double v =
        (std::asin(std::clamp(p.y() / range, -1.0, 1.0)) + pi / 2) * pixels_per_radian_;
    const int column = std::min(static_cast<int>(u), width_ - 1);
    float& depth = depths[slot(static_cast<int>(v), column, width_)];
    const auto seen = static_cast<float>(std::min(range, max_depth));
    depth = depth == 0.0F ? seen : std::min(depth, seen);
  }
  if (rays.is_scattered) depths = min_filter(depths, width_, height_);
  build_pyramid(std::move(depths), threads);
}

void RangeImage::build_pyramid(std::vector<float> depths, unsigned threads) {
  levels_.push_back({width_, height_, std::move(depths), {}});
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    levels_.push_back(levels_.back().halved(threads));
  }
}

RangeImage::Level RangeImage::Level::halved(unsigned threads) const {
  Level half{(width + 1) / 2, (height + 1) / 2, {}, {}};
  half.min_depths.resize(slot(half.height, 0, half.width));
  half.max_depths.resize(half.min_depths.size());
  const std::vector<float>&low = min(), &high = max();
  const auto halve_row = [&](int row) {
    for (int column = 0; column < half.width; ++column) {
      const std::size_t target = slot(row, column, half.width);
      const int right = std::min(2 * column + 1, width - 1);
      const int bottom = std::min(2 * row + 1, height - 1);
      const std::size_t quad[] = {slot(2 * row, 2 * column, width), slot(2 * row, right, width),
                                  slot(bottom, 2 * column, width), slot(bottom, right, width)};
      half.min_depths[target] = std::min({low[quad[0]], low[quad[1]], low[quad[2]], low[quad[3]]});
      half.max_depths[target] =
          std::max({high[quad[0]], high[quad[1]], high[quad[2]], high[quad[3]]});
    }
  };
  constexpr int rows_per_part = 64;
  const int parts = (half.height + rows_per_part - 1) / rows_per_part;
  geometry::parallel_for(static_cast<std::size_t>(parts), threads, [&](std::size_t part) {
    const int first = static_cast<int>(part) * rows_per_part;
    for (int row = first; row < std::min(half.height, first + rows_per_part); ++row) halve_row(row);
  });
  return half;
}

RangeImage::Depths RangeImage::over(int left, int right, int top, int bottom) const {
  // Pyramid level at which the patch spans at most three pixels in each direction. Its pixels may
  // cover slightly more than the patch, which is conservative.
  std::size_t level = 0;
  while (((right - left) >> level) > 2 || ((bottom - top) >> level) > 2) ++level;
  const int width = levels_[level].width;
  const std::vector<float>&low = levels_[level].min(), &high = levels_[level].max();
  Depths depths{std::numeric_limits<float>::infinity(), 0.0F};
  for (int row = top >> level; row <= bottom >> level; ++row) {
    for (int column = left >> level; column <= right >> level; ++column) {
      const std::size_t i = slot(row, column, width);
      depths.min = std::min(depths.min, low[i]);
      depths.max = std::max(depths.max, high[i]);
    }
  }
  return depths;
}

/// Returns the depths over a patch of the spherical image that may cross the seam behind the
/// sensor.
RangeImage::Depths RangeImage::over_wrapped(const Patch& patch) const {
  const int top = static_cast<int>(patch.top), bottom = static_cast<int>(patch.bottom);
  const int left = static_cast<int>(patch.left), right = static_cast<int>(patch.right);
  if (right - left >= width_ - 1) return over(0, width_ - 1, top, bottom);
  if (left >= 0 && right < width_) return over(left, right, top, bottom);
  const int first = (left + width_) % width_, last = right % width_;
  const Depths one = over(first, width_ - 1, top, bottom), two = over(0, last, top, bottom);
  return {std::min(one.min, two.min), std::max(one.max, two.max)};
}

std::optional<RangeImage::Patch> RangeImage::pinhole_patch(const Vector3d& centre,
                                                           double radius) const {
  const double nearest = centre.z() - radius, farthest = centre.z() + radius;
  if (nearest <= 0.0) return std::nullopt;
  const auto bounds = [&](double offset, int axis, double& low, double& high) {
    const double focal = camera_->focal_length_px()[axis];
    const double centre_px = camera_->principal_point_px()[axis];
    const double min = offset - radius, max = offset + radius;
    low = centre_px + focal * min / (min < 0.0 ? nearest : farthest);
    high = centre_px + focal * max / (max > 0.0 ? nearest : farthest);
  };
  Patch patch{};
  bounds(centre.x(), 0, patch.left, patch.right);
  bounds(centre.y(), 1, patch.top, patch.bottom);
  // Rays through pixel centres that enclose the patch.
  patch.left = std::floor(patch.left), patch.top = std::floor(patch.top);
  patch.right = std::ceil(patch.right), patch.bottom = std::ceil(patch.bottom);
  patch.nearest = nearest, patch.farthest = farthest;
  return patch;
}

std::optional<RangeImage::Patch> RangeImage::spherical_patch(const Vector3d& centre,
                                                             double radius) const {
  const double range = centre.norm();
  if (range <= radius) return std::nullopt;
  const double half_angle = std::asin(radius / range);
  const double elevation = std::asin(std::clamp(centre.y() / range, -1.0, 1.0));
  const double azimuth = std::atan2(centre.x(), centre.z());
  const double max_elevation = std::abs(elevation) + half_angle;
  // Half the azimuth width of a circle on the sphere, or pi if the circle contains a pole.
  const double half_width =
      max_elevation >= pi / 2
          ? pi
          : std::asin(std::min(1.0, std::sin(half_angle) / std::cos(elevation)));
  Patch patch{};
  patch.left = std::floor((azimuth - half_width + pi) * pixels_per_radian_);
  patch.right = std::floor((azimuth + half_width + pi) * pixels_per_radian_);
  patch.top = std::max(0.0, std::floor((elevation - half_angle + pi / 2) * pixels_per_radian_));
  patch.bottom =
      std::min(height_ - 1.0, std::floor((elevation + half_angle + pi / 2) * pixels_per_radian_));
  patch.nearest = range - radius, patch.farthest = range + radius;
  return patch;
}

BallVisibility RangeImage::visibility(const Vector3d& centre_in_world, double radius,
                                      double margin) const {
  const Vector3d centre = sensor_from_world_ * centre_in_world;
  if (!camera_) {
    // A ray with a displaced origin passes within the spread of its apparent position.
    const std::optional<Patch> patch = spherical_patch(centre, radius + origin_spread_);
    if (!patch) return BallVisibility::partial;
    const Depths depths = over_wrapped(*patch);
    if (depths.min >= patch->farthest + margin) return BallVisibility::free;
    return depths.max < patch->nearest ? BallVisibility::hidden : BallVisibility::partial;
  }
  if (centre.z() + radius <= 0.0) return BallVisibility::hidden;
  const std::optional<Patch> patch = pinhole_patch(centre, radius);
  if (!patch) return BallVisibility::partial;
  if (patch->right < 0 || patch->bottom < 0 || patch->left > width_ - 1 ||
      patch->top > height_ - 1) {
    return BallVisibility::hidden;
  }
  const bool is_in_view = patch->left >= 0 && patch->top >= 0 && patch->right <= width_ - 1 &&
                          patch->bottom <= height_ - 1;
  const auto clip = [](double pixel, int size) {
    return static_cast<int>(std::clamp(pixel, 0.0, size - 1.0));
  };
  const Depths depths = over(clip(patch->left, width_), clip(patch->right, width_),
                             clip(patch->top, height_), clip(patch->bottom, height_));
  if (is_in_view && depths.min >= patch->farthest + margin) return BallVisibility::free;
  return depths.max < patch->nearest ? BallVisibility::hidden : BallVisibility::partial;
}

Eigen::AlignedBox3d RangeImage::reach() const {
  const Eigen::Isometry3d world_from_sensor = sensor_from_world_.inverse();
  const double depth = farthest();
  Eigen::AlignedBox3d box(Vector3d(world_from_sensor.translation()));
  if (!camera_) {
    box.extend(Vector3d(box.min() - Vector3d::Constant(depth)));
    box.extend(Vector3d(world_from_sensor.translation() + Vector3d::Constant(depth)));
    return box;
  }
  for (const double u : {0.0, width_ - 1.0}) {
    for (const double v : {0.0, height_ - 1.0}) {
      box.extend(world_from_sensor * Vector3d(depth * camera_->ray({u, v})));
    }
  }
  return box;
}

}  // namespace skycap::flight
