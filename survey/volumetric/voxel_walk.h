/// Voxel traversal of a segment (Amanatides & Woo, A Fast Voxel Traversal Algorithm for Ray
/// Tracing, Eurographics 1987). Voxels are grouped into bricks of 4 x 4 x 4 and blocks of 4 x 4 x 4
/// bricks.
///
/// Border crossings are stored in fixed point. Borders of bricks and blocks are a subset of the
/// voxel borders, so walks over larger cells cross the same borders in the same order. A walk over
/// smaller cells can begin exactly at any crossing of a larger one.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>

#include <Eigen/Core>

namespace skycap::survey::volumetric {

/// Index of a voxel, brick or block on each axis. Cell (0, 0, 0) has its minimum corner at the
/// origin.
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

/// Returns the larger cell that contains `cell`.
inline VoxelIndex coarser(const VoxelIndex& cell, int shift) {
  return {cell[0] >> shift, cell[1] >> shift, cell[2] >> shift};
}

/// Returns the index (below 64) of a voxel in its brick, or of a brick in its block.
inline std::uint32_t index_in_parent(const VoxelIndex& cell) {
  return (static_cast<std::uint32_t>(cell[0]) & 3U) |
         (static_cast<std::uint32_t>(cell[1]) & 3U) << 2 |
         (static_cast<std::uint32_t>(cell[2]) & 3U) << 4;
}

/// Crossing of a segment and a border: fixed-point distance along the segment, and axis.
struct Crossing {
  std::int64_t distance = -(std::int64_t{1} << 60);  ///< before any border
  int axis = 0;

  bool operator==(const Crossing&) const = default;
};

/// Segment in a voxel grid. Directions and borders are rounded as in OctoMap, so that both pass the
/// same voxels: from the voxel of `origin` to that of `end`, which is excluded.
class VoxelLine {
 public:
  VoxelLine(const Eigen::Vector3f& origin, const Eigen::Vector3f& end, double resolution);

  /// Returns whether the segment passes no voxel.
  bool is_in_one_voxel() const { return steps_ == 0; }

  /// Shortens the segment to `length` [m], if it is longer.
  void stop_at(double length);

  /// Returns the number of voxels before a crossing.
  std::int64_t voxels_before(const Crossing& crossing) const {
    return crossed(0, 0, crossing) + crossed(1, 0, crossing) + crossed(2, 0, crossing);
  }
  /// Returns the voxel that is left at a crossing.
  VoxelIndex voxel_before(const Crossing& crossing) const;

  /// Parameters of a walk from voxel to voxel.
  struct Steps {
    std::array<std::int64_t, 3> border{};   ///< distance of the first border on each axis
    std::array<std::int64_t, 3> spacing{};  ///< distance between borders
    std::array<std::int32_t, 3> sense{};    ///< 1 or -1: step of the voxel index
    std::int64_t max = 0;                   ///< number of passed voxels
    std::int64_t surely_passed = 0;         ///< number of voxels passed independent of `limit`
    std::int64_t limit =
        0;  ///< voxels other than the first that are left beyond this distance are not passed
  };
  Steps steps() const {
    const Crossing last_sure{surely_passed_ - 1, 0};
    return {border_, spacing_, sense_, steps_, steps_ == 0 ? 0 : voxels_before(last_sure), limit_};
  }

 private:
  template <int>
  friend class CellWalk;
  friend class VoxelWalk;

  /// Returns the distance of the first border of cells of 2^shift voxels on an axis.
  std::int64_t first_border(int axis, int shift) const {
    const std::int32_t mask = (std::int32_t{1} << shift) - 1;
    const std::int32_t inside = sense_[axis] > 0 ? ~first_[axis] & mask : first_[axis] & mask;
    return border_[axis] + inside * spacing_[axis];
  }

  /// Returns the number of such borders up to and including a crossing. At equal distances, the
  /// later axis is crossed first.
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
  std::array<std::int32_t, 3> sense_{};    // 1 or -1: step of the voxel index
  std::array<std::int64_t, 3> border_{};   // distance of the first border
  std::array<std::int64_t, 3> spacing_{};  // distance between borders
  std::array<double, 3> per_spacing_{};    // 1 / spacing_
  std::int64_t steps_ = 0;                 // number of steps to the voxel of the end
  std::int64_t limit_ = 0;                 // the last voxel is the one left beyond this distance
  std::int64_t surely_passed_ = 0;         // voxels left before this distance are not the last
  double units_per_metre_ = 0.0;
};

/// Walk over the cells of 2^shift voxels that intersect a segment. It has no end: a cell for which
/// may_be_skipped() is false must be traversed voxel by voxel.
template <int shift>
class CellWalk {
 public:
  /// Starts at the cell entered by a crossing.
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

  /// Returns whether the segment passes all voxels of the cell on its line and continues beyond it.
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

/// Walk over the voxels of one brick.
class VoxelWalk {
 public:
  /// Starts at the voxel entered by a crossing.
  explicit VoxelWalk(const VoxelLine& line, const Crossing& entered = {});

  /// Returns whether the end of the segment is reached: the current voxel is not passed.
  bool is_over() const { return is_over_; }
  bool left_brick() const { return (local_ & guards) != 0; }

  /// Returns the index of the current voxel in its brick.
  std::uint32_t child_index() const {
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
  /// Two bits per axis for the position in the brick, each followed by a guard bit. A step out of
  /// the brick sets the guard, both forwards (3 + 1) and backwards (0 - 1).
  static constexpr std::uint32_t guards = 0x124;

  std::array<std::int64_t, 3> next_{}, spacing_{};
  std::array<std::uint32_t, 3> step_{};  // increment of local_ per step
  std::int64_t limit_;
  std::int64_t steps_left_;
  std::uint32_t local_ = 0;
  bool is_over_;
};

/// Visits the bricks that intersect a segment in order. `skip(blocks)` returns whether to
/// skip the current block of the walk, which requires may_be_skipped(). `visit(bricks)` returns
/// false to end the traversal.
template <typename Skip, typename Visit>
void for_each_brick(const VoxelLine& line, Skip skip, Visit visit) {
  for (CellWalk<block_shift> blocks(line);; blocks.cross()) {
    if (skip(blocks)) continue;
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

  const Eigen::Vector3f ray = end - origin;
  const float squares = ray.x() * ray.x() + ray.y() * ray.y() + ray.z() * ray.z();
  const auto length = static_cast<float>(std::sqrt(double{squares}));
  // The segment has 44 bits; all borders far beyond its end have the same distance.
  constexpr double units_in_segment = 0x1p44, beyond = 0x1p56;
  units_per_metre_ = units_in_segment / length;
  // The maximum distance that rounds to the segment length in single precision.
  const double rounds_to_length =
      0.5 * (double{length} + double{std::nextafter(length, 2 * length)});
  limit_ = static_cast<std::int64_t>(rounds_to_length * units_per_metre_);

  // The last border of the end voxel ends the walk, unless rounding lets a border beyond it come
  // first.
  std::int64_t arrives = 0, overshoots = std::numeric_limits<std::int64_t>::max();
  for (int axis = 0; axis < 3; ++axis) {
    const float direction = ray[axis] / length;
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
