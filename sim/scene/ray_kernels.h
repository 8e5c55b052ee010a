/// Ray casting with vector instructions. The kernels are compiled once per instruction set,
/// selected at run time, and give identical bits. All interfaces are plain arrays, because Eigen
/// types must not cross between sources with different instruction sets.
///
/// A ray hits a triangle according to the watertight test of S. Woop, C. Benthin and I. Wald:
/// Watertight Ray/Triangle Intersection, JCGT 2(1), 2013. Coordinates are taken relative to the
/// ray's origin and sheared such that the ray runs along its main axis, the largest component of
/// its direction. A vertex has the same sheared coordinates in all its triangles. The side of an
/// edge on which the ray passes is then exact, and an edge belongs to both sides. No ray can pass
/// between triangles that share an edge or a vertex.
///
/// Among the hits within reach, the nearest computed distance wins, and the smallest triangle
/// number among equal distances. The result depends only on the ray and the scene, not on the tree,
/// the other rays of a packet or the number of threads.
#pragma once

#include <cstdint>

#include "sim/scene/tree_layout.h"

namespace skycap::sim {

/// One copy of a part of the scene.
struct SceneCopy {
  TreeRoot part;
  float local_from_scene[3][4];  ///< Rows of the rotation with the translation in the last column.
  float scene_from_local[3][3];  ///< Rows of the rotation.
  /// Number of its first triangle among the triangles of all copies.
  std::uint32_t first_triangle;
};

/// Geometry for ray casting: one tree of triangles, or a tree over the boxes of copies.
struct RayTarget {
  TreeRoot tree;
  /// Copies, indexed by the leaf entries of the tree. Null: a tree of triangles.
  const SceneCopy* copies = nullptr;
};

/// Sixteen rays. Casting parallel rays together costs little more than casting one.
struct RayPacket {
  static constexpr int width = 16;
  static constexpr std::uint32_t all_lanes = 0xFFFF;

  alignas(64) float origin[3][width];
  alignas(64) float direction[3][width];  ///< Non-zero, not necessarily unit vectors.
  /// Result in multiples of the direction's length. -1: no hit.
  alignas(64) float distance[width];
  /// Resulting normal according to the triangle's orientation, of any length.
  alignas(64) float normal[3][width];
  alignas(64) std::uint32_t triangle[width];  ///< Resulting triangle number.
};

/// Single ray with the fields of RayPacket.
struct SingleRay {
  float origin[3];
  float direction[3];
  float distance;
  float normal[3];
  std::uint32_t triangle;
};

/// Ray casting functions of one instruction set. The search ends at `reach`, in multiples of the
/// direction's length. `lanes` is a bit mask of the rays to cast. The other rays get the distance
/// -1. Normal and triangle are undefined without a hit.
struct RayKernels {
  void (*cast)(const RayTarget&, RayPacket&, std::uint32_t lanes, float reach);
  /// Casts all lanes of several packets of near-parallel rays, such as those of an image tile.
  /// Faster than separate calls if triangles are large compared with the tile.
  void (*cast_tile)(const RayTarget&, RayPacket* packets, int count, float reach);
  /// Variant of cast_tile() that computes only distances.
  void (*cast_tile_distances)(const RayTarget&, RayPacket* packets, int count, float reach);
  void (*cast_single)(const RayTarget&, SingleRay&, float reach);
  /// Returns true if the ray hits anything. Does not write results.
  bool (*is_blocked)(const RayTarget&, const SingleRay&, float reach);
  /// Returns a bit mask of the blocked rays.
  std::uint32_t (*blocked)(const RayTarget&, const RayPacket&, std::uint32_t lanes, float reach);
};

extern const RayKernels baseline_ray_kernels;
#ifdef SKYCAP_X86_64_KERNELS
extern const RayKernels avx2_ray_kernels;
extern const RayKernels avx512_ray_kernels;
#endif

/// Returns the kernels for geometry::instruction_set().
const RayKernels& ray_kernels();

}  // namespace skycap::sim
