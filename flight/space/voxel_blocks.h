/// The voxel blocks of a space by their cells: open addressing, for queries that look at hundreds
/// of blocks each, most of which are free as a whole.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flight/space/voxel_block.h"

namespace skycap::flight {

class VoxelBlocks {
 public:
  struct Found {
    const VoxelBlock* block = nullptr;  ///< null: there is none
    bool is_all_passable = false;
  };

  VoxelBlocks() : slots_(first_slots) {}

  std::size_t size() const { return blocks_.size(); }

  /// In the order in which they came.
  std::span<const std::uint64_t> keys() const { return keys_; }
  std::span<const VoxelBlock> blocks() const { return blocks_; }

  /// The block of a cell_key(). The pointer holds until the next set().
  Found find(std::uint64_t key) const {
    const Slot& slot = slots_[slot_of(key)];
    if (slot.key != key) return {};
    return {&blocks_[slot.index], slot.is_all_passable};
  }

  /// Puts a block there, new or in place of the one before; returns whether it is new.
  bool set(std::uint64_t key, const VoxelBlock& block) {
    if (4 * (blocks_.size() + 1) > 3 * slots_.size()) grow();
    Slot& slot = slots_[slot_of(key)];
    const bool is_new = slot.key != key;
    if (is_new) {
      slot = {key, static_cast<std::uint32_t>(blocks_.size())};
      keys_.push_back(key);
      blocks_.push_back(block);
    } else {
      blocks_[slot.index] = block;
    }
    slot.is_all_passable = block.is_all_passable();
    return is_new;
  }

 private:
  static constexpr std::size_t first_slots = 1024;  // a power of two
  static constexpr std::uint64_t no_key = ~std::uint64_t{0};
  struct Slot {
    std::uint64_t key = no_key;
    std::uint32_t index = 0;
    bool is_all_passable = false;
  };

  /// The slot of a key, or the free one where it would be.
  std::size_t slot_of(std::uint64_t key) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = hash_of(key) & mask;
    while (slots_[i].key != no_key && slots_[i].key != key) i = (i + 1) & mask;
    return i;
  }

  void grow() {
    slots_.assign(2 * slots_.size(), Slot{});
    for (std::uint32_t i = 0; i < blocks_.size(); ++i) {
      slots_[slot_of(keys_[i])] = {keys_[i], i, blocks_[i].is_all_passable()};
    }
  }

  std::vector<Slot> slots_;
  std::vector<std::uint64_t> keys_;
  std::vector<VoxelBlock> blocks_;
};

}  // namespace skycap::flight
