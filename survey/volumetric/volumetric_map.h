/// What the volumetric planners know: which voxels are occupied, free, or hidden behind a surface.
/// World frame, metres.
///
/// Occupancy and its update are OctoMap's (Hornung et al. 2013). Shadows, "occlusion marks" in the
/// active-reconstruction literature (Isler et al., ICRA 2016), are voxels behind a measured point
/// that nothing has measured.
///
/// Voxels of two bytes lie in blocks of 16 x 16 x 16 that are found by hashing and know which of
/// their bricks of 4 x 4 x 4 have anything that stops a ray. A ray passes blocks and bricks of
/// which nothing is known, or which have nothing to tell it, in one step each.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/points/hash_grid.h"
#include "survey/volumetric/occupancy_states.h"
#include "survey/volumetric/voxel_walk.h"

namespace skycap::survey::volumetric {

/// What a ray that VolumetricMap::follow() follows is told of.
enum class Hears {
  every_voxel,    ///< that it passes, and the one where it stops
  last_left_out,  ///< before anything that it may not miss: the last voxel of what was left out
  only_its_end,   ///< beside what it may not miss
};

class VolumetricMap {
 public:
  /// An empty map of voxels `resolution` wide. Shadows reach `shadow_length` behind measurements,
  /// which must be less than deepest_shadow / 2 voxels.
  VolumetricMap(double resolution, double shadow_length, const OccupancyModel& model = {});

  double resolution() const { return resolution_; }

  /// Takes in a scan from `origin`: the voxels of `returns` are hit; those before them, and before
  /// the ends of the measured-empty segments to `empty_ends`, are missed unless they are hit. A
  /// scan changes a voxel at most once. Then casts the shadows of `returns`.
  void insert(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> returns,
              std::span<const Eigen::Vector3f> empty_ends = {});

  const VoxelState& state_at(const Eigen::Vector3f& point) const {
    return states_.state(code_at(point));
  }

  /// 2 s / res, for shadows of length s: what shadow depths are subtracted from.
  double shadow_ceiling() const { return 2.0 * shadow_length_ / resolution_; }

  /// A box around everything that stops rays; empty if nothing does.
  const Eigen::AlignedBox3d& surface_box() const { return surface_box_; }

  /// Memory taken [byte].
  std::size_t memory() const;

  /// Follows the ray from `origin` to `end` and tells `ray`, as its `hears` says, by
  /// `pass_untouched(count)` of voxels of bricks that do not exist and by `pass(state)` of one
  /// voxel; either returns false to say that it wants to know no more. Bricks in which nothing
  /// stops rays are left out if `ray.may_miss(has_shadows)`, except from rays that hear of every
  /// voxel. Stops at the first voxel that stops rays, or at the one of `end`, and hands that to
  /// `ray.finish(state)`. Beyond `reach` from `origin` nothing is looked at, and finish() is not
  /// called.
  template <typename Ray>
  void follow(const Eigen::Vector3f& origin, const Eigen::Vector3f& end, double reach,
              Ray& ray) const;

 private:
  using Code = OccupancyStates::Code;

  struct Block {
    VoxelIndex index{};
    // A bit for each brick.
    std::uint64_t known = 0;     // has a voxel that is not untouched
    std::uint64_t surfaces = 0;  // has a voxel that stops rays
    std::uint64_t shadows = 0;   // has a shadowed voxel
    std::uint64_t changed = 0;   // while a scan is taken in
    std::array<std::array<Code, voxels_in_brick>, bricks_in_block> codes{};
  };
  static std::uint64_t key_of(const VoxelIndex& block) {  // 21 bits an axis, and a carry of the sum
    constexpr std::uint64_t lower_bits = ~std::uint64_t{0} >> 1;
    return lower_bits & static_cast<std::uint64_t>(block[0] + (std::int64_t{block[1]} << 21) +
                                                   (std::int64_t{block[2]} << 42));
  }
  Block* find(const VoxelIndex& block) const {
    Block* const* const found = index_.find(key_of(block));
    return found == nullptr ? nullptr : *found;
  }
  Block& block_at(const VoxelIndex& index);  // made if need be
  void summarise(Block& block, std::uint32_t brick);
  Code code_of(const VoxelIndex& voxel) const;
  Code code_at(const Eigen::Vector3f& point) const {
    return code_of(voxel_at(point, 1.0 / resolution_));
  }

  double resolution_;
  double shadow_length_;
  OccupancyStates states_;
  std::deque<Block> blocks_;
  geometry::HashGrid<Block*> index_;
  Eigen::AlignedBox3d surface_box_;
};

/// The cells that a walk has passed over without a word to the ray, and what it is told of them
/// before it hears of anything else.
template <typename Ray, typename StateOf>
class UntoldStretch {
 public:
  /// `state_of(voxel)` gives the state of a voxel of the map.
  UntoldStretch(const VoxelLine& line, Ray& ray, StateOf state_of)
      : line_(line), ray_(ray), state_of_(state_of) {}

  template <typename Walk>
  void pass_over(const Walk& walk) {
    if (!since_) since_ = walk.entered();
  }

  /// Tells the ray of what lies before `entered`; false if it wants to know no more.
  bool tell_before(const Crossing& entered) {
    const std::optional<Crossing> since = std::exchange(since_, std::nullopt);
    if constexpr (Ray::hears == Hears::every_voxel) {
      return !since || ray_.pass_untouched(static_cast<std::size_t>(line_.voxels_before(entered) -
                                                                    line_.voxels_before(*since)));
    } else if constexpr (Ray::hears == Hears::last_left_out) {
      return !since || ray_.pass(state_of_(line_.voxel_before(entered)));
    }
    return true;
  }

 private:
  const VoxelLine& line_;
  Ray& ray_;
  StateOf state_of_;
  std::optional<Crossing> since_;  // into the first of the cells
};

template <typename Ray>
void VolumetricMap::follow(const Eigen::Vector3f& origin, const Eigen::Vector3f& end, double reach,
                           Ray& ray) const {
  VoxelLine line(origin, end, resolution_);
  const bool is_cut = reach < double{(end - origin).norm()};
  if (is_cut) line.stop_at(reach);
  if (line.is_in_one_voxel()) {
    if (!is_cut) ray.finish(state_at(end));
    return;
  }

  const VoxelState* const states = states_.table();
  const auto is_quiet = [&](bool exists, std::uint64_t surfaces, std::uint64_t shadows) {
    if constexpr (Ray::hears == Hears::every_voxel)
      return !exists;
    else
      return !exists || (surfaces == 0 && ray.may_miss(shadows != 0));
  };
  const auto state_of = [&](const VoxelIndex& voxel) -> const VoxelState& {
    return states[code_of(voxel)];
  };
  UntoldStretch untold(line, ray, state_of);

  const Block* block = nullptr;
  const auto pass_block = [&](const auto& blocks) {
    block = find(blocks.cell());
    const bool is_passed =
        blocks.may_be_skipped() &&
        is_quiet(block != nullptr, block ? block->surfaces : 0, block ? block->shadows : 0);
    if (is_passed) untold.pass_over(blocks);
    return is_passed;
  };
  for_each_brick(line, pass_block, [&](const auto& bricks) {
    const std::uint32_t brick = place_of(bricks.cell());
    const std::uint64_t bit = std::uint64_t{1} << brick;
    const bool is_known = block && (block->known & bit) != 0;
    if (bricks.may_be_skipped() && is_quiet(is_known, is_known ? block->surfaces & bit : 0,
                                            is_known ? block->shadows & bit : 0)) {
      untold.pass_over(bricks);
      return true;
    }
    if (!untold.tell_before(bricks.entered())) return false;
    VoxelWalk walk(line, bricks.entered());
    while (!walk.is_over()) {
      const VoxelState& state = states[block ? block->codes[brick][walk.place()] : Code{}];
      if (state.stops_rays) {
        ray.finish(state);
        return false;
      }
      if (!ray.pass(state)) return false;
      walk.advance();
      if (walk.left_brick() && !walk.is_over()) return true;
    }
    if (!is_cut) ray.finish(state_at(end));
    return false;
  });
}

}  // namespace skycap::survey::volumetric
