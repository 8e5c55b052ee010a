#include "flight/district/measured_union.h"

#include <random>
#include <sstream>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/flight/clearance/ray_sensor.h"
#include "tests/flight/scenes.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using testing::HasSubstr;
using testing_support::thrown_message;

constexpr double voxel = 0.5;

/// Boxes aligned with voxels, so that a box contains whole voxels only.
const AlignedBox3d west(Vector3d(-10, -6, 0), Vector3d(2, 6, 8));
const AlignedBox3d east(Vector3d(-2, -6, 0), Vector3d(10, 6, 8));

MeasuredSpace make_space(const AlignedBox3d& region) {
  return MeasuredSpace({.voxel = voxel, .region = region});
}

geometry::Scan make_scan(const std::vector<Eigen::Vector3f>& points) {
  geometry::Scan scan;
  scan.points = points;
  return scan;
}

std::vector<MeasuredSpace> both(MeasuredSpace a, MeasuredSpace b) {
  std::vector<MeasuredSpace> spaces;
  spaces.push_back(std::move(a));
  spaces.push_back(std::move(b));
  return spaces;
}

/// Returns random boxes of whole voxels in a region.
std::vector<AlignedBox3d> measured_in(const AlignedBox3d& region, std::mt19937_64& random) {
  std::vector<AlignedBox3d> boxes;
  for (int i = 0; i < 12; ++i) {
    const Vector3d a = scenes::point_in(random, region), b = scenes::point_in(random, region);
    const Vector3d low = (a.cwiseMin(b) / voxel).array().floor() * voxel;
    const Vector3d high = (a.cwiseMax(b) / voxel).array().ceil() * voxel;
    boxes.push_back(AlignedBox3d(low, high).intersection(region));
  }
  return boxes;
}

/// The rule of the union: unknown space is limited to the hull of both regions. Within it, space
/// outside both regions and space that either survey has measured is free.
TEST(MeasuredUnion, MatchesOneSurveyOfAllRegions) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 20; ++round) {
    MeasuredSpace a = make_space(west), b = make_space(east), all = make_space(west.merged(east));
    for (const AlignedBox3d& box : measured_in(west, random)) {
      a.declare_free(box);
      all.declare_free(box);
    }
    for (const AlignedBox3d& box : measured_in(east, random)) {
      b.declare_free(box);
      all.declare_free(box);
    }
    const std::vector<Eigen::Vector3f> points_a{scenes::point_in(random, west).cast<float>()};
    const std::vector<Eigen::Vector3f> points_b{scenes::point_in(random, east).cast<float>()};
    a.insert(make_scan(points_a), 0.1), all.insert(make_scan(points_a), 0.1);
    b.insert(make_scan(points_b), 0.1), all.insert(make_scan(points_b), 0.1);
    const MeasuredUnion together(both(std::move(a), std::move(b)));
    const AlignedBox3d around(Vector3d(-14, -9, -2), Vector3d(14, 9, 11));
    for (int i = 0; i < 300; ++i) {
      const Segment leg{scenes::point_in(random, around), scenes::point_in(random, around)};
      EXPECT_NEAR(together.closest(leg, 6.0).distance, all.closest(leg, 6.0).distance, 1e-9);
      EXPECT_EQ(together.is_free(leg, 1.0), all.is_free(leg, 1.0));
    }
  }
}

// Space that one survey observed as free is occupied if another survey measured a point there.
TEST(MeasuredUnion, IsOccupiedWhereAnySurveyMeasuredAPoint) {
  MeasuredSpace a = make_space(west), b = make_space(east);
  a.declare_free(west);
  b.declare_free(east);
  b.insert(make_scan({{0.25F, 0.25F, 4.25F}}), 0.1);
  const MeasuredUnion together(both(std::move(a), std::move(b)));
  const Closest closest = together.closest({{0.25, -4, 4.25}, {0.25, -2, 4.25}}, 5.0);
  EXPECT_EQ(closest.kind, ObstacleKind::occupied_space);
  EXPECT_NEAR(closest.distance, 2.0, 1e-9);
  EXPECT_EQ(together.name(closest), "a measured point");
}

/// Returns the space of a survey in the west that also observed a wall in the east, beyond its own
/// box.
MeasuredSpace seen_from_the_west(const std::vector<AlignedBox3d>& extra_boxes) {
  MeasuredSpace space({.voxel = voxel, .region = west, .extra_boxes = extra_boxes});
  const geometry::Camera camera(
      {.width = 96, .height = 64, .horizontal_fov = 1.5, .vertical_fov = 1.1});
  const geometry::Mesh wall = scenes::box({9, -20, -20}, {10, 20, 30});
  space.insert(depth_image(wall, camera, geometry::look_at({-8, 0, 4}, {10, 0, 4})), camera);
  return space;
}

/// Writes and reads a space as a package does.
MeasuredSpace read_again(const MeasuredSpace& space) {
  std::stringstream file;
  space.write(file);
  return MeasuredSpace::read(file, "free.bin");
}

// Free space that a survey observed outside its own box is free in the boxes of other surveys, too.
TEST(MeasuredUnion, IncludesFreeSpaceObservedOutsideOwnRegion) {
  const Segment beyond{{3.5, 0, 4}, {7, 0, 4}};
  const MeasuredSpace alone = seen_from_the_west({}), kept = seen_from_the_west({east});
  EXPECT_EQ(kept.free_volume(), alone.free_volume());
  EXPECT_TRUE(read_again(kept).extent().isApprox(alone.extent()));
  EXPECT_TRUE(kept.known_box().contains(Vector3d(7, 0, 4)));
  const MeasuredUnion without(both(read_again(alone), make_space(east)));
  EXPECT_EQ(without.closest(beyond, 1.0).distance, 0.0);
  const MeasuredUnion with(both(read_again(kept), make_space(east)));
  EXPECT_TRUE(with.is_free(beyond, 1.0));
  EXPECT_FALSE(with.is_free({{7, 0, 4}, {9, 0, 4}}, 0.1));                      // the wall
  EXPECT_FALSE(with.is_free({{-1.75, 5.75, 7.75}, {-1.75, 5.75, 7.75}}, 0.1));  // not visible
  EXPECT_TRUE(with.is_free({{-4, 0, 4}, {7, 0, 4}}, 0.5));                      // between the boxes
}

// In one survey, an extra box is as closed as its own region. Free space equals that of a merged
// region wherever neither region leaves a gap to the hull.
TEST(MeasuredUnion, MatchesMeasuredSpaceOfMergedRegions) {
  const MeasuredSpace extra_boxes = seen_from_the_west({east});
  MeasuredSpace one({.voxel = voxel, .region = west.merged(east)});
  EXPECT_EQ(extra_boxes.closest({{9.5, 5, 1}, {9.5, 5, 2}}, 1.0).kind, ObstacleKind::unknown_space);
  EXPECT_TRUE(seen_from_the_west({}).is_free({{6, 5.5, 7.5}, {6, 5.5, 7.5}}, 0.2));
  const geometry::Camera camera(
      {.width = 96, .height = 64, .horizontal_fov = 1.5, .vertical_fov = 1.1});
  const geometry::Mesh wall = scenes::box({9, -20, -20}, {10, 20, 30});
  one.insert(depth_image(wall, camera, geometry::look_at({-8, 0, 4}, {10, 0, 4})), camera);
  std::mt19937_64 random(5);
  const AlignedBox3d around(Vector3d(-14, -9, -2), Vector3d(14, 9, 11));
  for (int i = 0; i < 500; ++i) {
    const Segment leg{scenes::point_in(random, around), scenes::point_in(random, around)};
    EXPECT_NEAR(extra_boxes.closest(leg, 6.0).distance, one.closest(leg, 6.0).distance, 1e-9);
  }
}

// The box of an unsurveyed target is closed.
TEST(MeasuredUnion, IsUnknownInUnsurveyedRegions) {
  MeasuredSpace a = make_space(west);
  a.declare_free(west);
  const MeasuredUnion together(both(std::move(a), make_space(east)));
  EXPECT_TRUE(together.is_free({{-8, 0, 4}, {-5, 0, 4}}, 1.0));
  EXPECT_FALSE(together.is_free({{-8, 0, 4}, {5, 0, 4}}, 1.0));
  // Assumed free, above both regions.
  EXPECT_TRUE(together.is_free({{-8, 0, 10}, {8, 0, 10}}, 1.0));
  EXPECT_EQ(together.closest({{6, 0, 4}, {6, 0, 4}}, 1.0).kind, ObstacleKind::unknown_space);
}

TEST(MeasuredUnion, IsFreeWhenEmpty) {
  const MeasuredUnion nothing({});
  EXPECT_TRUE(nothing.is_free({{0, 0, 0}, {100, 0, 0}}, 2.0));
  EXPECT_TRUE(nothing.extent().isEmpty());
}

TEST(MeasuredUnion, RejectsSpacesWithoutRegionOrWithOtherVoxelSize) {
  EXPECT_THAT(thrown_message(
                  [] { MeasuredUnion(both(make_space(west), MeasuredSpace({.voxel = voxel}))); }),
              HasSubstr("a measured space without a region cannot be merged"));
  EXPECT_THAT(
      thrown_message([] {
        MeasuredUnion(both(make_space(west), MeasuredSpace({.voxel = 0.25, .region = east})));
      }),
      HasSubstr("measured_space.voxel is 0.25; it must be equal to the voxel size of the space"));
}

}  // namespace
}  // namespace skycap::flight
