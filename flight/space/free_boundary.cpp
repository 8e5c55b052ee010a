#include <algorithm>
#include <bit>
#include <vector>

#include "flight/space/measured_voxels.h"

namespace skycap::flight {
namespace {

/// One of the six neighbours of a voxel or block.
struct Side {
  int axis;
  bool is_up;
};

constexpr Side sides[] = {{0, false}, {0, true}, {1, false}, {1, true}, {2, false}, {2, true}};

Cell step(const Side& side) { return Cell::Unit(side.axis) * (side.is_up ? 1 : -1); }

/// For each voxel of a block the bit of its neighbour on a side, which may be one of the next
/// block's.
Slices of_neighbours(const Slices& own, const Slices& next, const Side& side) {
  constexpr std::uint64_t first_column = 0x0101010101010101ULL, last_column = first_column << 7;
  Slices moved{};
  for (int z = 0; z < 8; ++z) {
    if (side.axis == 0) {
      moved[z] = side.is_up ? (own[z] & ~first_column) >> 1 | (next[z] & first_column) << 7
                            : (own[z] & ~last_column) << 1 | (next[z] & last_column) >> 7;
    } else if (side.axis == 1) {
      moved[z] = side.is_up ? own[z] >> 8 | next[z] << 56 : own[z] << 8 | next[z] >> 56;
    } else if (side.is_up) {
      moved[z] = z < 7 ? own[z + 1] : next[0];
    } else {
      moved[z] = z > 0 ? own[z - 1] : next[7];
    }
  }
  return moved;
}

}  // namespace

Slices MeasuredSpace::Impl::blocked(const Cell& cell) const {
  const auto found = blocks.find(cell_key(cell));
  return blocked(cell, found == blocks.end() ? VoxelBlock{} : found->second);
}

std::vector<Eigen::Vector3f> MeasuredSpace::free_boundary() const {
  std::vector<std::uint64_t> keys;
  keys.reserve(impl_->blocks.size());
  for (const auto& [key, block] : impl_->blocks) keys.push_back(key);
  std::ranges::sort(keys);
  std::vector<Eigen::Vector3f> faces;
  for (const std::uint64_t key : keys) {
    const Cell cell = cell_of(key);
    const VoxelBlock& block = impl_->blocks.at(key);
    const Slices blocked = impl_->blocked(cell, block);
    for (const Side& side : sides) {
      const Slices beyond = of_neighbours(blocked, impl_->blocked(cell + step(side)), side);
      const Eigen::Vector3d to_face =
          0.5 * step(side).cast<double>() + Eigen::Vector3d::Constant(0.5);
      for (int z = 0; z < 8; ++z) {
        for (std::uint64_t bits = block.passable(z) & beyond[z]; bits != 0; bits &= bits - 1) {
          const int bit = std::countr_zero(bits);
          const Eigen::Vector3d voxel = (8 * cell + Cell(bit % 8, bit / 8, z)).cast<double>();
          faces.emplace_back((impl_->config.voxel * (voxel + to_face)).cast<float>());
        }
      }
    }
  }
  return faces;
}

}  // namespace skycap::flight
