/// A binary tree of boxes around items, searched along a segment: it finds, without looking at the
/// rest, the items whose boxes come within a distance of the segment. MeshDistance
/// (geometry/surfaces) answers for points and triangles alone, four boxes of floats at a time.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/space/segment_distance.h"

namespace skycap::flight {

/// Immutable; safe to search from any number of threads. The same boxes give the same tree.
class BoundingTree {
 public:
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first = 0;  ///< of an inner node its right child; of a leaf its first item's slot
    std::uint32_t count = 0;  ///< items of a leaf; zero in an inner node, whose left child is next
  };

  BoundingTree() = default;
  explicit BoundingTree(std::span<const Eigen::AlignedBox3d> boxes);

  bool empty() const { return nodes_.empty(); }
  const std::vector<Node>& nodes() const { return nodes_; }

  /// Item indices in the order that leaves name slots.
  const std::vector<std::uint32_t>& items() const { return items_; }

  /// Calls `visit(item)` for every item whose box may be within `reach` of the segment, near ones
  /// early. `visit` may lower `reach` as it finds nearer things; a negative reach ends the search.
  template <typename Visit>
  void visit_near(const Segment& segment, double& reach, Visit&& visit) const;

 private:
  std::uint32_t build(std::span<const Eigen::AlignedBox3d> boxes, std::uint32_t begin,
                      std::uint32_t end);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> items_;
};

/// A segment prepared for many box tests.
class BoxTest {
 public:
  explicit BoxTest(const Segment& segment);

  /// Whether the segment meets the box grown by `reach` on every side. True wherever the box is
  /// nearer than `reach`; beyond that true at most near the grown box's corners.
  bool is_near(const Eigen::AlignedBox3d& box, double reach) const {
    const Eigen::Array3d grown_min = box.min().array() - reach - from_;
    const Eigen::Array3d grown_max = box.max().array() + reach - from_;
    const Eigen::Array3d one = grown_min * inverse_, two = grown_max * inverse_;
    return one.min(two).maxCoeff() <= 1.0 && one.max(two).minCoeff() >= 0.0 &&
           one.min(two).maxCoeff() <= one.max(two).minCoeff();
  }

  /// A lower bound of the squared distance between the segment and the box: between their shadows
  /// on the three axes, and between the box's bounding ball and the segment.
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
  // Median splits keep the depth below 2 + log2(items): 64 levels are more than any index allows.
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
