/// How a tree of triangles lies in memory: plain numbers, which the kernels of every instruction
/// set read alike.
#pragma once

#include <cstddef>
#include <cstdint>

namespace skycap::geometry {

/// A triangle, ready to be projected onto.
struct Facet {
  double corner[3], to_second[3], to_third[3];
  std::uint32_t index;  ///< in the mesh
  bool is_sliver;       ///< too thin for its plane to be known
};

/// Up to four children and their boxes, side by side so that one instruction asks all four. A child
/// that is not there has a box that is infinitely far away.
struct alignas(64) FacetNode {
  static constexpr int lanes = 4;
  static constexpr std::uint32_t is_facet = 1U << 31;  ///< of a child: a facet's slot, not a node

  float low[3][lanes], high[3][lanes];
  std::uint32_t child[lanes];
};

/// Children that wait in a search: 12 levels of cuts and 16 of quarters hold any mesh, and each
/// leaves three behind.
inline constexpr std::size_t most_waiting = 96;

}  // namespace skycap::geometry
