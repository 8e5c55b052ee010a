#include "survey/volumetric_map.h"

#include <algorithm>
#include <bit>

namespace skycap::survey {
namespace {

using Eigen::Vector3f;

constexpr int first_hash_bits = 10;

/// The number of a brick on an axis, from its key.
std::int32_t brick_on_axis(BrickKey key, int axis) {
  const auto bits = static_cast<std::uint32_t>(key >> 21 * axis) << 11;
  return static_cast<std::int32_t>(bits) >> 11;  // extends the sign
}

}  // namespace

VolumetricMap::VolumetricMap(double resolution, double shadow_length, const OccupancyModel& model)
    : resolution_(resolution),
      shadow_length_(shadow_length),
      states_(model),
      slots_(std::size_t{1} << first_hash_bits),
      hash_shift_(64 - first_hash_bits) {}

void VolumetricMap::insert(const Vector3f& origin, std::span<const Vector3f> returns,
                           std::span<const Vector3f> empty_ends) {
  for (const Vector3f& point : returns) {
    mark_passed(origin, point);
    mark_hit(point);
  }
  for (const Vector3f& end : empty_ends) mark_passed(origin, end);
  update_touched();
  for (const Vector3f& point : returns) cast_shadow(origin, point);
}

void VolumetricMap::mark_passed(const Vector3f& origin, const Vector3f& end) {
  VoxelWalk walk(origin, end, resolution_);
  while (!walk.is_over()) {
    Touched& touched = touch(walk.brick());
    do {
      const std::uint32_t place = walk.place();
      touched.passed[place >> 6] |= std::uint64_t{1} << (place & 63);
      walk.advance();
    } while (!walk.is_over() && !walk.left_brick());
    if (walk.left_brick()) walk.enter_brick();
  }
}

void VolumetricMap::mark_hit(const Vector3f& point) {
  const VoxelIndex voxel = voxel_at(point, 1.0 / resolution_);
  const std::uint32_t place = place_in_brick(voxel);
  touch(brick_of(voxel)).hit[place >> 6] |= std::uint64_t{1} << (place & 63);
}

VolumetricMap::Touched& VolumetricMap::touch(BrickKey key) {
  Brick& brick = brick_at(key);
  if (brick.touched == none) {
    brick.touched = static_cast<std::uint32_t>(touched_.size());
    touched_.push_back({&brick, key});
  }
  return touched_[brick.touched];
}

void VolumetricMap::update_touched() {
  for (Touched& touched : touched_) {
    const auto update = [&](std::size_t word, std::uint64_t bits, auto successor) {
      for (; bits != 0; bits &= bits - 1) {
        Code& code = touched.brick->codes[word * 64 + std::countr_zero(bits)];
        code = (states_.*successor)(code);
      }
    };
    for (std::size_t word = 0; word < touched.hit.size(); ++word) {
      update(word, touched.passed[word] & ~touched.hit[word], &OccupancyStates::after_miss);
      update(word, touched.hit[word], &OccupancyStates::after_hit);
    }
    summarise(*touched.brick);
    if (touched.brick->has_surface) widen_surface_box(touched.key);
    touched.brick->touched = none;
  }
  touched_.clear();
}

void VolumetricMap::summarise(Brick& brick) const {
  const VoxelState* const states = states_.table();
  brick.has_surface = brick.has_shadows = false;
  for (const Code code : brick.codes) {
    brick.has_surface |= states[code].stops_rays;
    brick.has_shadows |= states[code].kind == VoxelKind::shadowed;
  }
}

void VolumetricMap::widen_surface_box(BrickKey key) {
  const Eigen::Vector3d brick(brick_on_axis(key, 0), brick_on_axis(key, 1), brick_on_axis(key, 2));
  const double width = resolution_ * (1 << brick_shift);
  surface_box_.extend(width * brick);
  surface_box_.extend(width * (brick + Eigen::Vector3d::Ones()));
}

void VolumetricMap::cast_shadow(const Vector3f& origin, const Vector3f& point) {
  const Vector3f way = point - origin;
  const float length = way.norm();
  if (length == 0.0F) return;
  const Vector3f end = point + way * (static_cast<float>(shadow_length_) / length);
  VoxelWalk walk(point, end, resolution_);
  Brick* brick = nullptr;
  for (Code depth = 0; !walk.is_over(); ++depth) {
    if (depth > 0) {  // the first voxel is the surface's own
      if (!brick) brick = &brick_at(walk.brick());
      Code& code = brick->codes[walk.place()];
      if (code == OccupancyStates::untouched ||
          (!OccupancyStates::is_measured(code) && depth < code)) {
        code = depth;
        brick->has_shadows = true;
      }
    }
    walk.advance();
    if (walk.left_brick()) {
      walk.enter_brick();
      brick = nullptr;
    }
  }
}

VolumetricMap::Brick& VolumetricMap::brick_at(BrickKey key) {
  if (Brick* const brick = find(key)) return *brick;
  if (2 * (bricks_ + 1) > slots_.size()) grow();
  if (bricks_ % bricks_in_chunk == 0) chunks_.push_back(std::make_unique<Brick[]>(bricks_in_chunk));
  Brick* const brick = &chunks_.back()[bricks_ % bricks_in_chunk];
  ++bricks_;
  std::size_t i = slot_of(key);
  while (slots_[i].brick) i = (i + 1) & (slots_.size() - 1);
  slots_[i] = {key, brick};
  return *brick;
}

void VolumetricMap::grow() {
  std::vector<Slot> old(2 * slots_.size());
  old.swap(slots_);
  --hash_shift_;
  for (const Slot& slot : old) {
    if (!slot.brick) continue;
    std::size_t i = slot_of(slot.key);
    while (slots_[i].brick) i = (i + 1) & (slots_.size() - 1);
    slots_[i] = slot;
  }
}

VolumetricMap::Code VolumetricMap::code_at(const Vector3f& point) const {
  const VoxelIndex voxel = voxel_at(point, 1.0 / resolution_);
  const Brick* const brick = find(brick_of(voxel));
  return brick ? brick->codes[place_in_brick(voxel)] : OccupancyStates::untouched;
}

std::optional<float> VolumetricMap::log_odds_at(const Vector3f& point) const {
  const Code code = code_at(point);
  if (!OccupancyStates::is_measured(code)) return std::nullopt;
  return states_.log_odds(code);
}

std::size_t VolumetricMap::memory() const {
  return chunks_.size() * bricks_in_chunk * sizeof(Brick) + slots_.capacity() * sizeof(Slot) +
         touched_.capacity() * sizeof(Touched) + states_.size() * (sizeof(VoxelState) + 40);
}

}  // namespace skycap::survey
