/// Implementation of distance_kernels.h, included by one source per instruction set. All functions
/// have internal linkage. No function of the standard library or Eigen is called, because the
/// linker could share it with sources for older processors.
///
/// A packet of points traverses the tree together. Pruning uses conservative single-precision
/// bounds. The distances equal those of on_plane() in facet_tree.cpp bit for bit, because the
/// operations are the same.
#include <cstdint>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "geometry/surfaces/distance_kernels.h"

namespace skycap::geometry {
namespace {

constexpr int packet_size = DistanceKernels::packet;
#if defined(__AVX512F__)
constexpr int register_bytes = 64;
#elif defined(__AVX2__)
constexpr int register_bytes = 32;
#else
constexpr int register_bytes = 16;
#endif
constexpr int float_lanes = register_bytes / 4, float_parts = packet_size / float_lanes;
constexpr int double_lanes = register_bytes / 8, double_parts = packet_size / double_lanes;

using Floats [[gnu::vector_size(register_bytes), gnu::may_alias]] = float;
using Doubles [[gnu::vector_size(register_bytes), gnu::may_alias]] = double;
using FloatMask = decltype(Floats{} < Floats{});
using DoubleMask = decltype(Doubles{} < Doubles{});

// Returns one bit per lane, set where the comparison is true.
inline std::uint32_t bits(FloatMask mask) {
#if defined(__AVX512F__)
  return _mm512_movepi32_mask((__m512i)mask);
#elif defined(__AVX2__)
  return static_cast<std::uint32_t>(_mm256_movemask_ps((__m256)mask));
#elif defined(__SSE2__)
  return static_cast<std::uint32_t>(_mm_movemask_ps((__m128)mask));
#else
  std::uint32_t all = 0;
  for (int lane = 0; lane < float_lanes; ++lane) all |= mask[lane] ? 1U << lane : 0U;
  return all;
#endif
}
inline bool any(DoubleMask mask) {
#if defined(__AVX512F__)
  return _mm512_movepi64_mask((__m512i)mask) != 0;
#elif defined(__AVX2__)
  return _mm256_movemask_pd((__m256d)mask) != 0;
#elif defined(__SSE2__)
  return _mm_movemask_pd((__m128d)mask) != 0;
#else
  for (int lane = 0; lane < double_lanes; ++lane) {
    if (mask[lane]) return true;
  }
  return false;
#endif
}

constexpr float unit = 1.1920929e-7F;  // single-precision machine epsilon
constexpr float sum_rounding = 1.0F - 4.0F * unit;
constexpr float infinity = __builtin_inff();

// Packet of points with their current nearest distances.
struct Packet {
  // Single-precision points, rounding errors of their distance from a box side, and their bounding
  // box.
  Floats at[3][float_parts], slack[3][float_parts];
  float low[3], high[3];
  Doubles exactly[3][double_parts];
  Doubles squared[double_parts];  // squared distances from the nearest facet so far
  Floats bound[float_parts];      // upper bounds of `squared` in single precision
  float farthest;                 // maximum of `bound`
  std::uint32_t nearest;  // facet found nearest most recently; first candidate of the next packet
};

struct PointLanes {
  Doubles x, y, z;
};
inline Doubles dot(const double (&a)[3], const PointLanes& b) {
  return (a[0] * b.x + a[1] * b.y) + a[2] * b.z;
}
inline PointLanes minus(const PointLanes& a, const double (&b)[3]) {
  return {a.x - b[0], a.y - b[1], a.z - b[2]};
}

// Computes the squared distances of points from a facet that is not a sliver. All regions of the
// plane are evaluated, and each lane selects its own result.
inline Doubles squared_distances(const Facet& facet, const PointLanes& point) {
  const double(&ab)[3] = facet.to_second, (&ac)[3] = facet.to_third, (&corner)[3] = facet.corner;
  const Doubles zero{};
  const PointLanes from_a = minus(point, corner), from_b = minus(from_a, ab),
                   from_c = minus(from_a, ac);
  const Doubles d1 = dot(ab, from_a), d2 = dot(ac, from_a), d3 = dot(ab, from_b),
                d4 = dot(ac, from_b), d5 = dot(ab, from_c), d6 = dot(ac, from_c);
  const Doubles c = d1 * d4 - d3 * d2, b = d5 * d2 - d1 * d6, a = d3 * d6 - d5 * d4;
  const Doubles u = d4 - d3, w = d5 - d6;
  const DoubleMask at_a = (d1 <= zero) & (d2 <= zero), at_b = (d3 >= zero) & (d4 <= d3),
                   on_ab = (c <= zero) & (d1 >= zero) & (d3 <= zero),
                   at_c = (d6 >= zero) & (d5 <= d6),
                   on_ac = (b <= zero) & (d2 >= zero) & (d6 <= zero),
                   on_bc = (a <= zero) & (u >= zero) & (w >= zero);
  const Doubles along =
      (on_ab ? d1 : (on_ac ? d2 : u)) / (on_ab ? d1 - d3 : (on_ac ? d2 - d6 : u + w));
  const Doubles area = (a + b) + c;
  Doubles away[3];
#pragma GCC unroll 3
  for (int i = 0; i < 3; ++i) {
    const double second = corner[i] + ab[i], third = corner[i] + ac[i], bc = ac[i] - ab[i];
    Doubles foot = corner[i] + (b * ab[i] + c * ac[i]) / area;
    foot = on_bc ? second + along * bc : foot;
    foot = on_ac ? corner[i] + along * ac[i] : foot;
    foot = at_c ? zero + third : foot;
    foot = on_ab ? corner[i] + along * ab[i] : foot;
    foot = at_b ? zero + second : foot;
    foot = at_a ? zero + corner[i] : foot;
    away[i] = foot - (i == 0 ? point.x : i == 1 ? point.y : point.z);
  }
  return (away[0] * away[0] + away[1] * away[1]) + away[2] * away[2];
}

// Recomputes the bounds after a nearer facet was found.
inline void tighten(Packet& packet) {
  alignas(register_bytes) float bounds[packet_size];
  packet.farthest = 0.0F;
  for (int i = 0; i < packet_size; ++i) {
    const double squared = packet.squared[i / double_lanes][i % double_lanes];
    bounds[i] = static_cast<float>(squared) * (1.0F + 2.0F * unit);
    packet.farthest = bounds[i] > packet.farthest ? bounds[i] : packet.farthest;
  }
  for (int part = 0; part < float_parts; ++part) {
    packet.bound[part] = *reinterpret_cast<const Floats*>(bounds + part * float_lanes);
  }
}

using SliverDistance = double (*)(const Facet& facet, const double* point);

// Updates the distances of the packet with a facet. Only groups of lanes with at least one
// candidate point are evaluated.
inline void look_at(const Facet& facet, std::uint32_t slot, std::uint32_t lanes,
                    SliverDistance sliver_distance, Packet& packet) {
  bool is_nearer = false;
  for (int part = 0; part < double_parts; ++part) {
    if ((lanes >> (part * double_lanes) & ((1U << double_lanes) - 1U)) == 0) continue;
    const PointLanes point{packet.exactly[0][part], packet.exactly[1][part],
                           packet.exactly[2][part]};
    Doubles squared{};
    if (facet.is_sliver) {
      for (int lane = 0; lane < double_lanes; ++lane) {
        const double at[3] = {point.x[lane], point.y[lane], point.z[lane]};
        squared[lane] = sliver_distance(facet, at);
      }
    } else {
      squared = squared_distances(facet, point);
    }
    const DoubleMask is_less = squared < packet.squared[part];
    packet.squared[part] = is_less ? squared : packet.squared[part];
    is_nearer |= any(is_less);
  }
  if (!is_nearer) return;
  packet.nearest = slot;
  tighten(packet);
}

// Returns the lanes whose points may have a nearer facet in the box of a child.
inline std::uint32_t lanes_near(const FacetNode& node, int child, const Packet& packet) {
  const Floats zero{};
  std::uint32_t near = 0;
  for (int part = 0; part < float_parts; ++part) {
    Floats sum{};
#pragma GCC unroll 3
    for (int axis = 0; axis < 3; ++axis) {
      const Floats at = packet.at[axis][part], below = node.low[axis][child] - at,
                   above = at - node.high[axis][child];
      const Floats outside = (below > above ? below : above) - packet.slack[axis][part];
      const Floats distance = outside > zero ? outside : zero;
      sum += distance * distance;
    }
    near |= bits(sum * sum_rounding <= packet.bound[part]) << (part * float_lanes);
  }
  return near;
}

// Stack of unvisited children with the distances of their boxes from the box of the packet.
struct Waiting {
  struct Entry {
    float bound;
    std::uint32_t node;
    int child;
  };
  Entry entries[max_pending];
  std::size_t size = 0;

  // Pushes the nearest child last, so that it is visited first.
  void add_children(const FacetNode* nodes, std::uint32_t index, const Packet& packet) {
    const FacetNode& node = nodes[index];
    float bounds[FacetNode::lanes];
    for (int child = 0; child < FacetNode::lanes; ++child) {
      float sum = 0.0F;
      for (int axis = 0; axis < 3; ++axis) {
        const float below = node.low[axis][child] - packet.high[axis],
                    above = packet.low[axis] - node.high[axis][child];
        const float outside = below > above ? below : above;
        const float distance = outside > 0.0F ? outside : 0.0F;
        sum += distance * distance;
      }
      bounds[child] = sum * sum_rounding;
    }
    const std::size_t first = size;
    for (int child = 0; child < FacetNode::lanes; ++child) {
      if (!(bounds[child] <= packet.farthest)) continue;
      std::size_t slot = size++;
      for (; slot > first && entries[slot - 1].bound < bounds[child]; --slot) {
        entries[slot] = entries[slot - 1];
      }
      entries[slot] = {bounds[child], index, child};
    }
  }
};

inline void search(const FacetNode* nodes, const Facet* facets, SliverDistance sliver_distance,
                   Packet& packet) {
  constexpr std::uint32_t all = (1U << packet_size) - 1U;
  look_at(facets[packet.nearest], packet.nearest, all, sliver_distance, packet);
  Waiting waiting;
  waiting.add_children(nodes, 0, packet);
  while (waiting.size > 0) {
    const Waiting::Entry entry = waiting.entries[--waiting.size];
    if (entry.bound > packet.farthest) continue;
    const FacetNode& node = nodes[entry.node];
    const std::uint32_t near = lanes_near(node, entry.child, packet);
    if (near == 0) continue;
    const std::uint32_t child = node.child[entry.child];
    if ((child & FacetNode::is_facet) == 0) {
      waiting.add_children(nodes, child, packet);
      continue;
    }
    const std::uint32_t slot = child & ~FacetNode::is_facet;
    look_at(facets[slot], slot, near, sliver_distance, packet);
  }
}

inline void fill(Packet& packet, const double* const* points, std::size_t first) {
  for (int axis = 0; axis < 3; ++axis) {
    const double* from = points[axis] + first;
    packet.low[axis] = infinity;
    packet.high[axis] = -infinity;
    for (int i = 0; i < packet_size; ++i) {
      const auto at = static_cast<float>(from[i]);
      const float slack = 2.0F * unit * (at < 0.0F ? -at : at);
      packet.at[axis][i / float_lanes][i % float_lanes] = at;
      packet.slack[axis][i / float_lanes][i % float_lanes] = slack;
      packet.exactly[axis][i / double_lanes][i % double_lanes] = from[i];
      packet.low[axis] = at - slack < packet.low[axis] ? at - slack : packet.low[axis];
      packet.high[axis] = at + slack > packet.high[axis] ? at + slack : packet.high[axis];
    }
  }
  for (Doubles& squared : packet.squared) squared = Doubles{} + infinity;
}

void find_squared_distances(const FacetNode* nodes, const Facet* facets,
                            SliverDistance sliver_distance, std::size_t count,
                            const double* const* points, double* squared) {
  Packet packet;
  packet.nearest = 0;
  for (std::size_t first = 0; first < count; first += packet_size) {
    fill(packet, points, first);
    search(nodes, facets, sliver_distance, packet);
    for (int i = 0; i < packet_size; ++i) {
      squared[first + i] = packet.squared[i / double_lanes][i % double_lanes];
    }
  }
}

}  // namespace

const DistanceKernels SKYCAP_KERNELS_NAME = {find_squared_distances};

}  // namespace skycap::geometry
