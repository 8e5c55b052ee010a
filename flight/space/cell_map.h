/// A map from grid cells to numbers: open addressing, for the inner loops of the path search.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace skycap::flight {

using Cell = Eigen::Vector3i;

/// Each coordinate in [-2^20, 2^20).
inline std::uint64_t cell_key(const Cell& cell) {
  const auto part = [](int c) { return static_cast<std::uint64_t>(c + (1 << 20)) & 0x1fffff; };
  return part(cell.x()) | part(cell.y()) << 21 | part(cell.z()) << 42;
}

/// The cell of a key.
inline Cell cell_of(std::uint64_t key) {
  const auto part = [](std::uint64_t bits) {
    return static_cast<int>(bits & 0x1fffff) - (1 << 20);
  };
  return {part(key), part(key >> 21), part(key >> 42)};
}

/// Fibonacci hashing; the upper half of the product, which depends on all of the key, comes down.
inline std::size_t hash_of(std::uint64_t cell_key) {
  const std::uint64_t product = cell_key * 0x9e3779b97f4a7c15ULL;
  return product ^ product >> 32;
}

template <typename Value>
class CellMap {
 public:
  CellMap() { clear(); }

  void clear() {
    slots_.assign(1024, Slot{});
    size_ = 0;
  }

  /// The cell's value; `fresh` if it had none. The reference holds until the next call.
  Value& at(const Cell& cell, const Value& fresh) {
    if (4 * (size_ + 1) > 3 * slots_.size()) grow();
    Slot& slot = find(slots_, cell_key(cell));
    if (slot.key == no_key) {
      slot = {cell_key(cell), fresh};
      ++size_;
    }
    return slot.value;
  }

 private:
  static constexpr std::uint64_t no_key = ~std::uint64_t{0};
  struct Slot {
    std::uint64_t key = no_key;
    Value value{};
  };

  static Slot& find(std::vector<Slot>& slots, std::uint64_t key) {
    const std::size_t mask = slots.size() - 1;
    std::size_t i = hash_of(key) & mask;
    while (slots[i].key != no_key && slots[i].key != key) i = (i + 1) & mask;
    return slots[i];
  }

  void grow() {
    std::vector<Slot> larger(2 * slots_.size());
    for (const Slot& slot : slots_) {
      if (slot.key != no_key) find(larger, slot.key) = slot;
    }
    slots_.swap(larger);
  }

  std::vector<Slot> slots_;
  std::size_t size_ = 0;
};

}  // namespace skycap::flight
