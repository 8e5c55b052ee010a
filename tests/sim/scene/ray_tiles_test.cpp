#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "sim/scene/ray_kernels.h"
#include "tests/sim/triangle_soup.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/not_empty.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3f;

/// Returns packets of 4 x 4 pixels for a small image from a position, along an axis or in a random
/// direction. `width` is the image width at depth 1. In narrow images all directions have the same
/// signs.
std::vector<RayPacket> tile(std::mt19937_64& random, std::size_t count, float width) {
  const Vector3f origin = random_point(random, 9.0F);
  const Vector3f ahead = random_point(random, 1.0F);
  const Vector3f right = random_point(random, 1.0F), down = random_point(random, 1.0F);
  std::vector<RayPacket> packets(count);
  for (std::size_t i = 0; i < count; ++i) {
    for (int lane = 0; lane < RayPacket::width; ++lane) {
      const std::size_t column = i % 4 * 4 + lane % 4, row = i / 4 * 4 + lane / 4;
      const float x = static_cast<float>(column) / 16.0F;
      const float y = static_cast<float>(row) / 16.0F;
      const Vector3f direction = ahead + width * (x * right + y * down);
      for (int axis = 0; axis < 3; ++axis) {
        packets[i].origin[axis][lane] = origin[axis];
        packets[i].direction[axis][lane] = direction[axis];
      }
    }
  }
  return packets;
}

// Packets that traverse the tree together: few and many, wide and narrow, with large and small
// triangles. Each ray gives bitwise the same hit as alone.
TEST(RayKernels, MatchSingleRaysInTiles) {
  std::mt19937_64 random(7);
  int hits = 0;
  for (const std::size_t triangle_count : {2U, 40U, 3000U}) {
    const geometry::Mesh mesh = random_soup(random, triangle_count);
    const Triangles triangles(mesh);
    for (int i = 0; i < 150; ++i) {
      const std::size_t count = 1 + random() % 16;
      const float width = i % 3 == 0 ? 2.0F : i % 3 == 1 ? 0.3F : 0.02F;
      const float reach = i % 5 == 0 ? 6.0F : infinity;
      const std::vector<RayPacket> packets = tile(random, count, width);
      for (const geometry::InstructionSet set : testing_support::not_empty(instruction_sets())) {
        const InstructionSetLimit limit(set);
        std::vector<RayPacket> all = packets, distances = packets;
        const int number = static_cast<int>(count);
        ray_kernels().cast_tile(triangles.target(), all.data(), number, reach);
        ray_kernels().cast_tile_distances(triangles.target(), distances.data(), number, reach);
        for (std::size_t at = 0; at < count * RayPacket::width; ++at) {
          const RayPacket& packet = all[at / RayPacket::width];
          const std::size_t lane = at % RayPacket::width;
          SingleRay one = {};
          for (int axis = 0; axis < 3; ++axis) {
            one.origin[axis] = packet.origin[axis][lane];
            one.direction[axis] = packet.direction[axis][lane];
          }
          one = cast(triangles, one, reach);
          ASSERT_EQ(packet.distance[lane], one.distance) << static_cast<int>(set);
          ASSERT_EQ(distances[at / RayPacket::width].distance[lane], one.distance);
          if (one.distance < 0.0F) continue;
          ++hits;
          ASSERT_EQ(packet.triangle[lane], one.triangle);
          for (int axis = 0; axis < 3; ++axis) {
            ASSERT_EQ(packet.normal[axis][lane], one.normal[axis]);
          }
        }
      }
    }
  }
  EXPECT_GT(hits, 20'000);
}

}  // namespace
}  // namespace skycap::sim
