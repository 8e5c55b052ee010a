#include "survey/volumetric/volumetric_map.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <octomap/OcTree.h>

#include "geometry/error.h"
#include "survey/volumetric/scan_voxels.h"
#include "tests/support/clouds.h"
#include "tests/support/complaint.h"
#include "tests/support/not_empty.h"
#include "tests/support/sphere_sensor.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using geometry::Camera;
using geometry::look_at;
using geometry::Scan;

octomap::point3d octomap_point(const Vector3f& p) { return {p.x(), p.y(), p.z()}; }

octomap::OcTree octomap_with_the_same_model(double resolution) {
  octomap::OcTree tree(resolution);
  tree.setProbHit(0.7);
  tree.setProbMiss(0.4);
  tree.setClampingThresMin(0.12);
  tree.setClampingThresMax(0.97);
  return tree;
}

/// Returns noisy depth camera scans around two spheres, one of which hides part of the other.
std::vector<Scan> recorded_scans() {
  const Camera camera({.width = 212, .height = 120});
  const std::vector<tests::Sphere> spheres{{{0.0, 0.0, 0.5}, 0.4}, {{0.5, 0.2, 0.4}, 0.2}};
  std::vector<Scan> scans;
  const Vector3d centre(0.1, 0.05, 0.45);
  for (const Vector3d& position :
       {Vector3d(2.3, 0.1, 0.6), Vector3d(1.6, 1.5, 1.1), Vector3d(-0.4, 2.2, 0.3),
        Vector3d(2.2, 0.4, 0.7), Vector3d(0.1, 0.3, 2.7), Vector3d(-2.0, -0.9, -0.2)}) {
    scans.push_back(
        tests::scan_spheres(spheres, camera, look_at(position, centre), 0.01, scans.size() + 1));
  }
  return scans;
}

class OctoMapComparison : public testing::TestWithParam<double> {};

// Independent reference: the same voxels and values, to the last bit.
TEST_P(OctoMapComparison, HasSameVoxelsAfterEveryScan) {
  const double resolution = GetParam();
  volumetric::VolumetricMap map(resolution, 18.0 * resolution);
  octomap::OcTree tree = octomap_with_the_same_model(resolution);
  for (const Scan& scan : testing_support::not_empty(recorded_scans())) {
    const Vector3f origin = scan.sensor_position().cast<float>();
    map.insert(origin, scan.points);
    octomap::Pointcloud cloud;
    for (const Vector3f& point : scan.points) cloud.push_back(octomap_point(point));
    tree.insertPointCloud(cloud, octomap_point(origin), -1.0, true);

    std::size_t compared = 0, different = 0;
    const auto compare = [&](const octomap::OcTreeKey& key) {
      const octomap::point3d centre = tree.keyToCoord(key);
      const volumetric::VoxelState& ours = map.state_at({centre.x(), centre.y(), centre.z()});
      const bool is_measured = ours.kind >= volumetric::VoxelKind::free;
      const octomap::OcTreeNode* theirs = tree.search(key);
      ++compared;
      if (is_measured != (theirs != nullptr) ||
          (theirs && std::abs(ours.occupancy - theirs->getOccupancy()) > 1e-12)) {
        ++different;
      }
    };
    const octomap::OcTreeKey low = tree.coordToKey(-2.3, -2.3, -0.5);
    const octomap::OcTreeKey high = tree.coordToKey(2.4, 2.4, 2.8);
    for (unsigned x = low[0]; x <= high[0]; ++x) {
      for (unsigned y = low[1]; y <= high[1]; ++y) {
        for (unsigned z = low[2]; z <= high[2]; ++z) {
          compare({static_cast<octomap::key_type>(x), static_cast<octomap::key_type>(y),
                   static_cast<octomap::key_type>(z)});
        }
      }
    }
    EXPECT_GT(compared, 10'000U);
    EXPECT_EQ(different, 0U) << "of " << compared;
  }
}

INSTANTIATE_TEST_SUITE_P(Resolutions, OctoMapComparison, testing::Values(0.05, 0.034));

/// Returns the voxels that a walk over bricks and their voxels passes.
std::vector<volumetric::VoxelIndex> passed(const Vector3f& origin, const Vector3f& end,
                                           double resolution) {
  std::vector<volumetric::VoxelIndex> voxels;
  const volumetric::VoxelLine line(origin, end, resolution);
  if (line.is_in_one_voxel()) return voxels;
  volumetric::for_each_brick(
      line, [](const auto&) { return false; },
      [&](const auto& bricks) {
        volumetric::VoxelWalk walk(line, bricks.entered());
        for (; !walk.is_over() && !walk.left_brick(); walk.advance()) {
          const auto child_index = static_cast<std::int32_t>(walk.child_index());
          const volumetric::VoxelIndex& brick = bricks.cell();
          voxels.push_back({4 * brick[0] + child_index % 4, 4 * brick[1] + child_index / 4 % 4,
                            4 * brick[2] + child_index / 16});
        }
        return !walk.is_over();
      });
  return voxels;
}

/// Returns segments in all directions, along an axis, in a plane, and through edges and corners of
/// voxels.
std::vector<std::pair<Vector3f, Vector3f>> segments() {
  const auto points = tests::random_points(300, 2.6, 5);
  std::vector<std::pair<Vector3f, Vector3f>> segments{
      {{0.05F, 0.05F, 0.05F}, {1.25F, 1.25F, 1.25F}},
      {{1.25F, 1.25F, 1.25F}, {-1.0F, -1.0F, -1.0F}},
      {{-1.0F, 0.3F, 0.2F}, {1.0F, 0.3F, -0.9F}},
      {{0.1F, 0.1F, 0.1F}, {1.1F, -0.9F, 0.1F}},
      {{0.05F, 0.05F, 1.05F}, {0.05F, 0.05F, -1.45F}},
      {{0.01F, 0.02F, 0.03F}, {0.02F, 0.01F, 0.3F}}};
  for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
    segments.emplace_back(points[i], points[i + 1]);
  }
  return segments;
}

// Brute force: each passed voxel intersects the segment, and consecutive voxels share a face.
TEST(VoxelWalk, PassesAdjacentVoxelsThatIntersectSegment) {
  const double resolution = 0.1;
  const auto points = tests::random_points(200, 1.3, 4);
  for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
    const Vector3d a = points[i].cast<double>(), b = points[i + 1].cast<double>();
    const auto voxels = passed(points[i], points[i + 1], resolution);
    ASSERT_FALSE(voxels.empty());
    EXPECT_EQ(voxels.front(), volumetric::voxel_at(points[i], 1.0 / resolution));
    for (std::size_t k = 0; k < voxels.size(); ++k) {
      const volumetric::VoxelIndex& next =
          k + 1 < voxels.size() ? voxels[k + 1]
                                : volumetric::voxel_at(points[i + 1], 1.0 / resolution);
      int steps = 0;
      double enters = 0.0, leaves = 1.0;
      for (int axis = 0; axis < 3; ++axis) {
        steps += std::abs(next[axis] - voxels[k][axis]);
        const double low = (voxels[k][axis] * resolution - a[axis]) / (b[axis] - a[axis]);
        const double high = ((voxels[k][axis] + 1) * resolution - a[axis]) / (b[axis] - a[axis]);
        enters = std::max(enters, std::min(low, high));
        leaves = std::min(leaves, std::max(low, high));
      }
      EXPECT_EQ(steps, 1);
      EXPECT_LE(enters, leaves + 1e-5);  // directions are rounded to single precision
    }
  }
}

// Reference: the scan walks four rays at a time over the whole segments and the rest one by one.
// The other walk starts again in each brick.
TEST(VoxelWalk, PassesSameVoxelsAsScan) {
  for (const double resolution : {0.1, 0.06}) {
    for (const auto& [origin, end] : segments()) {
      const Vector3f ray = end - origin;
      const Vector3f turned(ray.y(), ray.z(), ray.x());
      const std::vector<Vector3f> ends{end,          origin + 0.5F * ray, origin + turned,
                                       origin - ray, origin - 2 * turned, origin + ray + turned};
      std::set<volumetric::VoxelIndex> one_by_one;
      for (const Vector3f& each : ends) {
        const auto voxels = passed(origin, each, resolution);
        one_by_one.insert(voxels.begin(), voxels.end());
      }
      std::set<volumetric::VoxelIndex> scan_voxels;
      volumetric::ScanVoxels({origin}, {}, ends, resolution, resolution)
          .for_each([&](const volumetric::VoxelIndex& voxel, volumetric::ScanVoxels::Mark mark) {
            EXPECT_EQ(mark, volumetric::ScanVoxels::passed);
            EXPECT_TRUE(scan_voxels.insert(voxel).second);
          });
      EXPECT_EQ(one_by_one, scan_voxels);
    }
  }
}

TEST(VoxelWalk, SkipsBricksToTheCorrectNextVoxel) {
  std::size_t skipped = 0;
  for (const auto& [origin, end] : segments()) {
    const double resolution = 0.03;
    const auto voxels = passed(origin, end, resolution);
    const volumetric::VoxelLine line(origin, end, resolution);
    for (volumetric::CellWalk<volumetric::brick_shift> bricks(line); bricks.may_be_skipped();
         bricks.cross()) {
      const auto before = static_cast<std::size_t>(line.voxels_before(bricks.leaving()));
      ASSERT_LT(before, voxels.size());
      EXPECT_EQ(volumetric::coarser(voxels[before - 1], volumetric::brick_shift), bricks.cell());
      EXPECT_NE(volumetric::coarser(voxels[before], volumetric::brick_shift), bricks.cell());
      EXPECT_EQ(line.voxel_before(bricks.leaving()), voxels[before - 1]);
      ++skipped;
    }
    std::size_t in_blocks = 0;
    for (volumetric::CellWalk<volumetric::block_shift> blocks(line); blocks.may_be_skipped();
         blocks.cross()) {
      const auto before = static_cast<std::size_t>(line.voxels_before(blocks.leaving()));
      EXPECT_EQ(volumetric::coarser(voxels[before - 1], volumetric::block_shift), blocks.cell());
      EXPECT_EQ(volumetric::coarser(voxels[in_blocks], volumetric::block_shift), blocks.cell());
      in_blocks = before;
    }
  }
  EXPECT_GT(skipped, 1000U);
}

TEST(VoxelWalk, PassesNoVoxelsWithinOneVoxel) {
  EXPECT_TRUE(
      volumetric::VoxelLine({0.01F, 0.02F, 0.03F}, {0.09F, 0.01F, 0.05F}, 0.1).is_in_one_voxel());
}

TEST(ScanVoxels, RejectsMoreVoxelsThanMemoryCanContain) {
  const std::vector<Vector3f> far_away{{9e3F, 9e3F, 9e3F}};
  EXPECT_THAT(testing_support::thrown_message([&] {
                volumetric::ScanVoxels({0.0F, 0.0F, 0.0F}, far_away, {}, 0.01, 0.1);
              }),
              testing::HasSubstr("raise planner.resolution_radius"));
}

TEST(VoxelWalk, PassesOneRowAlongAxisInBothDirections) {
  const auto there = passed({0.05F, 0.05F, 0.05F}, {2.05F, 0.05F, 0.05F}, 0.1);
  const auto back = passed({2.05F, 0.05F, 0.05F}, {0.05F, 0.05F, 0.05F}, 0.1);
  ASSERT_EQ(there.size(), 20U);
  ASSERT_EQ(back.size(), 20U);
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(there[i], (volumetric::VoxelIndex{i, 0, 0}));
    EXPECT_EQ(back[i], (volumetric::VoxelIndex{20 - i, 0, 0}));
  }
}

/// Returns the state of a voxel on the +x axis, at the centre of a voxel of 0.1 m.
volumetric::VoxelState state_on_x(const volumetric::VolumetricMap& map, int voxel) {
  return map.state_at({0.1F * static_cast<float>(voxel) + 0.05F, 0.05F, 0.05F});
}

const Vector3f at_origin(0.05F, 0.05F, 0.05F);
const Vector3f ten_ahead(1.05F, 0.05F, 0.05F);

TEST(VolumetricMap, MarksShadowsWithDepthInVoxels) {
  volumetric::VolumetricMap map(0.1, 0.5);
  map.insert(at_origin, std::vector{ten_ahead});
  EXPECT_EQ(map.max_shadow(), 10.0);
  for (int depth = 1; depth <= 4; ++depth) {
    EXPECT_EQ(state_on_x(map, 10 + depth).kind, volumetric::VoxelKind::shadowed);
    EXPECT_EQ(state_on_x(map, 10 + depth).shadow_depth, depth);
  }
  // The shadow ends at 1.55 m in voxel 15, and its last voxel is not marked.
  EXPECT_EQ(state_on_x(map, 15).kind, volumetric::VoxelKind::untouched);
}

TEST(VolumetricMap, KeepsMinShadowDepthUntilVoxelIsMeasured) {
  volumetric::VolumetricMap map(0.1, 0.5);
  map.insert(at_origin, std::vector{ten_ahead});
  map.insert({2.45F, 0.05F, 0.05F}, std::vector<Vector3f>{{1.55F, 0.05F, 0.05F}});
  // Measured from the other side: 14 is one voxel behind the new surface at 15, 11 is four behind
  // it.
  EXPECT_EQ(state_on_x(map, 14).shadow_depth, 1);
  EXPECT_EQ(state_on_x(map, 11).shadow_depth, 1);
  EXPECT_EQ(state_on_x(map, 12).shadow_depth, 2);
  map.insert({0.05F, 0.05F, 0.95F}, std::vector<Vector3f>{{2.35F, 0.05F, -0.85F}});
  EXPECT_EQ(state_on_x(map, 12).kind, volumetric::VoxelKind::uncertain);  // passed once
}

TEST(VolumetricMap, ExcludesMeasuredVoxelsFromShadows) {
  volumetric::VolumetricMap map(0.1, 0.5);
  map.insert({1.35F, 1.05F, 0.05F}, std::vector<Vector3f>{{1.35F, -1.05F, 0.05F}});
  map.insert(at_origin, std::vector{ten_ahead});
  EXPECT_EQ(state_on_x(map, 12).kind, volumetric::VoxelKind::shadowed);
  EXPECT_EQ(state_on_x(map, 13).kind, volumetric::VoxelKind::uncertain);
  EXPECT_EQ(state_on_x(map, 14).kind, volumetric::VoxelKind::shadowed);
}

TEST(VolumetricMap, UpdatesVoxelOncePerScan) {
  volumetric::VolumetricMap once(0.1, 0.5), often(0.1, 0.5);
  once.insert(at_origin, std::vector{ten_ahead});
  often.insert(at_origin, std::vector(50, ten_ahead));
  for (int voxel = 0; voxel <= 10; ++voxel) {
    EXPECT_EQ(state_on_x(often, voxel).occupancy, state_on_x(once, voxel).occupancy);
  }
}

TEST(VolumetricMap, MarksEmptySegmentsAsFreeWithoutSurface) {
  volumetric::VolumetricMap map(0.1, 0.5);
  map.insert(at_origin, {}, std::vector{ten_ahead});
  EXPECT_LT(state_on_x(map, 9).occupancy, 0.5);
  EXPECT_EQ(state_on_x(map, 10).kind, volumetric::VoxelKind::untouched);
  EXPECT_EQ(state_on_x(map, 11).kind, volumetric::VoxelKind::untouched);
  EXPECT_TRUE(map.surface_box().isEmpty());
}

TEST(VolumetricMap, BoundsAllVoxelsThatStopRays) {
  volumetric::VolumetricMap map(0.1, 0.5);
  const auto points = tests::random_points(300, 3.0, 9);
  map.insert({9.0F, 1.0F, 2.0F}, points);
  for (const Vector3f& point : points) {
    EXPECT_TRUE(map.surface_box().contains(point.cast<double>()));
  }
}

}  // namespace
}  // namespace skycap::survey
