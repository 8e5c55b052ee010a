/// Memory layout of the bounding volume hierarchy, shared by builder and traversal.
#pragma once

#include <cstdint>

namespace skycap::sim {

/// Reference to a node or a leaf. Addresses are multiples of 16; the lowest four bits hold the
/// number of leaf entries, 0 for a node.
using TreeRef = std::uintptr_t;
inline constexpr TreeRef tree_ref_entries = 15;
/// Maximum number of nodes from the root to a leaf.
inline constexpr unsigned max_tree_depth = 40;

/// Boxes around the triangles below up to eight children. Missing children have boxes that no ray
/// enters.
struct alignas(64) TreeNode {
  static constexpr int arity = 8;
  float planes[3][2 * arity];  ///< Lower bounds per axis, followed by the negated upper bounds.
  TreeRef children[arity];
};

/// Entry of a triangle leaf.
struct LeafTriangle {
  float corners[3][3];
  std::uint32_t number;
};

/// Complete tree as seen by rays.
struct TreeRoot {
  TreeRef ref = 0;
  float extent = 0.0F;  ///< Maximum magnitude of the box coordinates.
};

}  // namespace skycap::sim
