/// Traversal of a tree by rays. For sources that are compiled for one instruction set each.
///
/// A packet traverses the tree as a unit. The boxes of a node's eight children are first tested
/// with the bounds of all rays, and the remaining ones with every ray. Boxes are padded so that no
/// ray misses a triangle that it hits. A box is skipped only if every ray has a nearer hit.
///
/// An axis along which the rays run in negative direction is mirrored. The negated upper bound of a
/// box then replaces the lower one.
#pragma once

#include <cstdint>

#include "sim/scene/lanes_body.h"
#include "sim/scene/tree_layout.h"
#include "sim/scene/triangle_test_body.h"

namespace skycap::sim {
namespace {

// Padding of boxes in trees of triangles and of copies, relative to the largest coordinate; see
// TriangleTest::min_area(). The box of a copy must also cover the padding of its own tree and the
// transformation to its frame.
constexpr float triangle_padding = 0x1p-16F, copy_padding = 0x1p-13F;

// Bounds of all rays of a bundle for testing whole nodes, with near bounds before far bounds. They
// hold the maximum origins, mirrored and padded, and the range of the inverse directions.
struct BundleBounds {
  int nearer[3];  // Offset of the near bounds within a node's planes.
  float padding;
  Floats origin[3], min_inverse[3], max_inverse[3];
};

// Rays with directions of equal signs, prepared for box tests.
template <typename Lanes>
struct Bundle {
  LaneMask<Lanes> active;
  Lanes origin_for_near[3];  // Mirrored and padded.
  Lanes origin_for_far[3];   // Mirrored, padded and negated.
  Lanes inverse[3];          // Inverse magnitude of the direction.
  BundleBounds bounds;
};

template <typename Lanes>
struct Interval {
  float min, max;
  Interval(const Lanes& values, const LaneMask<Lanes>& active)
      : min(horizontal_min(chosen(active, values, every<Lanes>(infinity)))),
        max(horizontal_max(chosen(active, values, every<Lanes>(-infinity)))) {}
};

template <typename Lanes>
inline Lanes inverse_magnitude(const Lanes& direction) {
  constexpr float min_direction = 1e-18F;  // Keeps the inverse and its products finite.
  return every<Lanes>(1.0F) / max(magnitude(direction), every<Lanes>(min_direction));
}

// Computes the bounds for rays whose origins and inverse directions lie in the given intervals.
template <typename Interval>
[[gnu::always_inline]] inline BundleBounds make_bounds(const Interval (&origins)[3],
                                                       const Interval (&inverses)[3],
                                                       const bool (&is_backwards)[3], float extent,
                                                       float padding_share) {
  float farthest = 0.0F;
  for (const Interval& origin : origins) {
    farthest = max(farthest, max(origin.max, -origin.min));
  }
  BundleBounds bounds;
  bounds.padding = padding_share * (farthest + extent);
  for (int axis = 0; axis < 3; ++axis) {
    const bool mirrored = is_backwards[axis];
    bounds.nearer[axis] = mirrored ? TreeNode::arity : 0;
    bounds.min_inverse[axis] = every<Floats>(inverses[axis].min);
    bounds.max_inverse[axis] = every<Floats>(inverses[axis].max);
    const float min_origin = mirrored ? -origins[axis].max : origins[axis].min;
    const float max_origin = mirrored ? -origins[axis].min : origins[axis].max;
    bounds.origin[axis] = chosen(make_mask(0xFF), every<Floats>(max_origin + bounds.padding),
                                 every<Floats>(bounds.padding - min_origin));
  }
  return bounds;
}

// Returns a bundle with the given bounds, which may include further rays.
template <typename Lanes>
[[gnu::always_inline]] inline Bundle<Lanes> make_bundle(const Rays<Lanes>& rays,
                                                        const LaneMask<Lanes>& active,
                                                        const BundleBounds& bounds) {
  Bundle<Lanes> bundle;
  bundle.active = active;
  bundle.bounds = bounds;
  for (int axis = 0; axis < 3; ++axis) {
    const Lanes origin = bounds.nearer[axis] != 0 ? -rays.origin[axis] : rays.origin[axis];
    bundle.origin_for_near[axis] = origin + every<Lanes>(bounds.padding);
    bundle.origin_for_far[axis] = every<Lanes>(bounds.padding) - origin;
    bundle.inverse[axis] = inverse_magnitude(rays.direction[axis]);
  }
  return bundle;
}

template <typename Lanes>
[[gnu::always_inline]] inline Bundle<Lanes> make_bundle(const Rays<Lanes>& rays,
                                                        const LaneMask<Lanes>& active,
                                                        const bool (&is_backwards)[3], float extent,
                                                        float padding_share) {
  using All = Interval<Lanes>;
  const All origins[3] = {
      {rays.origin[0], active}, {rays.origin[1], active}, {rays.origin[2], active}};
  const All inverses[3] = {{inverse_magnitude(rays.direction[0]), active},
                           {inverse_magnitude(rays.direction[1]), active},
                           {inverse_magnitude(rays.direction[2]), active}};
  return make_bundle(rays, active,
                     make_bounds(origins, inverses, is_backwards, extent, padding_share));
}

// Returns the near and far bounds of eight children along an axis. Both are mirrored if necessary;
// the far bounds are negated.
inline Floats near_and_far(const float* planes, int nearer) {
#if defined(__AVX512F__)
  return {{(Part)_mm512_insertf32x8(_mm512_castps256_ps512(_mm256_load_ps(planes + nearer)),
                                    _mm256_load_ps(planes + (nearer ^ TreeNode::arity)), 1)}};
#else
  return each_part<Floats>([&](int i) {
    return *reinterpret_cast<const Part*>(planes + ((nearer + i * part_lanes) & (lane_count - 1)));
  });
#endif
}

// Returns a bit mask of the boxes that rays enter within `max_distance`, and stores the entry
// distances in `near`. The arguments are the entry distances and negated exit distances of eight
// boxes.
inline std::uint32_t entered(const Floats& near_and_far, float max_distance, float (&near)[8]) {
#if defined(__AVX512F__)
  const __m512 both = near_and_far.part[0];
  const __m256 enter = _mm256_max_ps(_mm512_castps512_ps256(both), _mm256_setzero_ps());
  const __m256 leave =
      _mm256_min_ps(-_mm512_extractf32x8_ps(both, 1), _mm256_set1_ps(max_distance));
  _mm256_store_ps(near, enter);
  return _mm256_cmp_ps_mask(enter, leave, _CMP_LE_OQ);
#else
  std::uint32_t boxes = 0;
#pragma GCC unroll 2
  for (int i = 0; i < part_count / 2; ++i) {
    const Part enter = max(near_and_far.part[i], every_lane(0.0F));
    const Part leave = min(-near_and_far.part[i + part_count / 2], every_lane(max_distance));
    reinterpret_cast<Part*>(near)[i] = enter;
    boxes |= bits(is_at_most(enter, leave)) << (i * part_lanes);
  }
  return boxes;
#endif
}

// Returns lower bounds on the entry distances of a node's children, and negated upper bounds on
// their exit distances, for all rays.
template <bool is_one_ray>
[[gnu::always_inline]] inline Floats box_distances(const TreeNode& node,
                                                   const BundleBounds& bounds) {
  Floats all;
#pragma GCC unroll 3
  for (int axis = 0; axis < 3; ++axis) {
    const Floats plane_distances =
        near_and_far(node.planes[axis], bounds.nearer[axis]) - bounds.origin[axis];
    Floats distance = plane_distances * bounds.min_inverse[axis];
    if constexpr (!is_one_ray) distance = min(distance, plane_distances * bounds.max_inverse[axis]);
    all = axis == 0 ? distance : max(all, distance);
  }
  return all;
}

inline void prefetch(TreeRef ref) {
  const auto* const memory = reinterpret_cast<const char*>(ref & ~tree_ref_entries);
  for (int line = 0; line < 256; line += 64) __builtin_prefetch(memory + line);
}

// Stack of nodes to visit. The nearest child of the latest node is on top.
struct ToVisit {
  struct PendingNode {
    TreeRef ref;
    float near;
  };
  PendingNode stack[TreeNode::arity * max_tree_depth];
  PendingNode* end = stack;

  void push(TreeRef ref, float near) { *end++ = {ref, near}; }
  // Inserts an entry behind those from `first` on that are farther.
  void insert(const PendingNode* first, TreeRef ref, float near) {
    PendingNode* node = end++;
    for (; node != first && node[-1].near < near; --node) *node = node[-1];
    *node = {ref, near};
  }
  // Returns the next entry, or 0 if all remaining ones are beyond `max_distance`.
  TreeRef pop(float max_distance) {
    while (end != stack) {
      --end;
      if (end->near <= max_distance) return end->ref;
    }
    return 0;
  }
};

template <typename Lanes>
class Walk {
 public:
  Walk(const Bundle<Lanes>& bundle, Nearest<Lanes>& nearest) : bundle_(bundle), nearest_(nearest) {}

  // Traverses the tree. `test(leaf, active, nearest)` returns true if it has found a nearer hit.
  template <typename LeafTest>
  [[gnu::always_inline]] void operator()(TreeRef root, const LeafTest& test) {
    float max_distance = farthest();
    for (TreeRef at = root; at != 0;) {
      if ((at & tree_ref_entries) == 0) {
        at = enter(*reinterpret_cast<const TreeNode*>(at), max_distance);
        if (at != 0) continue;
      } else if (test(at, bundle_.active, nearest_)) {
        max_distance = farthest();
      }
      at = to_visit_.pop(max_distance);
    }
  }

  // Returns an upper bound on the distances of the current hits.
  float farthest() const {
    return horizontal_max(chosen(bundle_.active, nearest_.distance, every<Lanes>(-infinity)));
  }

  // Returns true if one of the rays enters the child.
  [[gnu::always_inline]] bool is_entered(const TreeNode& node, int child) const {
    Lanes enter = every<Lanes>(0.0F), leave = -nearest_.distance;  // `leave` is negated.
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      const float* const near = node.planes[axis] + bundle_.bounds.nearer[axis] + child;
      const float* const far =
          node.planes[axis] + (bundle_.bounds.nearer[axis] ^ TreeNode::arity) + child;
      enter =
          max(enter, (every<Lanes>(*near) - bundle_.origin_for_near[axis]) * bundle_.inverse[axis]);
      leave =
          max(leave, (every<Lanes>(*far) - bundle_.origin_for_far[axis]) * bundle_.inverse[axis]);
    }
    return any(is_at_most(enter, -leave) & bundle_.active);
  }

 private:
  // Returns the child to visit next and pushes the other children that rays enter.
  [[gnu::always_inline]] TreeRef enter(const TreeNode& node, float max_distance) {
    alignas(64) float near[TreeNode::arity];
    std::uint32_t children =
        entered(box_distances<__is_same(Lanes, float)>(node, bundle_.bounds), max_distance, near);
    if constexpr (__is_same(Lanes, float)) {
      if (children == 0) return 0;
      const auto* const first = to_visit_.end;
      for (; children != 0; children &= children - 1) {
        const int child = __builtin_ctz(children);
        prefetch(node.children[child]);
        to_visit_.insert(first, node.children[child], near[child]);
      }
      return (--to_visit_.end)->ref;
    }
    TreeRef nearest = 0;
    float nearest_near = 0.0F;
    for (; children != 0; children &= children - 1) {
      const int child = __builtin_ctz(children);
      if (!is_entered(node, child)) continue;
      const TreeRef ref = node.children[child];
      prefetch(ref);
      if (nearest != 0 && near[child] >= nearest_near) {
        to_visit_.push(ref, near[child]);
        continue;
      }
      if (nearest != 0) to_visit_.push(nearest, nearest_near);
      nearest = ref;
      nearest_near = near[child];
    }
    return nearest;
  }

  const Bundle<Lanes>& bundle_;
  Nearest<Lanes>& nearest_;
  ToVisit to_visit_;
};

}  // namespace
}  // namespace skycap::sim
