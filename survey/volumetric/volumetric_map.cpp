#include "survey/volumetric/volumetric_map.h"

#include <algorithm>
#include <bit>

#include "survey/volumetric/scan_voxels.h"

namespace skycap::survey::volumetric {
namespace {

using Eigen::Vector3f;

}  // namespace

VolumetricMap::VolumetricMap(double resolution, double shadow_length, const OccupancyModel& model)
    : resolution_(resolution), shadow_length_(shadow_length), states_(model) {}

void VolumetricMap::insert(const Vector3f& origin, std::span<const Vector3f> returns,
                           std::span<const Vector3f> empty_ends) {
  std::vector<Block*> changed;
  Block* block = nullptr;  // block of the last voxel
  const ScanVoxels voxels(origin, returns, empty_ends, resolution_, shadow_length_);
  voxels.for_each([&](const VoxelIndex& voxel, ScanVoxels::Mark mark) {
    const VoxelIndex index = coarser(voxel, block_shift);
    if (!block || block->index != index) block = &block_at(index);
    const std::uint32_t brick = index_in_parent(coarser(voxel, brick_shift));
    const std::uint64_t bit = std::uint64_t{1} << brick;
    Code& code = block->codes[brick][index_in_parent(voxel)];
    if (ScanVoxels::is_shadow(mark)) {
      const bool is_less_deep = code != OccupancyStates::untouched && code <= mark;
      if (OccupancyStates::is_measured(code) || is_less_deep) return;
      code = mark;
      block->known |= bit;
      block->shadows |= bit;
      return;
    }
    if (block->changed == 0) changed.push_back(block);
    block->changed |= bit;
    code = mark == ScanVoxels::hit ? states_.after_hit(code) : states_.after_miss(code);
  });
  for (Block* const touched : changed) {
    for (; touched->changed != 0; touched->changed &= touched->changed - 1) {
      summarise(*touched, static_cast<std::uint32_t>(std::countr_zero(touched->changed)));
    }
  }
}

void VolumetricMap::summarise(Block& block, std::uint32_t brick) {
  const VoxelState* const states = states_.table();
  bool has_surface = false, has_shadows = false;
  for (const Code code : block.codes[brick]) {
    has_surface |= states[code].stops_rays;
    has_shadows |= states[code].kind == VoxelKind::shadowed;
  }
  const std::uint64_t bit = std::uint64_t{1} << brick;
  block.known |= bit;
  block.surfaces = has_surface ? block.surfaces | bit : block.surfaces & ~bit;
  block.shadows = has_shadows ? block.shadows | bit : block.shadows & ~bit;
  if (!has_surface) return;
  constexpr int bits = block_shift - brick_shift;
  const Eigen::Vector3d corner((block.index[0] << bits) + static_cast<int>(brick & 3),
                               (block.index[1] << bits) + static_cast<int>(brick >> 2 & 3),
                               (block.index[2] << bits) + static_cast<int>(brick >> 4));
  const double width = resolution_ * (1 << brick_shift);
  surface_box_.extend(width * corner);
  surface_box_.extend(width * (corner + Eigen::Vector3d::Ones()));
}

VolumetricMap::Block& VolumetricMap::block_at(const VoxelIndex& index) {
  if (Block* const block = find(index)) return *block;
  Block& block = blocks_.emplace_back();
  block.index = index;
  index_.insert(make_key(index), &block);
  return block;
}

VolumetricMap::Code VolumetricMap::find_code(const VoxelIndex& voxel) const {
  const Block* const block = find(coarser(voxel, block_shift));
  return block ? block->codes[index_in_parent(coarser(voxel, brick_shift))][index_in_parent(voxel)]
               : OccupancyStates::untouched;
}

std::size_t VolumetricMap::memory() const {
  return blocks_.size() * sizeof(Block) + index_.memory() +
         states_.size() * (sizeof(VoxelState) + 40);
}

}  // namespace skycap::survey::volumetric
