/// Voxel map of the volumetric planners: occupied, free and shadowed voxels. World frame [m].
///
/// Occupancy and its update are those of OctoMap (Hornung et al. 2013). Shadows are unmeasured
/// voxels behind a measured point; the active-reconstruction literature calls them "occlusion
/// marks" (Isler et al., ICRA 2016).
///
/// Voxels of two bytes are stored in hashed blocks of 16 x 16 x 16. Each block records which of its
/// bricks of 4 x 4 x 4 contain voxels that stop rays. A ray passes unknown or irrelevant blocks and
/// bricks in one step each.
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

/// Events of VolumetricMap::follow() that a ray receives.
enum class RayEvents {
  every_voxel,   ///< every passed voxel, and the one at which the ray stops
  last_skipped,  ///< all relevant voxels and, before each of them, the last skipped voxel
  only_its_end,  ///< all relevant voxels and the end of the ray
};

class VolumetricMap {
 public:
  /// Creates an empty map with voxels of size `resolution` [m]. Shadows extend `shadow_length` [m]
  /// behind measurements, which must be less than deepest_shadow / 2 voxels.
  VolumetricMap(double resolution, double shadow_length, const OccupancyModel& model = {});

  double resolution() const { return resolution_; }

  /// Inserts a scan from `origin`. The voxels of `returns` are hit. Those before `returns`, and
  /// before the ends `empty_ends` of free segments, are missed unless they are hit. A scan changes
  /// a voxel at most once. Afterwards, casts the shadows of `returns`.
  void insert(const Eigen::Vector3f& origin, std::span<const Eigen::Vector3f> returns,
              std::span<const Eigen::Vector3f> empty_ends = {});

  const VoxelState& state_at(const Eigen::Vector3f& point) const {
    return states_.state(code_at(point));
  }

  /// Returns 2 s / res for shadows of length s. Shadow depths are subtracted from it.
  double max_shadow() const { return 2.0 * shadow_length_ / resolution_; }

  /// Returns the bounding box of all voxels that stop rays; empty without such voxels.
  const Eigen::AlignedBox3d& surface_box() const { return surface_box_; }

  /// Returns the allocated memory [bytes].
  std::size_t memory() const;

  /// Follows the ray from `origin` to `end` and reports events according to `ray.ray_events`.
  /// `pass_untouched(count)` reports voxels of missing bricks, and `pass(state)` reports a single
  /// voxel. The ray ends if either returns false.
  ///
  /// Bricks without voxels that stop rays are skipped if `ray.may_miss(has_shadows)`, unless the
  /// ray receives every voxel. The ray stops at the first voxel that stops rays, or at `end`, and
  /// passes that voxel to `ray.finish(state)`. A ray that exceeds the length `reach` [m] ends there
  /// without finish().
  template <typename Ray>
  void follow(const Eigen::Vector3f& origin, const Eigen::Vector3f& end, double reach,
              Ray& ray) const;

 private:
  using Code = OccupancyStates::Code;

  struct Block {
    VoxelIndex index{};
    // Bit masks of bricks.
    std::uint64_t known = 0;     // contains a voxel that is not untouched
    std::uint64_t surfaces = 0;  // contains a voxel that stops rays
    std::uint64_t shadows = 0;   // contains a shadowed voxel
    std::uint64_t changed = 0;   // used while a scan is inserted
    std::array<std::array<Code, voxels_in_brick>, bricks_in_block> codes{};
  };
  static std::uint64_t make_key(
      const VoxelIndex& block) {  // 21 bits per axis, and a carry of the sum
    constexpr std::uint64_t lower_bits = ~std::uint64_t{0} >> 1;
    return lower_bits & static_cast<std::uint64_t>(block[0] + (std::int64_t{block[1]} << 21) +
                                                   (std::int64_t{block[2]} << 42));
  }
  Block* find(const VoxelIndex& block) const {
    Block* const* const found = index_.find(make_key(block));
    return found == nullptr ? nullptr : *found;
  }
  Block& block_at(const VoxelIndex& index);  // creates the block if it does not exist
  void summarise(Block& block, std::uint32_t brick);
  Code find_code(const VoxelIndex& voxel) const;
  Code code_at(const Eigen::Vector3f& point) const {
    return find_code(voxel_at(point, 1.0 / resolution_));
  }

  double resolution_;
  double shadow_length_;
  OccupancyStates states_;
  std::deque<Block> blocks_;
  geometry::HashGrid<Block*> index_;
  Eigen::AlignedBox3d surface_box_;
};

/// Skipped cells of a walk, and the report about them before the next event of the ray.
template <typename Ray, typename StateLookup>
class UnreportedRun {
 public:
  /// `lookup_state(voxel)` returns the state of a voxel of the map.
  UnreportedRun(const VoxelLine& line, Ray& ray, StateLookup lookup_state)
      : line_(line), ray_(ray), lookup_state_(lookup_state) {}

  template <typename Walk>
  void pass_over(const Walk& walk) {
    if (!since_) since_ = walk.entered();
  }

  /// Reports the skipped cells before `entered`. Returns false if the ray ends.
  bool report_before(const Crossing& entered) {
    const std::optional<Crossing> since = std::exchange(since_, std::nullopt);
    if constexpr (Ray::ray_events == RayEvents::every_voxel) {
      return !since || ray_.pass_untouched(static_cast<std::size_t>(line_.voxels_before(entered) -
                                                                    line_.voxels_before(*since)));
    } else if constexpr (Ray::ray_events == RayEvents::last_skipped) {
      return !since || ray_.pass(lookup_state_(line_.voxel_before(entered)));
    }
    return true;
  }

 private:
  const VoxelLine& line_;
  Ray& ray_;
  StateLookup lookup_state_;
  std::optional<Crossing> since_;  // crossing into the first skipped cell
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
    if constexpr (Ray::ray_events == RayEvents::every_voxel)
      return !exists;
    else
      return !exists || (surfaces == 0 && ray.may_miss(shadows != 0));
  };
  const auto lookup_state = [&](const VoxelIndex& voxel) -> const VoxelState& {
    return states[find_code(voxel)];
  };
  UnreportedRun unreported(line, ray, lookup_state);

  const Block* block = nullptr;
  const auto pass_block = [&](const auto& blocks) {
    block = find(blocks.cell());
    const bool is_passed =
        blocks.may_be_skipped() &&
        is_quiet(block != nullptr, block ? block->surfaces : 0, block ? block->shadows : 0);
    if (is_passed) unreported.pass_over(blocks);
    return is_passed;
  };
  for_each_brick(line, pass_block, [&](const auto& bricks) {
    const std::uint32_t brick = index_in_parent(bricks.cell());
    const std::uint64_t bit = std::uint64_t{1} << brick;
    const bool is_known = block && (block->known & bit) != 0;
    if (bricks.may_be_skipped() && is_quiet(is_known, is_known ? block->surfaces & bit : 0,
                                            is_known ? block->shadows & bit : 0)) {
      unreported.pass_over(bricks);
      return true;
    }
    if (!unreported.report_before(bricks.entered())) return false;
    VoxelWalk walk(line, bricks.entered());
    while (!walk.is_over()) {
      const VoxelState& state = states[block ? block->codes[brick][walk.child_index()] : Code{}];
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
