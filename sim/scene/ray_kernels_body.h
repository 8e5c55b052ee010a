/// Body of ray_kernels_*.cpp, which define SKYCAP_KERNELS_NAME and include it once each. Those
/// sources are compiled for different processors, so all content of this file and the headers below
/// is internal to them. Inline functions of libraries must not be called, because the linker would
/// keep an arbitrary copy. Contraction to fused multiply-adds is off (CMakeLists.txt).

#include "sim/scene/lanes_body.h"
#include "sim/scene/ray_kernels.h"
#include "sim/scene/tile_walk_body.h"
#include "sim/scene/tree_walk_body.h"
#include "sim/scene/triangle_test_body.h"

namespace skycap::sim {
namespace {

// Passes rays through a tree in groups whose directions have equal signs.
template <typename Work>
inline void for_each_bundle(const TreeRoot& tree, float padding, const Rays<Floats>& rays,
                            std::uint32_t lanes, Work&& work) {
  std::uint32_t backwards[3];
  for (int axis = 0; axis < 3; ++axis) {
    backwards[axis] = bits(is_less(rays.direction[axis], every<Floats>(0.0F)));
  }
  while (lanes != 0) {
    const int first = __builtin_ctz(lanes);
    std::uint32_t coherent = lanes;
    bool is_backwards[3];
    for (int axis = 0; axis < 3; ++axis) {
      is_backwards[axis] = (backwards[axis] >> first & 1U) != 0;
      coherent &= is_backwards[axis] ? backwards[axis] : ~backwards[axis];
    }
    lanes &= ~coherent;
    work(make_bundle(rays, make_mask(coherent), is_backwards, tree.extent, padding));
  }
}
template <typename Work>
inline void for_each_bundle(const TreeRoot& tree, float padding, const Rays<float>& rays, Truth,
                            Work&& work) {
  const bool is_backwards[] = {rays.direction[0] < 0.0F, rays.direction[1] < 0.0F,
                               rays.direction[2] < 0.0F};
  work(make_bundle(rays, Truth{true}, is_backwards, tree.extent, padding));
}

inline std::uint32_t to_lane_bits(const Mask& mask) { return bits(mask); }
inline Truth to_lane_bits(Truth truth) { return truth; }

template <HitQuery query, typename Lanes, typename Set>
[[gnu::noinline]] void cast_at_triangles(const TreeRoot& tree, const SceneCopy* copy,
                                         const Rays<Lanes>& rays, Set lanes,
                                         Nearest<Lanes>& nearest) {
  for_each_bundle(tree, triangle_padding, rays, lanes, [&](const Bundle<Lanes>& bundle) {
    const TriangleTest<Lanes, query> test(rays, bundle.active, tree.extent, copy);
    Walk<Lanes>(bundle, nearest)(tree.ref, test);
  });
}

template <typename Lanes>
inline Rays<Lanes> to_copy_frame(const SceneCopy& copy, const Rays<Lanes>& rays) {
  Rays<Lanes> local;
  for (int axis = 0; axis < 3; ++axis) {
    const float(&row)[4] = copy.local_from_scene[axis];
    const auto rotated = [&](const Lanes(&vector)[3]) {
      return (every<Lanes>(row[0]) * vector[0] + every<Lanes>(row[1]) * vector[1]) +
             every<Lanes>(row[2]) * vector[2];
    };
    local.origin[axis] = rotated(rays.origin) + every<Lanes>(row[3]);
    local.direction[axis] = rotated(rays.direction);
  }
  return local;
}

template <HitQuery query, typename Lanes, typename Set>
void cast_at_copies(const RayTarget& target, const Rays<Lanes>& rays, Set lanes,
                    Nearest<Lanes>& nearest) {
  const auto test = [&](TreeRef leaf, const LaneMask<Lanes>& active, Nearest<Lanes>& found) {
    const auto* const numbers = reinterpret_cast<const std::uint32_t*>(leaf & ~tree_ref_entries);
    for (TreeRef i = 0; i < (leaf & tree_ref_entries); ++i) {
      const SceneCopy& copy = target.copies[numbers[i]];
      cast_at_triangles<query>(copy.part, &copy, to_copy_frame(copy, rays), to_lane_bits(active),
                               found);
    }
    return any(found.is_hit);
  };
  for_each_bundle(target.tree, copy_padding, rays, lanes, [&](const Bundle<Lanes>& bundle) {
    Walk<Lanes>(bundle, nearest)(target.tree.ref, test);
  });
}

template <HitQuery query, typename Lanes, typename Set>
inline Nearest<Lanes> nearest_hits(const RayTarget& target, const Rays<Lanes>& rays, Set lanes,
                                   float reach) {
  const Lanes zero = every<Lanes>(0.0F);
  Nearest<Lanes> nearest = {every<Lanes>(reach), is_less(zero, zero), zero, {zero, zero, zero}};
  if (target.copies == nullptr) {
    cast_at_triangles<query>(target.tree, nullptr, rays, lanes, nearest);
  } else {
    cast_at_copies<query>(target, rays, lanes, nearest);
  }
  return nearest;
}

template <HitQuery query>
void cast_packet(const RayTarget& target, RayPacket& packet, std::uint32_t lanes, float reach) {
  store_nearest<query>(nearest_hits<query>(target, make_rays(packet), lanes, reach), packet);
}

template <HitQuery query>
void cast_tile(const RayTarget& target, RayPacket* packets, int count, float reach) {
  constexpr int min_count = 4;  // Minimum number of packets for which joint casting is faster.
  const bool is_tree =
      target.copies == nullptr && target.tree.ref != 0 && (target.tree.ref & tree_ref_entries) == 0;
  if (is_tree && count >= min_count && cast_together<query>(target.tree, packets, count, reach)) {
    return;
  }
  for (int i = 0; i < count; ++i) {
    cast_packet<query>(target, packets[i], RayPacket::all_lanes, reach);
  }
}

inline Rays<float> make_rays(const SingleRay& ray) {
  Rays<float> rays;
  for (int axis = 0; axis < 3; ++axis) {
    rays.origin[axis] = ray.origin[axis];
    rays.direction[axis] = ray.direction[axis];
  }
  return rays;
}

void cast_single(const RayTarget& target, SingleRay& ray, float reach) {
  const auto nearest = nearest_hits<HitQuery::surface>(target, make_rays(ray), Truth{true}, reach);
  ray.distance = any(nearest.is_hit) ? nearest.distance : -1.0F;
  ray.triangle = __builtin_bit_cast(std::uint32_t, nearest.triangle);
  for (int axis = 0; axis < 3; ++axis) ray.normal[axis] = nearest.normal[axis];
}

bool is_blocked(const RayTarget& target, const SingleRay& ray, float reach) {
  return any(nearest_hits<HitQuery::any>(target, make_rays(ray), Truth{true}, reach).is_hit);
}

std::uint32_t blocked(const RayTarget& target, const RayPacket& packet, std::uint32_t lanes,
                      float reach) {
  return bits(nearest_hits<HitQuery::any>(target, make_rays(packet), lanes, reach).is_hit);
}

}  // namespace

const RayKernels SKYCAP_KERNELS_NAME = {cast_packet<HitQuery::surface>,
                                        cast_tile<HitQuery::surface>,
                                        cast_tile<HitQuery::distance>,
                                        cast_single,
                                        is_blocked,
                                        blocked};

}  // namespace skycap::sim
