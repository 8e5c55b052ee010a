/// The voxel blocks of a space by their cells, for queries that look at hundreds of blocks each,
/// most of which are free as a whole.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "flight/space/voxel_block.h"
#include "geometry/points/hash_grid.h"

namespace skycap::flight {

class VoxelBlocks {
 public:
  struct Found {
    const VoxelBlock* block = nullptr;  ///< null: there is none
    bool is_all_passable = false;
  };

  std::size_t size() const { return blocks_.size(); }

  /// In the order in which they came.
  std::span<const std::uint64_t> keys() const { return keys_; }
  std::span<const VoxelBlock> blocks() const { return blocks_; }

  /// The block of a cell_key(). The pointer holds until the next set().
  Found find(std::uint64_t key) const {
    const Place* const place = places_.find(key);
    if (place == nullptr) return {};
    return {&blocks_[place->index], place->is_all_passable};
  }

  /// Puts a block there, new or in place of the one before; returns whether it is new.
  bool set(std::uint64_t key, const VoxelBlock& block) {
    const auto [place, is_new] = places_.insert(key, {static_cast<std::uint32_t>(blocks_.size())});
    if (is_new) {
      keys_.push_back(key);
      blocks_.push_back(block);
    } else {
      blocks_[place.index] = block;
    }
    place.is_all_passable = block.is_all_passable();
    return is_new;
  }

 private:
  struct Place {
    std::uint32_t index = 0;
    bool is_all_passable = false;
  };

  geometry::HashGrid<Place> places_;
  std::vector<std::uint64_t> keys_;
  std::vector<VoxelBlock> blocks_;
};

}  // namespace skycap::flight
