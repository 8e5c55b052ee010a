/// Binary tree of bounding boxes, searched for items within a distance of a segment. For points and
/// triangles alone, MeshDistance (geometry/surfaces) is faster: it tests four boxes of floats at a
/// time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/clearance/segment_distance.h"

namespace skycap::flight {

/// Immutable and thread-safe. Deterministic: equal boxes give equal trees.
class BoundingTree {
 public:
  struct Node {
    Eigen::AlignedBox3d box;
    /// Inner node: index of the right child. Leaf: slot of the first item.
    std::uint32_t first = 0;
    /// Number of items of a leaf. 0 for an inner node, whose left child is the next node.
    std::uint32_t count = 0;
  };

  BoundingTree() = default;
  explicit BoundingTree(std::span<const Eigen::AlignedBox3d> boxes);

  bool empty() const { return nodes_.empty(); }
  const std::vector<Node>& nodes() const { return nodes_; }

  /// Returns the item indices, ordered by leaf slot.
  const std::vector<std::uint32_t>& items() const { return items_; }

  /// Calls `visit(item)` for every item whose box may be within `reach` [m] of the segment, near
  /// items first. `visit` may reduce `reach` when it finds a closer item. A negative reach ends the
  /// search.
  template <typename Visit>
  void visit_near(const Segment& segment, double& reach, Visit&& visit) const;

 private:
  std::uint32_t build(std::span<const Eigen::AlignedBox3d> boxes, std::uint32_t begin,
                      std::uint32_t end);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

/// Segment prepared for repeated box tests.
class BoxTest {
 public:
  explicit BoxTest(const Segment& segment);

  /// Returns true if the segment intersects the box grown by `reach` on every side. That includes
  /// every box closer than `reach`. False positives occur only near the corners of the grown box.
  bool is_near(const Eigen::AlignedBox3d& box, double reach) const {
    const Eigen::Array3d grown_min = box.min().array() - reach - from_;
    const Eigen::Array3d grown_max = box.max().array() + reach - from_;
    const Eigen::Array3d one = grown_min * inverse_, two = grown_max * inverse_;
    return one.min(two).maxCoeff() <= 1.0 && one.max(two).minCoeff() >= 0.0 &&
           one.min(two).maxCoeff() <= one.max(two).minCoeff();
  }

  /// Returns a lower bound on the squared distance between segment and box [m^2]. It uses the
  /// projections onto the three axes and the bounding sphere of the box.
  double squared_bound(const Eigen::AlignedBox3d& box) const;

 private:
  Segment segment_;
  Eigen::Array3d from_, inverse_;
  double inverse_squared_length_;
};

template <typename Visit>
void BoundingTree::visit_near(const Segment& segment, double& reach, Visit&& visit) const {
  if (nodes_.empty()) return;
  const BoxTest test(segment);
  struct Entry {
    std::uint32_t node;
    double squared_bound;
  };
  // Median splits keep the depth below 2 + log2(items), so 64 levels suffice for any index type.
  std::array<Entry, 64> stack;
  std::size_t size = 0;
  stack[size++] = {0, 0.0};
  while (size > 0) {
    const Entry entry = stack[--size];
    if (entry.squared_bound >= reach * reach) continue;
    const Node& node = nodes_[entry.node];
    if (!test.is_near(node.box, reach)) continue;
    if (node.count > 0) {
      for (std::uint32_t slot = node.first; slot < node.first + node.count; ++slot) {
        visit(items_[slot]);
        if (reach < 0.0) return;
      }
      continue;
    }
    Entry near{entry.node + 1, test.squared_bound(nodes_[entry.node + 1].box)};
    Entry far{node.first, test.squared_bound(nodes_[node.first].box)};
    if (far.squared_bound < near.squared_bound) std::swap(near, far);
    stack[size++] = far;
    stack[size++] = near;
  }
}

}  // namespace skycap::flight
