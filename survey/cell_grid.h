/// Points by cubic cell of an unbounded grid, for neighbour queries over a growing set.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace skycap::survey {

/// A cell's coordinates packed into one number, distinct for all cells within a million cells of
/// the origin.
inline std::uint64_t cell_key(const Eigen::Vector3i& cell) {
  constexpr std::uint64_t mask = (1U << 21) - 1U;
  return (static_cast<std::uint64_t>(cell.x()) & mask) |
         (static_cast<std::uint64_t>(cell.y()) & mask) << 21 |
         (static_cast<std::uint64_t>(cell.z()) & mask) << 42;
}

inline Eigen::Vector3i cell_of(const Eigen::Vector3f& point, float cell_size) {
  return (point / cell_size).array().floor().cast<int>();
}

/// Indices 0, 1, 2 ... of points by cell. Open addressing on the cell, chained within it.
class CellGrid {
 public:
  explicit CellGrid(float cell_size) : cell_size_(cell_size), slots_(1024) {}

  /// Adds the next index.
  void insert(const Eigen::Vector3f& point) {
    if (2 * (used_ + 1) > slots_.size()) grow();
    Slot& slot = find(cell_key(cell_of(point, cell_size_)), slots_);
    if (slot.head == none) ++used_;
    next_.push_back(slot.head);
    slot.head = static_cast<std::uint32_t>(next_.size() - 1);
  }

  /// Calls `visit(index)` for all points in the cells that the ball meets: the caller tests the
  /// distance. The order depends only on the insertions.
  template <typename Visit>
  void for_each_near(const Eigen::Vector3f& centre, float radius, Visit visit) const {
    const Eigen::Vector3i low = cell_of(centre.array() - radius, cell_size_);
    const Eigen::Vector3i high = cell_of(centre.array() + radius, cell_size_);
    for (int z = low.z(); z <= high.z(); ++z) {
      for (int y = low.y(); y <= high.y(); ++y) {
        for (int x = low.x(); x <= high.x(); ++x) {
          for (std::uint32_t i = head({x, y, z}); i != none; i = next_[i]) visit(i);
        }
      }
    }
  }

 private:
  static constexpr std::uint32_t none = 0xFFFFFFFFU;
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t head = none;
  };

  static std::size_t home(std::uint64_t key, std::size_t size) {
    return static_cast<std::size_t>((key * 0x9E3779B97F4A7C15ULL) >> 20) & (size - 1);
  }
  /// The cell's slot, or the empty one where it belongs, claimed for it.
  static Slot& find(std::uint64_t key, std::vector<Slot>& slots) {
    std::size_t i = home(key, slots.size());
    while (slots[i].head != none && slots[i].key != key) i = (i + 1) & (slots.size() - 1);
    slots[i].key = key;
    return slots[i];
  }
  std::uint32_t head(const Eigen::Vector3i& cell) const {
    const std::uint64_t key = cell_key(cell);
    std::size_t i = home(key, slots_.size());
    while (slots_[i].head != none && slots_[i].key != key) i = (i + 1) & (slots_.size() - 1);
    return slots_[i].head;
  }
  void grow() {
    std::vector<Slot> larger(2 * slots_.size());
    for (const Slot& slot : slots_) {
      if (slot.head != none) find(slot.key, larger).head = slot.head;
    }
    slots_ = std::move(larger);
  }

  float cell_size_;
  std::size_t used_ = 0;
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> next_;
};

}  // namespace skycap::survey
