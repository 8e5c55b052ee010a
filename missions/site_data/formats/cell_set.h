/// Which cells of a cubic grid were met already: what thins clouds while they are read.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <Eigen/Core>

#include "geometry/points/hash_grid.h"

namespace skycap::missions::site_data {

/// A set of whole cells.
class CellSet {
 public:
  /// Whether the cell of a place, in cells from anywhere, is new. Cells repeat after two million
  /// in each direction: clouds are narrower.
  bool add(const Eigen::Vector3d& place) {
    std::uint64_t key = 0;
    for (const double coordinate : place) {
      const double cell = std::floor(std::clamp(coordinate, -9e18, 9e18));
      key = key << 21U | (static_cast<std::uint64_t>(static_cast<std::int64_t>(cell)) & 0x1FFFFFU);
    }
    return cells_.insert(key).is_new;
  }

 private:
  struct Nothing {};
  geometry::HashGrid<Nothing> cells_{1 << 15};
};

}  // namespace skycap::missions::site_data
