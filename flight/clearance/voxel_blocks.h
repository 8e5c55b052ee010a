/// Voxel blocks by cell, optimised for queries over hundreds of blocks, most of them entirely free.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flight/clearance/voxel_block.h"
#include "geometry/points/hash_grid.h"

namespace skycap::flight {

class VoxelBlocks {
 public:
  struct Found {
    const VoxelBlock* block = nullptr;  ///< Null: the cell has no block.
    bool is_all_passable = false;
  };

  std::size_t size() const { return blocks_.size(); }

  /// Returns the keys or blocks in insertion order.
  std::span<const std::uint64_t> keys() const { return keys_; }
  std::span<const VoxelBlock> blocks() const { return blocks_; }

  /// Returns the block of a cell_key(). The pointer is valid until the next set().
  Found find(std::uint64_t key) const {
    const BlockSlot* const slot = slots_.find(key);
    if (slot == nullptr) return {};
    return {&blocks_[slot->index], slot->is_all_passable};
  }

  /// Inserts or replaces a block. Returns true if it is new.
  bool set(std::uint64_t key, const VoxelBlock& block) {
    const auto [slot, is_new] = slots_.insert(key, {static_cast<std::uint32_t>(blocks_.size())});
    if (is_new) {
      keys_.push_back(key);
      blocks_.push_back(block);
    } else {
      blocks_[slot.index] = block;
    }
    slot.is_all_passable = block.is_all_passable();
    return is_new;
  }

 private:
  struct BlockSlot {
    std::uint32_t index = 0;
    bool is_all_passable = false;
  };

  geometry::HashGrid<BlockSlot> slots_;
  std::vector<std::uint64_t> keys_;
  std::vector<VoxelBlock> blocks_;
};

}  // namespace skycap::flight
