/// Set of occupied cells of a cubic grid, for downsampling clouds while reading.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <Eigen/Core>

#include "geometry/points/hash_grid.h"

namespace skycap::missions::site_data {

/// Set of integer cells.
class CellSet {
 public:
  /// Adds the cell that contains `position`, in units of cells. Returns true if the cell is new.
  /// Cell indices wrap around after two million cells in each direction, which exceeds the extent
  /// of clouds.
  bool add(const Eigen::Vector3d& position) {
    std::uint64_t key = 0;
    for (const double coordinate : position) {
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
