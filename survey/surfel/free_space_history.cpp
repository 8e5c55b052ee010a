#include "survey/surfel/free_space_history.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace skycap::survey::surfel {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

/// Minimum cosine of incidence at which a ray reliably returns.
constexpr float min_hit_cosine = 0.3F;
/// Glass is detected if at least this fraction and this number of the visible points are on rays
/// without a return. Without glass, thin bars and noise cause at most a thousandth.
constexpr double glassy_share = 0.004;
constexpr std::size_t min_missed = 30;

/// Returns whether no neighbouring block has a return. A grazed surface that absorbs the rays is
/// then unlikely, because some neighbours would hit it less obliquely.
bool is_amid_misses(const BlockImage& image, int row, int column) {
  const BlockProjection& p = image.projection;
  for (int r = std::max(0, row - 1); r <= std::min(p.rows - 1, row + 1); ++r) {
    for (int c = std::max(0, column - 1); c <= std::min(p.columns - 1, column + 1); ++c) {
      if (image.blocks[p.block_index(r, c)].returns > 0) return false;
    }
  }
  return true;
}

/// Returns the point on the optical axis at the mean depth of the returns.
Eigen::Vector3f compute_centre(const BlockImage& image) {
  float sum = 0.0F, count = 0.0F;
  for (const Block& block : image.blocks) {
    if (block.returns == 0) continue;
    sum += block.depth;
    count += 1.0F;
  }
  const BlockProjection& p = image.projection;
  const Eigen::Vector3f axis = p.sensor_from_world.row(2);
  return p.sensor_position + sum / std::max(count, 1.0F) * axis;
}

}  // namespace

std::size_t FreeSpaceHistory::DepthImage::bytes() const { return 3 * min.size() * sizeof(float); }

/// Updates the most similar newer image. Images are similar if they show the same place from the
/// same position.
void FreeSpaceHistory::DepthImage::compare(const DepthImage& newer) {
  const float difference = (projection.sensor_position - newer.projection.sensor_position).norm() +
                           (middle - newer.middle).norm();
  if (!(difference < unlikeness)) return;
  unlikeness = difference;
  closest_newer = newer.number;
}

void FreeSpaceHistory::forget_one() {
  const auto min = std::ranges::min_element(images_, {}, &DepthImage::unlikeness);
  const std::size_t gone = min->number;
  bytes_ -= min->bytes();
  images_.erase(min);
  for (std::size_t i = 0; i + 1 < images_.size(); ++i) {
    DepthImage& image = images_[i];
    if (image.number > gone || image.closest_newer != gone) continue;
    image.unlikeness = infinity;
    for (std::size_t j = i + 1; j < images_.size(); ++j) image.compare(images_[j]);
  }
}

void FreeSpaceHistory::add(const BlockImage& image, float noise) {
  const std::size_t count = image.blocks.size();
  DepthImage depth{image.projection,
                   std::vector<float>(count, -infinity),
                   std::vector<float>(count, -infinity),
                   std::vector<float>(count, -infinity),
                   count_++,
                   0.0F,
                   compute_centre(image),
                   image.has_radial_range};
  for (std::size_t i = 0; i < count; ++i) {
    const Block& block = image.blocks[i];
    if (block.returns == 0) {
      const int row = static_cast<int>(i) / image.projection.columns;
      const int column = static_cast<int>(i) % image.projection.columns;
      if (misses_are_empty_ && block.is_scanned && is_amid_misses(image, row, column)) {
        depth.empty_before[i] = infinity;
      }
      continue;
    }
    depth.farthest = std::max(depth.farthest, block.depth);
    // A slanted surface spans depths of sqrt(3) standard deviations on both sides of the mean.
    const float relief = std::sqrt(
        3.0F * std::max(0.0F, block.depth_deviation * block.depth_deviation - noise * noise));
    depth.empty_before[i] = block.depth - relief - tolerance_;
    depth.measured_until[i] = block.depth + relief + tolerance_;
    depth.min[i] = block.min_depth;
  }
  for (DepthImage& older : images_) older.compare(depth);
  bytes_ += depth.bytes();
  images_.push_back(std::move(depth));
  while (bytes_ > max_bytes_ && images_.size() > 1) forget_one();
}

void FreeSpaceHistory::compare_misses(std::span<const Eigen::Vector3f> points,
                                      std::span<const Eigen::Vector3f> normals) {
  if (!misses_are_empty_ || has_false_misses_) return;
  for (const DepthImage& image : images_) {
    const std::size_t first = image.number < compared_images_ ? compared_points_ : 0;
    count_misses(image, points.subspan(first), normals.subspan(first));
  }
  compared_images_ = count_;
  compared_points_ = points.size();
  has_false_misses_ =
      points_missed_ >= min_missed &&
      static_cast<double>(points_missed_) > glassy_share * static_cast<double>(visible_points_);
}

void FreeSpaceHistory::count_misses(const DepthImage& image,
                                    std::span<const Eigen::Vector3f> points,
                                    std::span<const Eigen::Vector3f> normals) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto hit = image.projection.project(points[i]);
    if (!hit || hit->depth > image.farthest || !is_in_range(image, points[i], hit->depth)) continue;
    const Eigen::Vector3f ray = (points[i] - image.projection.sensor_position).normalized();
    if (std::abs(ray.dot(normals[i])) < min_hit_cosine) continue;
    ++visible_points_;
    if (image.empty_before[hit->block] == infinity) ++points_missed_;
  }
}

bool FreeSpaceHistory::is_in_range(const DepthImage& image, const Eigen::Vector3f& point,
                                   float depth) const {
  return range_.contains(image.has_radial_range ? (point - image.projection.sensor_position).norm()
                                                : depth);
}

template <typename IsMissTrusted>
SpaceState FreeSpaceHistory::query(const Eigen::Vector3f& point, std::size_t first,
                                   IsMissTrusted is_miss_trusted) const {
  SpaceState state = SpaceState::outside;
  for (std::size_t i = images_.size(); i-- > 0 && images_[i].number >= first;) {
    const DepthImage& image = images_[i];
    const auto hit = image.projection.project(point);
    if (!hit) continue;
    const float empty_before = image.empty_before[hit->block];
    const bool is_returned = empty_before < infinity;
    if (hit->depth < empty_before &&
        (is_returned || (is_in_range(image, point, hit->depth) && is_miss_trusted(image)))) {
      return SpaceState::empty;
    }
    if (hit->depth <= image.measured_until[hit->block]) {
      state = SpaceState::measured;
    } else if (state == SpaceState::outside && is_in_range(image, point, hit->depth)) {
      state = SpaceState::hidden;
    }
  }
  return state;
}

SpaceState FreeSpaceHistory::query(const Eigen::Vector3f& point, std::size_t first) const {
  return query(point, first, [](const DepthImage& /*image*/) { return true; });
}

SpaceState FreeSpaceHistory::query_surface(const Eigen::Vector3f& point,
                                           const Eigen::Vector3f& normal, std::size_t first) const {
  if (!has_false_misses_) return query(point, first);
  return query(point, first, [&](const DepthImage& image) {
    const Eigen::Vector3f towards_sensor = (image.projection.sensor_position - point).normalized();
    return towards_sensor.dot(normal) >= min_hit_cosine;
  });
}

bool FreeSpaceHistory::is_verified_empty(const Eigen::Vector3f& centre, float radius) const {
  return std::any_of(images_.rbegin(), images_.rend(),
                     [&](const DepthImage& image) { return shows_empty(image, centre, radius); });
}

bool FreeSpaceHistory::is_jointly_verified_empty(const Eigen::Vector3f& centre,
                                                 float radius) const {
  constexpr int divisions = 3;  // The smallest balls have 22% of the radius.
  return is_verified_empty(centre, radius) ||
         is_cube_verified(centre, radius, {centre, radius}, divisions);
}

bool FreeSpaceHistory::is_cube_verified(const Eigen::Vector3f& centre, float half_edge,
                                        const Ball& ball, int divisions) const {
  const Eigen::Vector3f offset = (centre - ball.centre).cwiseAbs();
  const Eigen::Vector3f gap = (offset.array() - half_edge).cwiseMax(0.0F);
  if (gap.squaredNorm() > ball.radius * ball.radius) return true;
  if (is_verified_empty(centre, std::numbers::sqrt3_v<float> * half_edge)) return true;
  if (divisions == 0) return false;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3f side((corner & 1) != 0 ? 1.0F : -1.0F, (corner & 2) != 0 ? 1.0F : -1.0F,
                               (corner & 4) != 0 ? 1.0F : -1.0F);
    if (!is_cube_verified(centre + 0.5F * half_edge * side, 0.5F * half_edge, ball,
                          divisions - 1)) {
      return false;
    }
  }
  return true;
}

bool FreeSpaceHistory::shows_empty(const DepthImage& image, const Eigen::Vector3f& centre,
                                   float radius) {
  const BlockProjection& p = image.projection;
  const Eigen::Vector3f in_sensor = p.sensor_from_world * (centre - p.sensor_position);
  const float nearest = in_sensor.z() - radius, farthest = in_sensor.z() + radius;
  if (!(nearest > 0.0F)) return false;
  // The image of the ball lies within the images of the near and far faces of its bounding box.
  const auto range = [&](int axis) {
    const float low = in_sensor[axis] - radius, high = in_sensor[axis] + radius;
    const float first = p.focal_length[axis] * std::min(low / nearest, low / farthest);
    const float last = p.focal_length[axis] * std::max(high / nearest, high / farthest);
    return Eigen::Vector2i(static_cast<int>(std::floor(first + p.principal_point[axis])),
                           static_cast<int>(std::floor(last + p.principal_point[axis])));
  };
  const Eigen::Vector2i columns = range(0), rows = range(1);
  if (columns[0] < 0 || rows[0] < 0 || columns[1] >= p.columns || rows[1] >= p.rows) return false;
  for (int row = rows[0]; row <= rows[1]; ++row) {
    for (int column = columns[0]; column <= columns[1]; ++column) {
      if (image.min[p.block_index(row, column)] < farthest) return false;
    }
  }
  return true;
}

}  // namespace skycap::survey::surfel
