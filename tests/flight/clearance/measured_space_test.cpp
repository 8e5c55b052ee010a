#include "flight/clearance/measured_space.h"

#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <random>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/clearance/free_boundary.h"
#include "flight/paths/path.h"
#include "geometry/error.h"
#include "tests/flight/clearance/ray_sensor.h"
#include "tests/flight/scenes.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using geometry::Camera;
using geometry::look_at;
using testing::HasSubstr;

const Camera small_camera({.width = 96, .height = 64, .horizontal_fov = 1.5, .vertical_fov = 1.1});

/// Returns a room of 20 x 20 x 10 m with a column, observed from inside.
geometry::Mesh room() {
  geometry::Mesh mesh = scenes::box({-10, -10, 0}, {10, 10, 10});
  geometry::append(mesh, scenes::box({2, 2, 0}, {4, 4, 10}));
  return mesh;
}

KnownSpace make_truth(const geometry::Mesh& mesh) {
  Obstacles obstacles;
  obstacles.mesh = mesh;
  obstacles.mesh_is_solid = false;
  return KnownSpace(obstacles);
}

/// Checks the safety property: space that is classified as free keeps the clearance from the ground
/// truth.
void expect_truly_free(const FreeSpace& measured, const FreeSpace& truth, const AlignedBox3d& where,
                       double clearance, int min) {
  std::mt19937_64 random(11);
  int free = 0;
  for (int i = 0; i < 4000; ++i) {
    const Segment leg{scenes::point_in(random, where), scenes::point_in(random, where)};
    const LegVerification verification = verify(measured, leg, clearance, clearance);
    if (!verification.is_verified) continue;
    ++free;
    EXPECT_TRUE(verify(truth, leg, clearance).is_verified)
        << leg.from.transpose() << " to " << leg.to.transpose();
  }
  EXPECT_GT(free, min);  // the check covers enough free space
}

TEST(MeasuredSpace, IsUnknownBeforeFirstScan) {
  const MeasuredSpace space;
  EXPECT_FALSE(space.is_free({{0, 0, 0}, {1, 0, 0}}, 0.0));
  const Closest closest = space.closest({{0, 0, 0}, {1, 0, 0}}, 5.0);
  EXPECT_EQ(closest.kind, ObstacleKind::unknown_space);
  EXPECT_EQ(closest.distance, 0.0);
  EXPECT_THAT(space.name(closest), HasSubstr("unobserved"));
  EXPECT_TRUE(space.extent().isEmpty());
}

TEST(MeasuredSpace, ComputesExactDistancesToDeclaredBoxFaces) {
  MeasuredSpace space({.voxel = 0.25});
  space.declare_free(AlignedBox3d(Vector3d(-4, -4, -4), Vector3d(4, 4, 4)));
  EXPECT_NEAR(space.free_volume(), 512.0, 1e-9);
  EXPECT_NEAR(space.closest({{0, 0, 0}, {1, 0.5, 0}}, 9).distance, 3.0, 1e-12);
  EXPECT_NEAR(space.closest({{-1, 2, 0}, {1, 2, 3.5}}, 9).distance, 0.5, 1e-12);
  EXPECT_EQ(space.closest({{0, 0, 0}, {1, 0, 0}}, 2).kind, ObstacleKind::none);
  EXPECT_FALSE(space.is_free({{0, 0, 0}, {20, 0, 0}}, 0.1));
}

// Volume of the ball, minus at most the voxels that its surface intersects.
TEST(MeasuredSpace, FillsDeclaredBallFromInside) {
  MeasuredSpace space({.voxel = 0.1});
  space.declare_free(Vector3d(0.03, 0.02, 0.01), 2.0);
  const auto ball = [](double radius) { return 4.0 / 3.0 * M_PI * std::pow(radius, 3); };
  EXPECT_LT(space.free_volume(), ball(2.0));
  EXPECT_GT(space.free_volume(), ball(2.0 - 0.1 * std::sqrt(3.0)));
  EXPECT_GT(space.distance(Vector3d(0.03, 0.02, 0.01), 5.0), 2.0 - 0.1 * std::sqrt(3.0));
}

TEST(MeasuredSpace, KeepsFreeSpaceClearOfGroundTruthForDepthImages) {
  const geometry::Mesh scene = room();
  MeasuredSpace space({.voxel = 0.2, .depth_margin = 0.0});
  for (const Vector3d& target : {Vector3d(9, 0, 5), Vector3d(0, 9, 3), Vector3d(9, 9, 7)}) {
    space.insert(depth_image(scene, small_camera, look_at({-7, -7, 5}, target)), small_camera);
    space.insert(depth_image(scene, small_camera, look_at({7, -7, 4}, -target)), small_camera);
  }
  expect_truly_free(space, make_truth(scene), AlignedBox3d(Vector3d(-9, -9, 1), Vector3d(9, 9, 9)),
                    0.5, 30);
}

TEST(MeasuredSpace, EndsFreeSpaceBeforeTheMeasuredSurfaceByTheDepthMargin) {
  const geometry::Mesh scene = room();
  for (const double margin : {0.1, 1.0, 2.0}) {
    MeasuredSpace space({.voxel = 0.2, .depth_margin = margin});
    space.insert(depth_image(scene, small_camera, look_at({-7, 0, 5}, {9, 0, 5})), small_camera);
    const auto is_free = [&](double from_wall) {
      const Vector3d position(10.0 - from_wall, 0.1, 5.1);
      return space.is_free({position, position}, 0.01);
    };
    EXPECT_FALSE(is_free(0.9 * margin)) << margin;
    EXPECT_TRUE(is_free(margin + 0.8)) << margin;
  }
}

TEST(MeasuredSpace, DoesNotDependOnThreadCount) {
  const geometry::Mesh scene = room();
  const auto known_on = [&](unsigned threads) {
    MeasuredSpace space({.voxel = 0.1});
    for (const Vector3d& target : {Vector3d(9, 0, 5), Vector3d(9, 9, 7)}) {
      space.insert(depth_image(scene, small_camera, look_at({-7, -7, 5}, target)), small_camera,
                   threads);
    }
    space.insert(scan_around(scene, {5, -5, 5}, 0.01), SweepRays{.spacing = 0.02}, threads);
    std::ostringstream file;
    space.write(file);
    return file.str();
  };
  const std::string alone = known_on(1);
  EXPECT_GT(alone.size(), 100'000U);
  EXPECT_EQ(known_on(3), alone);
}

TEST(MeasuredSpace, KeepsFreeSpaceClearOfGroundTruthForSweeps) {
  const geometry::Mesh scene = room();
  MeasuredSpace space({.voxel = 0.2, .depth_margin = 0.0});
  constexpr double spacing = 0.02;
  space.insert(scan_around(scene, {-5, -5, 5}, spacing * 0.99), spacing);
  const KnownSpace truth = make_truth(scene);
  expect_truly_free(space, truth, AlignedBox3d(Vector3d(-9, -9, 1), Vector3d(9, 9, 9)), 0.5, 30);
  // The space behind the column is unknown. The space next to it is free.
  EXPECT_FALSE(space.is_free({{8, 8, 5}, {8, 8, 5}}, 0.1));
  EXPECT_TRUE(space.is_free({{-8, 8, 5}, {-7, 8, 5}}, 0.5));
}

// During a revolution in flight, rays start up to `spread` from the position that is assigned to
// the scan.
TEST(MeasuredSpace, KeepsFreeSpaceClearOfGroundTruthForSpreadRayOrigins) {
  const geometry::Mesh scene = room();
  constexpr double spacing = 0.02, spread = 0.6;
  MeasuredSpace spread_out({.voxel = 0.2, .depth_margin = 0.0}),
      exact = MeasuredSpace({.voxel = 0.2, .depth_margin = 0.0});
  for (const Vector3d& beside : {Vector3d(spread, 0, 0), Vector3d(0, -spread, 0)}) {
    geometry::Scan scan = scan_around(scene, Vector3d(-5, -5, 5) + beside, spacing * 0.9);
    exact.insert(scan, spacing);
    scan.world_from_sensor.translation() = Vector3d(-5, -5, 5);
    spread_out.insert(scan, SweepRays{.spacing = spacing, .origin_spread = spread});
  }
  expect_truly_free(spread_out, make_truth(scene),
                    AlignedBox3d(Vector3d(-9, -9, 1), Vector3d(9, 9, 9)), 0.5, 30);
  EXPECT_LT(spread_out.free_volume(), exact.free_volume());
}

// The axis of the revolution has no effect if the rays have the same density in all directions.
TEST(MeasuredSpace, KeepsFreeSpaceClearOfGroundTruthForAnySweepAxis) {
  const geometry::Mesh scene = room();
  for (const Vector3d& axis : {Vector3d(1, 0, 0), Vector3d(0, 0, 1), Vector3d(1, 2, -2)}) {
    MeasuredSpace space({.voxel = 0.2, .depth_margin = 0.0});
    space.insert(scan_around(scene, {-5, -5, 5}, 0.01), SweepRays{.spacing = 0.02, .axis = axis});
    expect_truly_free(space, make_truth(scene),
                      AlignedBox3d(Vector3d(-9, -9, 1), Vector3d(9, 9, 9)), 0.5, 30);
    EXPECT_FALSE(space.is_free({{8, 8, 5}, {8, 8, 5}}, 0.1));
  }
}

// A ball in front of a wall is free if rays hit the wall everywhere. It is unknown if a cell in its
// centre or next to its rim contains no ray, although all rays end far behind it.
TEST(MeasuredSpace, TreatsScatteredRayCellsNextToGapsAsUnknown) {
  const auto space_with_hole = [](double hole_at) {
    geometry::Scan scan;  // rays around the z axis
    for (int i = -100; i < 100; ++i) {
      for (int j = -100; j < 100; ++j) {
        const double x = 0.05 * i, y = 0.05 * j;
        if (std::hypot(x - hole_at, y) > 0.4) scan.points.emplace_back(x, y, 10.0);
      }
    }
    MeasuredSpace space({.voxel = 0.2, .depth_margin = 0.0});
    space.insert(scan, SweepRays{.spacing = 0.02, .is_scattered = true});
    return space;
  };
  const Segment ahead{{0, 0, 4.9}, {0, 0, 5.1}};
  EXPECT_TRUE(space_with_hole(3.0).is_free(ahead, 0.3));
  EXPECT_FALSE(space_with_hole(0.0).is_free(ahead, 0.3));
  EXPECT_FALSE(space_with_hole(1.0).is_free(ahead, 0.3));
  // At the border of the ray pattern, known space ends at least two cells inside.
  EXPECT_FALSE(space_with_hole(3.0).is_free({{-2.4, 0, 5}, {-2.4, 0, 5}}, 0.05));
}

TEST(MeasuredSpace, TreatsNoReturnPixelsAsFreeOnlyWhenConfigured) {
  const geometry::Mesh wall = scenes::box({10, -2, -2}, {11, 2, 2});  // covers half of the image
  const geometry::Scan scan = depth_image(wall, small_camera, look_at({0, 0, 0}, {10, 0, 0}));
  const Segment beside_the_wall{{11, 5, 0}, {12, 5, 0}}, before_it{{7.5, 0, 0}, {8.5, 0, 0}};
  MeasuredSpace wary, trusting({.free_without_return = 20.0});
  wary.insert(scan, small_camera);
  trusting.insert(scan, small_camera);
  EXPECT_TRUE(wary.is_free(before_it, 0.5));
  EXPECT_FALSE(wary.is_free(beside_the_wall, 0.5));
  EXPECT_TRUE(trusting.is_free(beside_the_wall, 0.5));
  EXPECT_FALSE(trusting.is_free({{12, 0, 0}, {13, 0, 0}}, 0.1));  // behind the wall
  EXPECT_FALSE(trusting.is_free({{25, 5, 0}, {26, 5, 0}}, 0.1));  // beyond the trusted range
  EXPECT_FALSE(trusting.is_free({{-2, 0, 0}, {-1, 0, 0}}, 0.1));  // behind the camera
}

TEST(MeasuredSpace, KeepsMeasuredPointsOccupiedAfterLaterScans) {
  MeasuredSpace space({.voxel = 0.25, .free_without_return = 30.0});
  const geometry::Mesh wall = scenes::box({10, -20, -20}, {11, 20, 20});
  space.insert(depth_image(wall, small_camera, look_at({0, 0, 0}, {10, 0, 0})), small_camera);
  geometry::Scan empty;
  empty.world_from_sensor = geometry::camera_pose(look_at({0, 0, 0}, {10, 0, 0}));
  space.insert(empty, small_camera);  // a scan without the wall
  const Closest closest = space.closest({{9, 0, 0}, {9, 1, 0}}, 5);
  EXPECT_EQ(closest.kind, ObstacleKind::occupied_space);
  EXPECT_NEAR(closest.distance, 1.0, 0.25);  // distance to the voxel with the points of the wall
}

// The far side of the building has an unobserved extension. A path in the observed space never
// touches the ground truth, although a straight path around the visible side would.
TEST(MeasuredSpace, KeepsPathsClearOfUnobservedSideOfBuilding) {
  geometry::Mesh building = scenes::box({-5, -5, 0}, {5, 5, 10});
  geometry::append(building, scenes::box({-9, 5, 0}, {9, 16, 10}));  // unobserved extension
  geometry::append(building, scenes::box({-60, -60, -1}, {60, 60, 0}));
  const KnownSpace truth = make_truth(building);
  MeasuredSpace space({.voxel = 0.3, .free_without_return = 25.0});
  constexpr double clearance = 1.0;
  Vector3d position(0, -20, 6);
  space.declare_free(position, 4.0);

  int reached = 0;
  std::mt19937_64 random(2);
  for (int step = 0; step < 16; ++step) {
    // Measure from a ring around the building, then try to reach random positions.
    for (const double turn : {-1.2, 0.0, 1.2}) {
      const double bearing = std::atan2(-position.y(), -position.x()) + turn;
      const Vector3d target = position + Vector3d(std::cos(bearing), std::sin(bearing), 0);
      space.insert(depth_image(building, small_camera, look_at(position, target)), small_camera);
    }
    PathFinder finder(space, clearance);
    const Vector3d goal =
        scenes::point_in(random, AlignedBox3d(Vector3d(-25, -25, 3), Vector3d(25, 25, 9)));
    const Path path = finder.find(position, goal);
    if (path.status != PathStatus::found) continue;
    for (std::size_t i = 1; i < path.points.size(); ++i) {
      EXPECT_TRUE(verify(truth, {path.points[i - 1], path.points[i]}, clearance).is_verified);
    }
    position = goal;
    ++reached;
  }
  EXPECT_GT(reached, 3);
}

MeasuredSpace space_with_region() {
  MeasuredSpace space({.voxel = 0.25,
                       .free_without_return = 0.0,
                       .region = AlignedBox3d(Vector3d(-6.1, -6, -1), Vector3d(6, 6, 11))});
  geometry::Mesh building = scenes::box({-5, -5, 0}, {5, 5, 10});
  geometry::append(building, scenes::box({-1, -21, 0}, {1, -20, 10}));  // outside the region
  for (const Vector3d& position : {Vector3d(-15, -9, 5), Vector3d(12, -12, 6)}) {
    space.insert(depth_image(building, small_camera, look_at(position, Vector3d(0, -8, 5))),
                 small_camera);
  }
  return space;
}

TEST(MeasuredSpace, TreatsSpaceOutsideRegionAsFreeExceptMeasuredPoints) {
  const MeasuredSpace space = space_with_region();
  // Around the region, on its unobserved side.
  EXPECT_TRUE(space.is_free({{-20, 20, 5}, {20, 20, 5}}, 10.0));
  const Closest unobserved = space.closest({{-20, 10, 5}, {20, 10, 5}}, 9.0);
  EXPECT_EQ(unobserved.kind, ObstacleKind::unknown_space);
  EXPECT_NEAR(unobserved.distance, 4.0,
              1e-9);  // to the region's face at y = 6, which is a voxel boundary
  const Closest grown = space.closest({{-10, 3, 5}, {-10, 4, 5}}, 9.0);
  EXPECT_NEAR(grown.distance, 10 - 6.25, 1e-9);  // x = -6.1 is extended to the next voxel boundary
  const Closest pillar = space.closest({{-3, -19, 5}, {3, -19, 5}}, 3.0);
  EXPECT_EQ(pillar.kind, ObstacleKind::occupied_space);
  EXPECT_NEAR(pillar.distance, 1.0, 0.25);
  EXPECT_FALSE(space.is_free({{0, 0, 5}, {0, 1, 5}}, 0.0));
  EXPECT_GT(space.free_volume(), 1.0);
}

TEST(MeasuredSpace, DiscardsPointsBelowFloor) {
  geometry::Scan scan;
  scan.world_from_sensor.translation() = Vector3d(0, 0, 10);
  scan.points = {{0, 0, 0.1F}, {3, 0, 0.3F}};
  MeasuredSpace space(
      {.region = AlignedBox3d(Vector3d(-1, -1, 5), Vector3d(1, 1, 6)), .floor = 0.2});
  space.insert(scan, 0.1);
  EXPECT_EQ(space.closest({{-9, 0, 1}, {-8, 0, 1}}, 20).kind, ObstacleKind::unknown_space);
  EXPECT_EQ(space.closest({{3, 0, 1}, {4, 0, 1}}, 2).kind, ObstacleKind::occupied_space);
  EXPECT_GT(space.closest({{0, 0, 1}, {0, 0, 1}}, 20).distance, 2.0);
}

std::vector<Eigen::Vector3f> collect_boundary(const MeasuredSpace& space) {
  std::stringstream file;
  space.write(file);
  return free_boundary(file, "file");
}

/// Returns how often each face of a voxel box was found, by the centre of the face in half voxels.
std::map<std::array<int, 3>, int> counted(const std::vector<Eigen::Vector3f>& faces, double voxel) {
  std::map<std::array<int, 3>, int> counts;
  for (const Eigen::Vector3f& face : faces) {
    const Eigen::Vector3i half = (face.cast<double>() * (2.0 / voxel)).array().round().cast<int>();
    ++counts[{half.x(), half.y(), half.z()}];
  }
  return counts;
}

// A box of 9 x 10 x 17 voxels has 2 (90 + 153 + 170) faces. Each is found once, across blocks and
// negative coordinates. A measured voxel inside adds its six faces.
TEST(MeasuredSpace, CollectsEachBoundaryFaceOnce) {
  MeasuredSpace space({.voxel = 0.5});
  EXPECT_TRUE(collect_boundary(space).empty());
  space.declare_free(AlignedBox3d(Vector3d(-2, -1, 3), Vector3d(2.5, 4, 11.5)));
  const auto faces = counted(collect_boundary(space), 0.5);
  EXPECT_EQ(faces.size(), 826U);
  for (const auto& [position, count] : faces) {
    EXPECT_EQ(count, 1);
    const bool is_outer = position[0] == -8 || position[0] == 10 || position[1] == -4 ||
                          position[1] == 16 || position[2] == 12 || position[2] == 46;
    EXPECT_TRUE(is_outer) << position[0] << " " << position[1] << " " << position[2];
  }
  geometry::Scan scan;
  scan.points = {{0.2F, 0.2F, 7.2F}};
  space.insert(scan, 0.1);
  EXPECT_EQ(counted(collect_boundary(space), 0.5).size(), 832U);
}

// Space outside the region is free, so the faces of the region are not boundaries.
TEST(MeasuredSpace, CollectsNoBoundaryFacesAtRegionFaces) {
  MeasuredSpace space({.voxel = 0.5, .region = AlignedBox3d(Vector3d(0, 0, 0), Vector3d(4, 4, 4))});
  space.declare_free(AlignedBox3d(Vector3d(0, 0, 0), Vector3d(2, 4, 4)));
  const std::vector<Eigen::Vector3f> faces = collect_boundary(space);
  EXPECT_EQ(faces.size(), 64U);
  for (const Eigen::Vector3f& face : faces) EXPECT_EQ(face.x(), 2.0F);
}

TEST(MeasuredSpace, RoundTripsThroughFile) {
  const MeasuredSpace space = space_with_region();
  std::stringstream file;
  space.write(file);
  const MeasuredSpace again = MeasuredSpace::read(file, "file");
  EXPECT_EQ(again.free_volume(), space.free_volume());
  EXPECT_TRUE(again.extent().isApprox(space.extent()));
  std::mt19937_64 random(4);
  const AlignedBox3d around(Vector3d(-25, -25, -2), Vector3d(25, 25, 14));
  for (int i = 0; i < 300; ++i) {
    const Segment leg{scenes::point_in(random, around), scenes::point_in(random, around)};
    EXPECT_EQ(again.closest(leg, 5.0).distance, space.closest(leg, 5.0).distance);
  }
  std::stringstream same;
  again.write(same);
  EXPECT_EQ(same.str(), file.str());
}

TEST(MeasuredSpace, RejectsDamagedFilesWithFileName) {
  std::stringstream file;
  space_with_region().write(file);
  const std::string whole = file.str();
  for (const std::string& broken : {std::string(), std::string("solid"), whole.substr(0, 60),
                                    whole.substr(0, whole.size() - 1), whole + "x"}) {
    std::istringstream stream(broken);
    try {
      MeasuredSpace::read(stream, "free.bin");
      ADD_FAILURE() << "accepted " << broken.size() << " bytes";
    } catch (const Error& error) {
      EXPECT_THAT(error.what(), testing::StartsWith("free.bin: "));
    }
  }
}

/// Blocks as large as the Earth.
TEST(MeasuredSpace, RejectsFilesWithBlocksOutOfRange) {
  std::stringstream file;
  space_with_region().write(file);
  for (const double voxel : {1e3, 1e30, 1e300}) {
    std::string hostile = file.str();
    std::memcpy(&hostile[16], &voxel, sizeof voxel);
    hostile.replace(112, 8, 8, '\0');  // the first block key gets its maximum value
    std::istringstream stream(hostile);
    EXPECT_THAT(testing_support::thrown_message([&] { MeasuredSpace::read(stream, "free.bin"); }),
                testing::StartsWith("free.bin: "))
        << voxel;
  }
}

TEST(MeasuredSpace, RejectsInvalidScansAndConfigurations) {
  MeasuredSpace space;
  geometry::Scan scan;
  scan.points = {{1, 0, 0}};
  EXPECT_THAT(testing_support::thrown_message([&] { space.insert(scan, small_camera); }),
              testing::HasSubstr("1 points but 0 pixels"));  // no pixels
  scan.pixels = {96 * 64};
  EXPECT_THAT(testing_support::thrown_message([&] { space.insert(scan, small_camera); }),
              testing::HasSubstr("a scan refers to pixel 6144"));  // one too large
  EXPECT_THAT(testing_support::thrown_message([&] { space.insert(scan, 0.0); }),
              testing::HasSubstr("the ray spacing is 0.0"));
  EXPECT_THAT(testing_support::thrown_message([&] { MeasuredSpace({.voxel = 0.0}); }),
              testing::HasSubstr("measured_space.voxel is 0"));
  EXPECT_THAT(testing_support::thrown_message([&] { MeasuredSpace({.max_depth = std::nan("")}); }),
              testing::HasSubstr("measured_space.max_depth is nan"));
  for (const double coordinate : {std::nan(""), -1e9}) {
    const Eigen::AlignedBox3d region(Eigen::Vector3d(-1, -1, coordinate), Eigen::Vector3d(1, 1, 1));
    EXPECT_THAT(testing_support::thrown_message([&] { MeasuredSpace({.region = region}); }),
                testing::HasSubstr("measured_space.region is "));
  }
}

}  // namespace
}  // namespace skycap::flight
