/// What a ray hits, in arithmetic of our own: compiled once for each vector instruction set and
/// chosen at run time, with the same bits from all of them. All interfaces are plain arrays,
/// because Eigen types must not cross between sources with different instruction sets.
///
/// A ray hits a triangle if it does so after all coordinates are taken relative to its origin and
/// sheared until it runs along its main axis, where its direction is greatest (S. Woop, C. Benthin,
/// I. Wald: Watertight Ray/Triangle Intersection, JCGT 2(1), 2013). A vertex goes to the same place
/// in all its triangles, and on which side of an edge the ray passes is then told exactly, the edge
/// itself belonging to both sides. So no ray slips between triangles that share an edge or a
/// vertex.
///
/// Of the triangles that a ray hits within its reach it meets the nearest one, by the distances so
/// computed, and of equally near ones that with the smallest number. That is a property of the ray
/// and the scene alone: neither the shape of the tree, nor the other rays of a packet, nor the
/// number of threads have a say in it.
#pragma once

#include <cstdint>

#include "sim/scene/tree_layout.h"

namespace skycap::sim {

/// One copy of a part of the scene.
struct SceneCopy {
  TreeRoot part;
  float local_from_scene[3][4];  ///< rows of the rotation and, last, the shift
  float scene_from_local[3][3];  ///< rows of the rotation
  std::uint32_t first_triangle;  ///< number of its first triangle among those of all copies
};

/// What rays are cast at: one tree of triangles, or of the boxes of copies.
struct RayTarget {
  TreeRoot tree;
  const SceneCopy* copies = nullptr;  ///< by the numbers in the tree's leaves; none: triangles
};

/// Sixteen rays, which cost little more together than one alone if they run side by side.
struct RayPacket {
  static constexpr int width = 16;
  static constexpr std::uint32_t all_lanes = 0xFFFF;

  alignas(64) float origin[3][width];
  alignas(64) float direction[3][width];  ///< of any length but zero
  alignas(64) float distance[width];      ///< result, in lengths of the direction; -1: no hit
  alignas(64) float normal[3][width];  ///< result: of the triangle, by its orientation; any length
  alignas(64) std::uint32_t triangle[width];  ///< result
};

/// The same for one ray.
struct SingleRay {
  float origin[3];
  float direction[3];
  float distance;
  float normal[3];
  std::uint32_t triangle;
};

/// All of them look no farther than `reach` lengths of the direction. Lanes, one bit each, that are
/// not to be cast get the distance -1; normal and triangle mean nothing where there is no hit.
struct RayKernels {
  void (*cast)(const RayTarget&, RayPacket&, std::uint32_t lanes, float reach);
  /// All lanes of several packets that run side by side, as those of a tile of an image: quicker
  /// than one after the other where triangles are large beside the tile.
  void (*cast_tile)(const RayTarget&, RayPacket* packets, int count, float reach);
  /// The same without normals and triangles.
  void (*cast_tile_distances)(const RayTarget&, RayPacket* packets, int count, float reach);
  void (*cast_single)(const RayTarget&, SingleRay&, float reach);
  /// Whether a ray hits anything; writes no results.
  bool (*is_blocked)(const RayTarget&, const SingleRay&, float reach);
  /// Which of the lanes do, a bit each.
  std::uint32_t (*blocked)(const RayTarget&, const RayPacket&, std::uint32_t lanes, float reach);
};

extern const RayKernels baseline_ray_kernels;
#ifdef SKYCAP_X86_64_KERNELS
extern const RayKernels avx2_ray_kernels;
extern const RayKernels avx512_ray_kernels;
#endif

/// Those for geometry::instruction_set().
const RayKernels& ray_kernels();

}  // namespace skycap::sim
