/// Joint traversal of a triangle tree by many packets of near-parallel rays, such as those of an
/// image tile. For sources that are compiled for one instruction set each.
///
/// All packets descend together, with common bounds, to the nearest boxes that they may enter, most
/// of which are leaves. Each packet then starts there, nearest box first, instead of at the root.
/// If there are too many boxes, because triangles are small compared with the tile, every packet
/// traverses the tree alone. The choice affects only the computing time.
#pragma once

#include <cstdint>

#include "sim/scene/lanes_body.h"
#include "sim/scene/ray_kernels.h"
#include "sim/scene/tree_layout.h"
#include "sim/scene/tree_walk_body.h"
#include "sim/scene/triangle_test_body.h"

namespace skycap::sim {
namespace {

// Boxes at which packets start, nearest first.
class Entries {
 public:
  struct Entry {
    const TreeNode* node;
    int child;
    float near;  // Lower bound on the distance at which rays enter the box.

    TreeRef ref() const { return node->children[child]; }
    bool is_leaf() const { return (ref() & tree_ref_entries) != 0; }
    const TreeNode& node_below() const { return *reinterpret_cast<const TreeNode*>(ref()); }
  };

  const Entry* begin() const { return entries_; }
  const Entry* end() const { return entries_ + count_; }

  // Adds the children of a node that rays within the bounds enter within `reach`. Returns false and
  // changes nothing if the capacity is insufficient.
  bool add_below(const TreeNode& node, const BundleBounds& bounds, float reach) {
    alignas(64) float near[TreeNode::arity];
    std::uint32_t children = entered(box_distances<false>(node, bounds), reach, near);
    if (count_ + __builtin_popcount(children) > limit) return false;
    for (; children != 0; children &= children - 1) {
      const int child = __builtin_ctz(children);
      int index = count_++;
      for (; index > 0 && entries_[index - 1].near > near[child]; --index) {
        entries_[index] = entries_[index - 1];
      }
      entries_[index] = {&node, child, near[child]};
    }
    return true;
  }

  // Replaces nodes that rays enter within `expected` by their children, while the capacity permits.
  void open_nearest(const BundleBounds& bounds, float reach, float expected) {
    for (int i = 0; i < count_ && entries_[i].near <= expected;) {
      const Entry opened = entries_[i];
      if (opened.is_leaf() || !add_below(opened.node_below(), bounds, reach)) {
        ++i;
        continue;
      }
      // The children were inserted behind the node.
      --count_;
      for (int later = i; later < count_; ++later) entries_[later] = entries_[later + 1];
    }
  }

 private:
  static constexpr int limit = 32;
  Entry entries_[limit];
  int count_ = 0;
};

// Computes the bounds of all rays. Returns false if the signs of their directions differ.
inline bool bound(const RayPacket* packets, int count, float extent, BundleBounds& bounds) {
  struct Bounds {
    float min, max;
  } origins[3], inverses[3];
  bool is_backwards[3];
  for (int axis = 0; axis < 3; ++axis) {
    Floats min_origin = load(packets[0].origin[axis]), max_origin = min_origin;
    Floats min_direction = load(packets[0].direction[axis]);
    Floats max_direction = min_direction;
    for (int i = 1; i < count; ++i) {
      const Floats origin = load(packets[i].origin[axis]);
      const Floats direction = load(packets[i].direction[axis]);
      min_origin = min(min_origin, origin);
      max_origin = max(max_origin, origin);
      min_direction = min(min_direction, direction);
      max_direction = max(max_direction, direction);
    }
    origins[axis] = {horizontal_min(min_origin), horizontal_max(max_origin)};
    const float from = horizontal_min(min_direction), to = horizontal_max(max_direction);
    is_backwards[axis] = from < 0.0F;
    if (is_backwards[axis] && to >= 0.0F) return false;
    // Division is monotone, so the bounds of the inverses are the inverses of the bounds.
    const float one = inverse_magnitude(from), other = inverse_magnitude(to);
    inverses[axis] = {min(one, other), max(one, other)};
  }
  bounds = make_bounds(origins, inverses, is_backwards, extent, triangle_padding);
  return true;
}

template <HitQuery query>
void store_nearest(const Nearest<Floats>& nearest, RayPacket& packet) {
  store(chosen(nearest.is_hit, nearest.distance, every<Floats>(-1.0F)), packet.distance);
  if constexpr (query == HitQuery::surface) {
    store(nearest.triangle, reinterpret_cast<float*>(packet.triangle));
    for (int axis = 0; axis < 3; ++axis) store(nearest.normal[axis], packet.normal[axis]);
  }
}

inline Rays<Floats> make_rays(const RayPacket& packet) {
  Rays<Floats> rays;
  for (int axis = 0; axis < 3; ++axis) {
    rays.origin[axis] = load(packet.origin[axis]);
    rays.direction[axis] = load(packet.direction[axis]);
  }
  return rays;
}

inline Nearest<Floats> nothing_within(float reach) {
  const Floats zero = every<Floats>(0.0F);
  return {every<Floats>(reach), is_less(zero, zero), zero, {zero, zero, zero}};
}

// Casts a packet from the given entries. Returns the distance of its farthest hit.
template <HitQuery query>
[[gnu::noinline]] float cast_from(const Entries& entries, const TreeRoot& tree,
                                  const BundleBounds& bounds, RayPacket& packet, float reach) {
  const Rays<Floats> rays = make_rays(packet);
  const Bundle<Floats> bundle = make_bundle(rays, make_mask(RayPacket::all_lanes), bounds);
  const TriangleTest<Floats, query> test(rays, bundle.active, tree.extent, nullptr);
  Nearest<Floats> nearest = nothing_within(reach);
  Walk<Floats> walk(bundle, nearest);
  float limit = reach;
  for (const Entries::Entry& entry : entries) {
    if (entry.near > limit) break;
    if (!walk.is_entered(*entry.node, entry.child)) continue;
    if (!entry.is_leaf()) {
      walk(entry.ref(), test);
    } else if (!test(entry.ref(), bundle.active, nearest)) {
      continue;
    }
    limit = walk.farthest();
  }
  store_nearest<query>(nearest, packet);
  return limit;
}

// Casts all packets together. Returns false and changes nothing if they must be cast one by one.
template <HitQuery query>
bool cast_together(const TreeRoot& tree, RayPacket* packets, int count, float reach) {
  BundleBounds bounds;
  if (!bound(packets, count, tree.extent, bounds)) return false;
  Entries entries;
  entries.add_below(*reinterpret_cast<const TreeNode*>(tree.ref), bounds, reach);
  // Objects behind the hits of the first packet are usually hidden from the others, too.
  const float expected = cast_from<query>(entries, tree, bounds, packets[0], reach);
  entries.open_nearest(bounds, reach, expected);
  for (int i = 1; i < count; ++i) cast_from<query>(entries, tree, bounds, packets[i], reach);
  return true;
}

}  // namespace
}  // namespace skycap::sim
