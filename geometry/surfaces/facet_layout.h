/// Memory layout of a triangle tree. Plain numbers, so that the kernels of all instruction sets can
/// read it.
#pragma once

#include <cstddef>
#include <cstdint>

namespace skycap::geometry {

/// Triangle with its edge vectors, prepared for the projection of points.
struct Facet {
  double corner[3], to_second[3], to_third[3];
  std::uint32_t index;  ///< triangle index in the mesh
  bool is_sliver;       ///< too thin to define a plane
};

/// Up to four children and their bounding boxes in structure-of-arrays layout, so that one
/// instruction tests all four. Missing children have boxes at infinite distance.
struct alignas(64) FacetNode {
  static constexpr int lanes = 4;
  static constexpr std::uint32_t is_facet =
      1U << 31;  ///< flag of a child: the index is a facet, not a node

  float low[3][lanes], high[3][lanes];
  std::uint32_t child[lanes];
};

/// Capacity of the stack of a search. Any mesh has at most 12 levels of binary splits and 16 levels
/// of four-way splits, and each level adds at most three children.
inline constexpr std::size_t max_pending = 96;

}  // namespace skycap::geometry
