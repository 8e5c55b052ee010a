/// The voxels that a segment passes, in order: Amanatides & Woo, A Fast Voxel Traversal Algorithm
/// for Ray Tracing, Eurographics 1987, over voxels grouped in bricks of 4 x 4 x 4 and blocks of
/// 4 x 4 x 4 bricks.
///
/// Where the segment crosses the borders of voxels is kept in fixed point. Those of bricks and
/// blocks are some of the same numbers, so that walks over larger cells cross the same borders in
/// the same order, and a walk over smaller ones can begin exactly wherever one of larger ones got.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include <Eigen/Core>

namespace skycap::survey::volumetric {

/// Number of a voxel, brick or block on each axis; (0, 0, 0) has its lowest corner at the origin.
using VoxelIndex = std::array<std::int32_t, 3>;

inline constexpr int brick_shift = 2;
inline constexpr int block_shift = 4;
inline constexpr std::size_t voxels_in_brick = 64;
inline constexpr std::size_t bricks_in_block = 64;

inline VoxelIndex voxel_at(const Eigen::Vector3f& point, double voxels_per_metre) {
  const auto on_axis = [&](int axis) {
    return static_cast<std::int32_t>(std::floor(voxels_per_metre * double{point[axis]}));
  };
  return {on_axis(0), on_axis(1), on_axis(2)};
}

/// The larger cell that a smaller one is in.
inline VoxelIndex coarser(const VoxelIndex& cell, int shift) {
  return {cell[0] >> shift, cell[1] >> shift, cell[2] >> shift};
}

/// The place of a voxel in its brick, or of a brick in its block: below 64.
inline std::uint32_t place_of(const VoxelIndex& cell) {
  return (static_cast<std::uint32_t>(cell[0]) & 3U) |
         (static_cast<std::uint32_t>(cell[1]) & 3U) << 2 |
         (static_cast<std::uint32_t>(cell[2]) & 3U) << 4;
}

/// A border that a segment crosses: where along it, in units of its own, and on which axis.
struct Crossing {
  std::int64_t distance = -(std::int64_t{1} << 60);  ///< before any border
  int axis = 0;

  bool operator==(const Crossing&) const = default;
};

/// A segment among voxels. The directions and borders are rounded as OctoMap rounds them, so that
/// the two pass the same voxels: from the one of `origin` up to, but not with, the one of `end`.
class VoxelLine {
 public:
  VoxelLine(const Eigen::Vector3f& origin, const Eigen::Vector3f& end, double resolution);

  /// Whether no voxel is passed.
  bool is_in_one_voxel() const { return steps_ == 0; }

  /// Ends the segment where it is farther than `length` from its origin, if that is sooner.
  void stop_at(double length);

  /// How many voxels are left behind with a crossing.
  std::int64_t voxels_before(const Crossing& crossing) const {
    return crossed(0, 0, crossing) + crossed(1, 0, crossing) + crossed(2, 0, crossing);
  }
  /// The voxel that a crossing leaves.
  VoxelIndex voxel_before(const Crossing& crossing) const;

  /// What a walk from voxel to voxel needs.
  struct Steps {
    std::array<std::int64_t, 3> border{};   ///< where the first border is crossed on each axis
    std::array<std::int64_t, 3> spacing{};  ///< of the borders
    std::array<std::int32_t, 3> sense{};    ///< 1 or -1: which way the numbers of voxels go
    std::int64_t most = 0;                  ///< that are passed
    std::int64_t surely_passed = 0;         ///< that are passed whatever `limit` says
    std::int64_t limit = 0;  ///< a voxel but the first that is left beyond this is not passed
  };
  Steps steps() const {
    const Crossing last_sure{surely_passed_ - 1, 0};
    return {border_, spacing_, sense_, steps_, steps_ == 0 ? 0 : voxels_before(last_sure), limit_};
  }

 private:
  template <int>
  friend class CellWalk;
  friend class VoxelWalk;

  /// Where the first border of cells of 2^shift voxels is crossed on an axis.
  std::int64_t first_border(int axis, int shift) const {
    const std::int32_t mask = (std::int32_t{1} << shift) - 1;
    const std::int32_t inside = sense_[axis] > 0 ? ~first_[axis] & mask : first_[axis] & mask;
    return border_[axis] + inside * spacing_[axis];
  }

  /// How many such borders are crossed up to and with a crossing. Of equal distances that of the
  /// later axis comes first.
  std::int64_t crossed(int axis, int shift, const Crossing& crossing) const {
    const std::int64_t beyond_first =
        crossing.distance - (axis < crossing.axis ? 1 : 0) - first_border(axis, shift);
    if (beyond_first < 0) return 0;
    const std::int64_t between = spacing_[axis] << shift;
    auto count = static_cast<std::int64_t>(static_cast<double>(beyond_first) *
                                           (per_spacing_[axis] / (1 << shift)));
    count -= count * between > beyond_first ? 1 : 0;  // the product may be off by one
    count += (count + 1) * between <= beyond_first ? 1 : 0;
    return count + 1;
  }

  VoxelIndex first_{};
  std::array<std::int32_t, 3> sense_{};    // 1 or -1: which way the numbers of voxels go
  std::array<std::int64_t, 3> border_{};   // where the first border is crossed
  std::array<std::int64_t, 3> spacing_{};  // of the borders
  std::array<double, 3> per_spacing_{};    // 1 / spacing_
  std::int64_t steps_ = 0;                 // after which the voxel of the end is reached at last
  std::int64_t limit_ = 0;                 // the last voxel is the one left beyond this
  std::int64_t surely_passed_ = 0;         // no voxel left before this is the last
  double units_per_metre_ = 0.0;
};

/// Walks over the cells of 2^shift voxels that a segment meets. Does not end by itself: the cell
/// that may_be_skipped() forbids to pass over has to be looked at voxel by voxel.
template <int shift>
class CellWalk {
 public:
  /// From the cell that a crossing enters.
  explicit CellWalk(const VoxelLine& line, const Crossing& entered = {})
      : entered_(entered), surely_passed_(line.surely_passed_) {
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t before = line.crossed(axis, shift, entered);
      sense_[axis] = line.sense_[axis];
      cell_[axis] = (line.first_[axis] >> shift) + static_cast<std::int32_t>(before) * sense_[axis];
      spacing_[axis] = line.spacing_[axis] << shift;
      next_[axis] = line.first_border(axis, shift) + before * spacing_[axis];
    }
    aim();
  }

  const VoxelIndex& cell() const { return cell_; }
  const Crossing& entered() const { return entered_; }
  const Crossing& leaving() const { return leaving_; }

  /// Whether all of the cell's voxels on the segment are passed, and the segment goes on.
  bool may_be_skipped() const { return leaving_.distance < surely_passed_; }

  void cross() {
    const int axis = leaving_.axis;
    cell_[axis] += sense_[axis];
    next_[axis] += spacing_[axis];
    entered_ = leaving_;
    aim();
  }

 private:
  void aim() {
    if (next_[0] < next_[1] && next_[0] < next_[2]) {
      leaving_ = {next_[0], 0};
    } else if (next_[1] < next_[2]) {
      leaving_ = {next_[1], 1};
    } else {
      leaving_ = {next_[2], 2};
    }
  }

  VoxelIndex cell_{};
  std::array<std::int32_t, 3> sense_{};
  std::array<std::int64_t, 3> next_{}, spacing_{};
  Crossing entered_, leaving_;
  std::int64_t surely_passed_;
};

/// Walks over the voxels of one brick.
class VoxelWalk {
 public:
  /// From the voxel that a crossing enters.
  explicit VoxelWalk(const VoxelLine& line, const Crossing& entered = {});

  /// Whether the segment has arrived: the current voxel is not one of the passed ones any more.
  bool is_over() const { return is_over_; }
  bool left_brick() const { return (local_ & guards) != 0; }

  /// Where the current voxel is in the brick.
  std::uint32_t place() const {
    return (local_ & 0x3U) | (local_ >> 1 & 0xcU) | (local_ >> 2 & 0x30U);
  }

  void advance() {
    const auto step_on = [&](int axis) {
      next_[axis] += spacing_[axis];
      local_ += step_[axis];
    };
    if (next_[0] < next_[1] && next_[0] < next_[2]) {
      step_on(0);
    } else if (next_[1] < next_[2]) {
      step_on(1);
    } else {
      step_on(2);
    }
    --steps_left_;
    is_over_ = (steps_left_ <= 0) | (std::min({next_[0], next_[1], next_[2]}) > limit_);
  }

 private:
  /// Two bits for each axis' place in the brick, and above each a guard that is set by a step out
  /// of the brick, forwards (3 + 1) and backwards (0 - 1) alike.
  static constexpr std::uint32_t guards = 0x124;

  std::array<std::int64_t, 3> next_{}, spacing_{};
  std::array<std::uint32_t, 3> step_{};  // what a step adds to local_
  std::int64_t limit_;
  std::int64_t steps_left_;
  std::uint32_t local_ = 0;
  bool is_over_;
};

/// Visits the bricks that a segment meets, in order. `passes_over(blocks)` says whether to leave
/// out the block that the walk `blocks` is at, which may_be_skipped() has to allow;
/// `visit(bricks)` returns false at the end.
template <typename PassesOver, typename Visit>
void for_each_brick(const VoxelLine& line, PassesOver passes_over, Visit visit) {
  for (CellWalk<block_shift> blocks(line);; blocks.cross()) {
    if (passes_over(blocks)) continue;
    for (CellWalk<brick_shift> bricks(line, blocks.entered());; bricks.cross()) {
      if (!visit(bricks)) return;
      if (bricks.leaving() == blocks.leaving()) break;
    }
  }
}

inline VoxelLine::VoxelLine(const Eigen::Vector3f& origin, const Eigen::Vector3f& end,
                            double resolution) {
  const double voxels_per_metre = 1.0 / resolution;
  first_ = voxel_at(origin, voxels_per_metre);
  const VoxelIndex last = voxel_at(end, voxels_per_metre);
  std::array<std::int64_t, 3> steps{};
  for (int axis = 0; axis < 3; ++axis) {
    steps[axis] = std::abs(static_cast<std::int64_t>(last[axis]) - first_[axis]);
    steps_ += steps[axis];
  }
  if (steps_ == 0) return;

  const Eigen::Vector3f way = end - origin;
  const float squares = way.x() * way.x() + way.y() * way.y() + way.z() * way.z();
  const auto length = static_cast<float>(std::sqrt(double{squares}));
  // 44 bits for the segment; borders that lie far beyond its end are all the same.
  constexpr double units_in_segment = 0x1p44, beyond = 0x1p56;
  units_per_metre_ = units_in_segment / length;
  // The last distance that rounds to the segment's length in single precision.
  const double rounds_to_length =
      0.5 * (double{length} + double{std::nextafter(length, 2 * length)});
  limit_ = static_cast<std::int64_t>(rounds_to_length * units_per_metre_);

  // The voxel of the end is reached by the last of its borders, if no border beyond it comes
  // sooner, which rounding can bring about.
  std::int64_t arrives = 0, overshoots = std::numeric_limits<std::int64_t>::max();
  for (int axis = 0; axis < 3; ++axis) {
    const float direction = way[axis] / length;
    sense_[axis] = direction > 0.0F ? 1 : -1;
    border_[axis] = spacing_[axis] = static_cast<std::int64_t>(beyond);
    if (direction != 0.0F) {
      const double half_voxel = static_cast<float>(0.5 * resolution);
      const double border =
          (first_[axis] + 0.5) * resolution + (direction > 0.0F ? half_voxel : -half_voxel);
      const double to_border = (border - double{origin[axis]}) / double{direction};
      const double between = resolution / std::abs(double{direction});
      border_[axis] = static_cast<std::int64_t>(std::min(to_border * units_per_metre_, beyond));
      spacing_[axis] = static_cast<std::int64_t>(std::min(between * units_per_metre_, beyond));
    }
    per_spacing_[axis] = 1.0 / static_cast<double>(spacing_[axis]);
    const auto border_after = [&](std::int64_t count) {
      return spacing_[axis] == static_cast<std::int64_t>(beyond)
                 ? border_[axis]
                 : border_[axis] + count * spacing_[axis];
    };
    if (steps[axis] > 0) arrives = std::max(arrives, border_after(steps[axis] - 1));
    overshoots = std::min(overshoots, border_after(steps[axis]));
  }
  surely_passed_ = std::min({limit_ + 1, arrives, overshoots});
}

inline void VoxelLine::stop_at(double length) {
  limit_ =
      static_cast<std::int64_t>(std::min(length * units_per_metre_, static_cast<double>(limit_)));
  surely_passed_ = std::min(surely_passed_, limit_ + 1);
}

inline VoxelIndex VoxelLine::voxel_before(const Crossing& crossing) const {
  VoxelIndex voxel = first_;
  for (int axis = 0; axis < 3; ++axis) {
    voxel[axis] += static_cast<std::int32_t>(crossed(axis, 0, crossing)) * sense_[axis];
  }
  voxel[crossing.axis] -= sense_[crossing.axis];
  return voxel;
}

inline VoxelWalk::VoxelWalk(const VoxelLine& line, const Crossing& entered)
    : limit_(line.limit_), steps_left_(line.steps_) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t before = line.crossed(axis, 0, entered);
    steps_left_ -= before;
    spacing_[axis] = line.spacing_[axis];
    next_[axis] = line.border_[axis] + before * spacing_[axis];
    const auto voxel = static_cast<std::uint32_t>(line.first_[axis] + before * line.sense_[axis]);
    local_ |= (voxel & 3U) << 3 * axis;
    step_[axis] = static_cast<std::uint32_t>(line.sense_[axis]) << 3 * axis;
  }
  const bool is_first = entered == Crossing{};
  is_over_ = steps_left_ <= 0 || (!is_first && std::min({next_[0], next_[1], next_[2]}) > limit_);
}

}  // namespace skycap::survey::volumetric
