/// Which cells of a cubic grid were met already: what thins clouds while they are read.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace skycap::missions::site_data {

/// A set of whole cells: open addressing, linear probing, at most half full.
class CellSet {
 public:
  CellSet() : slots_(1 << 16, empty) {}

  /// Whether the cell of a place, in cells from anywhere, is new. Cells repeat after two million
  /// in each direction: clouds are narrower.
  bool add(const Eigen::Vector3d& place) {
    std::uint64_t key = 0;
    for (const double coordinate : place) {
      const double cell = std::floor(std::clamp(coordinate, -9e18, 9e18));
      key = key << 21U | (static_cast<std::uint64_t>(static_cast<std::int64_t>(cell)) & 0x1FFFFFU);
    }
    if (!insert(key)) return false;
    if (2 * ++used_ > slots_.size()) grow();
    return true;
  }

 private:
  static constexpr std::uint64_t empty = ~std::uint64_t{0};  // no key has its highest bit

  bool insert(std::uint64_t key) {
    std::uint64_t slot = (key * 0x9E3779B97F4A7C15U) >> 20U & (slots_.size() - 1);
    while (slots_[slot] != empty) {
      if (slots_[slot] == key) return false;
      slot = (slot + 1) & (slots_.size() - 1);
    }
    slots_[slot] = key;
    return true;
  }
  void grow() {
    std::vector<std::uint64_t> keys(2 * slots_.size(), empty);
    keys.swap(slots_);
    for (const std::uint64_t key : keys) {
      if (key != empty) insert(key);
    }
  }

  std::vector<std::uint64_t> slots_;
  std::size_t used_ = 0;
};

}  // namespace skycap::missions::site_data
