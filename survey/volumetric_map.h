/// What the volumetric planners know: which voxels are occupied, free, or hidden behind a surface.
/// World frame, metres.
///
/// Occupancy and its update are OctoMap's (Hornung et al. 2013). Shadows, "occlusion marks" in the
/// active-reconstruction literature (Isler et al., ICRA 2016), are voxels behind a measured point
/// that nothing has measured.
///
/// Voxels of two bytes lie in bricks of 8 x 8 x 8 that are found by hashing: a ray looks a brick
/// up once and then reads memory that lies together, and passes bricks that do not exist at the
/// price of counting steps.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "survey/occupancy_states.h"
#include "survey/voxel_walk.h"

namespace skycap::survey {

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
  /// Log-odds of the voxel at a point; nothing unless it was measured.
  std::optional<float> log_odds_at(const Eigen::Vector3f& point) const;

  /// 2 s / res, for shadows of length s: what shadow depths are subtracted from.
  double shadow_ceiling() const { return 2.0 * shadow_length_ / resolution_; }

  /// A box around everything that stops rays; empty if nothing does.
  const Eigen::AlignedBox3d& surface_box() const { return surface_box_; }

  /// Memory taken [byte].
  std::size_t memory() const;

  /// Follows the ray from `origin` to `end`. Tells `ray` of the voxels passed, by
  /// `pass_untouched(count)` for voxels of bricks that do not exist and `pass(state)` for one
  /// voxel; either returns false to say that it wants to know no more. Of a brick in which nothing
  /// stops rays, only the last voxel passed is told if `ray.is_content_with_last(has_shadows)`.
  /// Stops at the first voxel that stops rays, or at the one of `end`, and hands that to
  /// `ray.finish(state)`. Beyond `reach` from `origin` nothing is looked at, and finish() is not
  /// called.
  template <typename Ray>
  void follow(const Eigen::Vector3f& origin, const Eigen::Vector3f& end, double reach,
              Ray& ray) const;

 private:
  using Code = OccupancyStates::Code;

  struct Brick {
    std::array<Code, voxels_in_brick> codes{};
    bool has_surface = false;  // something that stops rays
    bool has_shadows = false;
    std::uint32_t touched = none;  // where it stands in touched_ while a scan is taken in
  };
  /// The voxels of a brick that a scan passed and hit, a bit each.
  struct Touched {
    Brick* brick;
    BrickKey key;
    std::array<std::uint64_t, 8> passed{}, hit{};
  };
  struct Slot {
    BrickKey key = 0;
    Brick* brick = nullptr;
  };
  static constexpr std::uint32_t none = ~std::uint32_t{0};
  static constexpr std::size_t bricks_in_chunk = 64;

  Brick* find(BrickKey key) const {
    for (std::size_t i = slot_of(key);; i = (i + 1) & (slots_.size() - 1)) {
      if (!slots_[i].brick || slots_[i].key == key) return slots_[i].brick;
    }
  }
  std::size_t slot_of(BrickKey key) const {
    return static_cast<std::size_t>(key * 0x9e3779b97f4a7c15ULL >> hash_shift_);
  }
  Brick& brick_at(BrickKey key);  // made if need be
  void grow();
  Touched& touch(BrickKey key);
  void mark_passed(const Eigen::Vector3f& origin, const Eigen::Vector3f& end);
  void mark_hit(const Eigen::Vector3f& point);
  void update_touched();
  void summarise(Brick& brick) const;
  void widen_surface_box(BrickKey key);
  void cast_shadow(const Eigen::Vector3f& origin, const Eigen::Vector3f& point);
  Code code_at(const Eigen::Vector3f& point) const;

  double resolution_;
  double shadow_length_;
  OccupancyStates states_;
  std::vector<Slot> slots_;  // open addressing, linear probing, at most half full
  int hash_shift_;           // 64 - log2 of the number of slots
  std::vector<std::unique_ptr<Brick[]>> chunks_;
  std::size_t bricks_ = 0;
  std::vector<Touched> touched_;
  Eigen::AlignedBox3d surface_box_;
};

template <typename Ray>
void VolumetricMap::follow(const Eigen::Vector3f& origin, const Eigen::Vector3f& end, double reach,
                           Ray& ray) const {
  const VoxelState* const states = states_.table();
  VoxelWalk walk(origin, end, resolution_);
  const bool is_cut = reach < double{(end - origin).norm()};
  if (is_cut) walk.stop_at(reach);
  while (!walk.is_over()) {
    const Brick* const brick = find(walk.brick());
    if (!brick || (!brick->has_surface && ray.is_content_with_last(brick->has_shadows))) {
      const VoxelWalk::Skipped skipped = walk.skip_brick();
      if (skipped.voxels > 0) {
        const bool goes_on = brick ? ray.pass(states[brick->codes[skipped.last_place]])
                                   : ray.pass_untouched(skipped.voxels);
        if (!goes_on) return;
        continue;
      }
    }
    do {
      const VoxelState& state = states[brick ? brick->codes[walk.place()] : Code{}];
      if (state.stops_rays) return ray.finish(state);
      if (!ray.pass(state)) return;
      walk.advance();
    } while (!walk.is_over() && !walk.left_brick());
    if (walk.left_brick()) walk.enter_brick();
  }
  if (!is_cut) ray.finish(state_at(end));
}

}  // namespace skycap::survey
