/// Block of 512 voxels with two bits per voxel: free and occupied.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "flight/clearance/cell_map.h"

namespace skycap::flight {

/// Cube of voxels within a block.
struct Cube {
  Cell low;  ///< First voxel.
  int edge;  ///< Edge length in voxels: 8, 4, 2 or 1.

  /// Returns the bits of the cube within a slice.
  std::uint64_t mask() const {
    std::uint64_t bits = 0;
    for (int y = low.y(); y < low.y() + edge; ++y) {
      bits |= ((std::uint64_t{1} << edge) - 1) << (8 * y + low.x());
    }
    return bits;
  }
};

/// 8 x 8 x 8 bits. Voxel (x, y, z) is bit x of byte y of word z.
using Slices = std::array<std::uint64_t, 8>;

struct VoxelBlock {
  Slices free{};
  Slices occupied{};

  std::uint64_t passable(int z) const { return free[z] & ~occupied[z]; }
  bool is_all_passable() const {
    for (int z = 0; z < 8; ++z) {
      if (passable(z) != ~std::uint64_t{0}) return false;
    }
    return true;
  }
  bool is_all_free(const Cube& cube) const {
    const std::uint64_t mask = cube.mask();
    for (int z = cube.low.z(); z < cube.low.z() + cube.edge; ++z) {
      if ((free[z] & mask) != mask) return false;
    }
    return true;
  }
  bool is_any_occupied() const {
    return std::ranges::any_of(occupied, [](std::uint64_t slice) { return slice != 0; });
  }
  void set_free(const Cube& cube) {
    for (int z = cube.low.z(); z < cube.low.z() + cube.edge; ++z) free[z] |= cube.mask();
  }
  bool is_occupied(const Cell& voxel) const {
    return (occupied[voxel.z()] >> (8 * voxel.y() + voxel.x()) & 1) != 0;
  }
};

}  // namespace skycap::flight
