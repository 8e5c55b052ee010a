/// The voxels that a segment passes, in order: Amanatides & Woo, A Fast Voxel Traversal Algorithm
/// for Ray Tracing, Eurographics 1987, over voxels grouped in bricks of 8 x 8 x 8.
///
/// Where along the segment the next border of each axis is crossed is kept in fixed point, so that
/// a step takes a few integer operations and no branch that a processor would have to guess.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include <Eigen/Core>

namespace skycap::survey {

/// Number of a voxel on each axis; voxel (0, 0, 0) has its lowest corner at the origin.
using VoxelIndex = std::array<std::int32_t, 3>;

/// Bricks are told apart by their numbers on the three axes, 21 bits each.
using BrickKey = std::uint64_t;
inline constexpr int brick_shift = 3;
inline constexpr std::uint32_t brick_mask = 7;
inline constexpr std::size_t voxels_in_brick = 512;

inline VoxelIndex voxel_at(const Eigen::Vector3f& point, double voxels_per_metre) {
  const auto on_axis = [&](int axis) {
    return static_cast<std::int32_t>(std::floor(voxels_per_metre * double{point[axis]}));
  };
  return {on_axis(0), on_axis(1), on_axis(2)};
}

inline BrickKey brick_of(const VoxelIndex& voxel) {
  BrickKey key = 0;
  for (int axis = 2; axis >= 0; --axis) {
    key = key << 21 | (static_cast<BrickKey>(voxel[axis] >> brick_shift) & 0x1fffff);
  }
  return key;
}

/// The voxel's place in its brick, below voxels_in_brick.
inline std::uint32_t place_in_brick(const VoxelIndex& voxel) {
  return (static_cast<std::uint32_t>(voxel[0]) & brick_mask) |
         (static_cast<std::uint32_t>(voxel[1]) & brick_mask) << brick_shift |
         (static_cast<std::uint32_t>(voxel[2]) & brick_mask) << 2 * brick_shift;
}

/// Walks from the voxel of `origin` up to, but not into, the voxel of `end`. The directions and
/// borders are rounded as OctoMap rounds them, so that the two pass the same voxels.
class VoxelWalk {
 public:
  VoxelWalk(const Eigen::Vector3f& origin, const Eigen::Vector3f& end, double resolution);

  /// Whether the walk has arrived: the current voxel is not one of the passed ones any more.
  bool is_over() const { return is_over_; }

  /// Where the current voxel is.
  BrickKey brick() const { return brick_; }
  std::uint32_t place() const {
    return (local_ & 7U) | (local_ >> 1 & 0x38U) | (local_ >> 2 & 0x1c0U);
  }

  /// Whether the last advance() left the brick; then enter_brick() has to be called.
  bool left_brick() const { return (local_ & guards) != 0; }
  void enter_brick();

  /// What skip_brick() passed.
  struct Skipped {
    std::size_t voxels = 0;        ///< zero: the walk ends in this brick, and nothing was skipped
    std::uint32_t last_place = 0;  ///< in the brick, of the last one
  };
  /// Walks through the rest of the brick at once, and enters the next. The same voxels are passed
  /// as by advance().
  Skipped skip_brick();

  /// Ends the walk where it is farther than `length` from its origin, if that is sooner.
  void stop_at(double length) {
    limit_ =
        static_cast<std::int64_t>(std::min(length * units_per_metre_, static_cast<double>(limit_)));
  }

  void advance() {
    // All ones for the axis whose border comes first, zeros for the others.
    const std::int64_t on_x =
        -static_cast<std::int64_t>((next_[0] < next_[1]) & (next_[0] < next_[2]));
    const std::int64_t on_y = ~on_x & -static_cast<std::int64_t>(next_[1] < next_[2]);
    const std::int64_t on_z = ~(on_x | on_y);
    next_[0] += spacing_[0] & on_x;
    next_[1] += spacing_[1] & on_y;
    next_[2] += spacing_[2] & on_z;
    local_ += static_cast<std::uint32_t>((step_[0] & on_x) | (step_[1] & on_y) | (step_[2] & on_z));
    --steps_left_;
    is_over_ = (steps_left_ == 0) | (std::min({next_[0], next_[1], next_[2]}) > limit_);
  }

 private:
  /// Three bits for each axis' place in the brick, and above each a guard that is set by a step
  /// out of the brick, forwards (7 + 1) and backwards (0 - 1) alike.
  static constexpr std::uint32_t guards = 0x888;

  std::array<std::int64_t, 3> next_{};     // distance of the next border, in fixed point
  std::array<std::int64_t, 3> spacing_{};  // of the borders
  std::array<std::int64_t, 3> step_{};     // what a step adds to local_
  std::int64_t limit_ = 0;
  std::int64_t steps_left_ = 0;
  std::uint32_t local_ = 0;
  bool is_over_ = false;
  BrickKey brick_ = 0;
  VoxelIndex brick_index_{};
  double units_per_metre_ = 0.0;
};

inline VoxelWalk::VoxelWalk(const Eigen::Vector3f& origin, const Eigen::Vector3f& end,
                            double resolution) {
  const double voxels_per_metre = 1.0 / resolution;
  const VoxelIndex first = voxel_at(origin, voxels_per_metre);
  const VoxelIndex last = voxel_at(end, voxels_per_metre);
  for (int axis = 0; axis < 3; ++axis) {
    steps_left_ += std::abs(static_cast<std::int64_t>(last[axis]) - first[axis]);
    brick_index_[axis] = first[axis] >> brick_shift;
    local_ |= (static_cast<std::uint32_t>(first[axis]) & brick_mask) << 4 * axis;
  }
  brick_ = brick_of(first);
  is_over_ = steps_left_ == 0;
  if (is_over_) return;

  const Eigen::Vector3f way = end - origin;
  const float squares = way.x() * way.x() + way.y() * way.y() + way.z() * way.z();
  const auto length = static_cast<float>(std::sqrt(double{squares}));
  // 44 bits for the segment; borders that lie far beyond its end are all the same.
  constexpr double units_in_segment = 0x1p44, beyond = 0x1p58;
  units_per_metre_ = units_in_segment / length;
  for (int axis = 0; axis < 3; ++axis) {
    const float direction = way[axis] / length;
    next_[axis] = spacing_[axis] = static_cast<std::int64_t>(beyond);
    if (direction == 0.0F) continue;
    const double half_voxel = static_cast<float>(0.5 * resolution);
    const double border =
        (first[axis] + 0.5) * resolution + (direction > 0.0F ? half_voxel : -half_voxel);
    const double to_border = (border - double{origin[axis]}) / double{direction};
    const double between = resolution / std::abs(double{direction});
    next_[axis] = static_cast<std::int64_t>(std::min(to_border * units_per_metre_, beyond));
    spacing_[axis] = static_cast<std::int64_t>(std::min(between * units_per_metre_, beyond));
    const std::int64_t unit = std::int64_t{1} << 4 * axis;
    step_[axis] = direction > 0.0F ? unit : -unit;
  }
  // The last distance that rounds to the segment's length in single precision.
  const double rounds_to_length =
      0.5 * (double{length} + double{std::nextafter(length, 2 * length)});
  limit_ = static_cast<std::int64_t>(rounds_to_length * units_per_metre_);
}

inline VoxelWalk::Skipped VoxelWalk::skip_brick() {
  // Steps that stay in the brick on each axis, and where the one after them leaves it.
  std::array<std::int64_t, 3> inside{}, leaves{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t at = local_ >> 4 * axis & brick_mask;
    inside[axis] = step_[axis] > 0 ? brick_mask - at : at;
    leaves[axis] = next_[axis] + inside[axis] * spacing_[axis];
  }
  // As in advance(), of equal distances that of the later axis comes first.
  const int last = leaves[0] < leaves[1] && leaves[0] < leaves[2] ? 0
                   : leaves[1] < leaves[2]                        ? 1
                                                                  : 2;
  std::int64_t steps = inside[last] + 1;
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == last) continue;
    const std::int64_t before = leaves[last] - (axis < last ? 1 : 0) - next_[axis];
    inside[axis] = before < 0 ? 0 : before / spacing_[axis] + 1;
    steps += inside[axis];
  }
  if (steps >= steps_left_ || leaves[last] > limit_) return {};

  for (int axis = 0; axis < 3; ++axis) {
    next_[axis] += inside[axis] * spacing_[axis];
    local_ += static_cast<std::uint32_t>(inside[axis] * step_[axis]);
  }
  const std::uint32_t last_place = place();
  next_[last] += spacing_[last];
  local_ += static_cast<std::uint32_t>(step_[last]);
  steps_left_ -= steps;
  is_over_ = std::min({next_[0], next_[1], next_[2]}) > limit_;
  enter_brick();
  return {static_cast<std::size_t>(steps), last_place};
}

inline void VoxelWalk::enter_brick() {
  // A step back from 0 also borrows from the axes above, so the lowest guard is the true one.
  const int axis = (local_ & 0x8) ? 0 : (local_ & 0x80) ? 1 : 2;
  const bool forwards = step_[axis] > 0;
  const auto step = static_cast<std::uint32_t>(step_[axis]);
  const std::uint32_t across = brick_mask << 4 * axis;
  local_ -= step;
  local_ = forwards ? local_ & ~across : local_ | across;
  brick_index_[axis] += forwards ? 1 : -1;
  BrickKey key = 0;
  for (int i = 2; i >= 0; --i) {
    key = key << 21 | (static_cast<BrickKey>(brick_index_[i]) & 0x1fffff);
  }
  brick_ = key;
}

}  // namespace skycap::survey
