/// How a tree of boxes lies in memory, for those who build it and those who walk down it.
#pragma once

#include <cstdint>

namespace skycap::sim {

/// A node or a leaf. The lowest four bits of its address, all multiples of 16, count a leaf's
/// entries; a node has none.
using TreeRef = std::uintptr_t;
inline constexpr TreeRef tree_ref_entries = 15;
/// Of nodes from the root to any leaf there are at most so many.
inline constexpr unsigned max_tree_depth = 40;

/// Boxes around the triangles below up to eight children. Children that are missing have boxes that
/// no ray enters.
struct alignas(64) TreeNode {
  static constexpr int arity = 8;
  float planes[3][2 * arity];  ///< for each axis the lower bounds, then the upper ones negated
  TreeRef children[arity];
};

/// An entry of a leaf over triangles.
struct LeafTriangle {
  float corners[3][3];
  std::uint32_t number;
};

/// All of a tree that rays need.
struct TreeRoot {
  TreeRef ref = 0;
  float extent = 0.0F;  ///< the greatest magnitude of a coordinate of its boxes
};

}  // namespace skycap::sim
