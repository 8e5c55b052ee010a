/// Grid cells and their keys in a geometry::HashGrid.
#pragma once

#include <cstdint>

#include <Eigen/Core>

namespace skycap::flight {

using Cell = Eigen::Vector3i;

/// Returns the key of a cell whose coordinates are in [-2^20, 2^20).
inline std::uint64_t cell_key(const Cell& cell) {
  const auto part = [](int c) { return static_cast<std::uint64_t>(c + (1 << 20)) & 0x1fffff; };
  return part(cell.x()) | part(cell.y()) << 21 | part(cell.z()) << 42;
}

/// Returns the cell of a key.
inline Cell unpack_cell(std::uint64_t key) {
  const auto part = [](std::uint64_t bits) {
    return static_cast<int>(bits & 0x1fffff) - (1 << 20);
  };
  return {part(key), part(key >> 21), part(key >> 42)};
}

}  // namespace skycap::flight
