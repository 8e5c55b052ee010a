#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/random_numbers.h"
#include "survey/pb_nbv/candidate_views.h"
#include "survey/pb_nbv/mixture.h"
#include "survey/pb_nbv/pb_nbv_planner.h"
#include "survey/pb_nbv/voxel_labels.h"
#include "tests/support/sphere_sensor.h"

namespace skycap::survey::pb_nbv {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;
using geometry::Camera;
using geometry::View;

constexpr double pi = std::numbers::pi;

ScoreImage image_of(int width, int height, double focal) {
  ScoreImage image;
  image.width = width;
  image.height = height;
  image.calibration << focal, 0.0, 0.5 * (width - 1), 0.0, focal, 0.5 * (height - 1), 0.0, 0.0, 1.0;
  return image;
}

Ellipsoid sphere_at(const Vector3d& centre, double radius) {
  return {centre, radius * radius * Eigen::Matrix3d::Identity()};
}

// A sphere on the axis has a circular image with the area pi f^2 a^2 / (z^2 - a^2).
TEST(Projection, CountsAreaOfSphereOnAxis) {
  const ScoreImage image = image_of(1001, 1001, 800.0);
  for (const double depth : {1.5, 2.0, 4.0}) {
    constexpr double radius = 0.7;
    const double area = pi * 800.0 * 800.0 * radius * radius / (depth * depth - radius * radius);
    for (const Reading reading : {Reading::published, Reading::released}) {
      // The circle is the one image for which the released angle makes no difference.
      const auto pixels = static_cast<double>(count_pixels(
          sphere_at({0.0, 0.0, depth}, radius), Eigen::Isometry3d::Identity(), image, reading));
      EXPECT_NEAR(pixels / area, 1.0, 0.005) << depth;
    }
  }
}

// Twin: a pixel is inside if its ray meets the ellipsoid.
TEST(Projection, CountsPixelsWhoseRayMeetsEllipsoid) {
  geometry::RandomNumbers random(5);
  const ScoreImage image = image_of(160, 90, 87.0);
  for (int repetition = 0; repetition < 30; ++repetition) {
    Eigen::Matrix3d axes;
    for (int i = 0; i < 9; ++i) axes(i / 3, i % 3) = random.between(-0.4, 0.4);
    Vector3d centre;
    centre.x() = random.between(-1.5, 1.5);
    centre.y() = random.between(-1.0, 1.0);
    centre.z() = random.between(1.5, 3.0);
    const Ellipsoid ellipsoid{centre, axes * axes.transpose() + 0.01 * Eigen::Matrix3d::Identity()};
    if (ellipsoid.centre.z() * ellipsoid.centre.z() <= ellipsoid.shape(2, 2)) continue;
    const Eigen::Matrix3d inverse = ellipsoid.shape.inverse();
    std::size_t expected = 0;
    for (int v = 0; v < image.height; ++v) {
      for (int u = 0; u < image.width; ++u) {
        const Vector3d ray((u - 79.5) / 87.0, (v - 44.5) / 87.0, 1.0);
        const double a = ray.dot(inverse * ray), b = ray.dot(inverse * ellipsoid.centre);
        const double c = ellipsoid.centre.dot(inverse * ellipsoid.centre) - 1.0;
        if (b * b - a * c >= 0.0 && b > 0.0) ++expected;
      }
    }
    EXPECT_EQ(count_pixels(ellipsoid, Eigen::Isometry3d::Identity(), image, Reading::published),
              expected)
        << repetition;
  }
}

TEST(Projection, IgnoresEllipsoidsBehindAndAroundCamera) {
  const ScoreImage image = image_of(160, 90, 87.0);
  const auto count = [&](const Ellipsoid& ellipsoid) {
    return count_pixels(ellipsoid, Eigen::Isometry3d::Identity(), image, Reading::published);
  };
  EXPECT_EQ(count(sphere_at({0.0, 0.0, -2.0}, 0.5)), 0U);
  EXPECT_EQ(count(sphere_at({0.0, 0.0, 0.2}, 0.5)), 0U);
  EXPECT_GT(count(sphere_at({0.0, 0.0, 2.0}, 0.5)), 0U);
}

// Minimum-volume ellipsoid of a box: semi-axes are sqrt(3) times half of the edges (John, 1948).
TEST(Enclose, FindsEllipsoidOfBox) {
  const Vector3d half(0.3, 0.1, 0.7), centre(4.0, -2.0, 9.0);
  std::vector<Vector3d> corners;
  for (int i = 0; i < 8; ++i) {
    corners.push_back(centre + Vector3d(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(),
                                        i & 4 ? half.z() : -half.z()));
  }
  const auto ellipsoid = enclose(corners);
  ASSERT_TRUE(ellipsoid);
  EXPECT_LT((ellipsoid->centre - centre).norm(), 1e-9);
  const Eigen::Matrix3d expected = Vector3d(3.0 * half.cwiseAbs2()).asDiagonal();
  EXPECT_LT((ellipsoid->shape - expected).norm(), 1e-9);
}

TEST(Enclose, ContainsPointsWithSmallVolume) {
  geometry::RandomNumbers random(8);
  std::vector<Vector3d> points;
  for (int i = 0; i < 500; ++i) {  // uniform directions on an ellipsoid
    const double x = random.normal(), y = random.normal(), z = random.normal();
    points.push_back(Vector3d(2.0, 1.0, 0.5).cwiseProduct(Vector3d(x, y, z).normalized()));
  }
  const auto ellipsoid = enclose(points);
  ASSERT_TRUE(ellipsoid);
  const Eigen::Matrix3d inverse = ellipsoid->shape.inverse();
  for (const Vector3d& point : points) {
    const Vector3d offset = point - ellipsoid->centre;
    EXPECT_LE(offset.dot(inverse * offset), 1.0 + 1e-9);
  }
  // The points are inside the ellipsoid with the semi-axes 2, 1 and 0.5, so that the minimum volume
  // is at most its volume; the ratio 1.01 of the criterion and the scaling add a few percent.
  EXPECT_LE(std::sqrt(ellipsoid->shape.determinant()), 1.05);
  EXPECT_FALSE(enclose(std::vector<Vector3d>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
}

std::vector<Vector3d> block(const Vector3d& low, int edge, double voxel) {
  std::vector<Vector3d> points;
  for (int i = 0; i < edge * edge * edge; ++i) {
    points.push_back(low + voxel * Vector3d(i % edge, i / edge % edge, i / (edge * edge)));
  }
  return points;
}

TEST(FindClusters, KeepsOneCubeWhole) {
  const auto points = block(Vector3d::Zero(), 6, 0.03);
  EXPECT_EQ(find_clusters(points, 0.03, 10, Reading::published, 1).count, 1U);
}

TEST(FindClusters, SeparatesDistantCubes) {
  auto points = block(Vector3d::Zero(), 5, 0.03);
  const auto second = block({1.0, 0.0, 0.0}, 5, 0.03), third = block({0.0, 2.0, 1.0}, 5, 0.03);
  points.insert(points.end(), second.begin(), second.end());
  points.insert(points.end(), third.begin(), third.end());
  const Clusters clusters = find_clusters(points, 0.03, 10, Reading::published, 1);
  std::set<std::uint32_t> first_numbers, second_numbers, third_numbers;
  for (std::size_t i = 0; i < points.size(); ++i) {
    (i < 125   ? first_numbers
     : i < 250 ? second_numbers
               : third_numbers)
        .insert(clusters.component[i]);
  }
  EXPECT_EQ(clusters.count, first_numbers.size() + second_numbers.size() + third_numbers.size());
  EXPECT_GE(clusters.count, 3U);
}

TEST(FindClusters, LimitsComponentsOfFewPoints) {
  const auto points = block(Vector3d::Zero(), 2, 0.03);
  EXPECT_EQ(find_clusters(std::span(points).first(3), 0.03, 10, Reading::published, 1).count, 1U);
  EXPECT_LE(find_clusters(points, 0.03, 10, Reading::published, 1).count, 4U);
  EXPECT_EQ(find_clusters({}, 0.03, 10, Reading::published, 1).count, 0U);
}

// Brute force: dense samples along each ray.
TEST(VoxelLabels, WalkVisitsVoxelsOfRay) {
  geometry::RandomNumbers random(3);
  for (int repetition = 0; repetition < 50; ++repetition) {
    Vector3d origin, direction;
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = random.between(-1.0, 1.0);
      direction[axis] = random.between(-1.0, 1.0);
    }
    std::vector<Vector3i> walked;
    walk_ray(origin, direction, 0.5, 2.5, 0.1, [&](const Vector3i& index) {
      walked.push_back(index);
      return true;
    });
    std::vector<Vector3i> sampled;
    for (int i = 1; i < 200'000; ++i) {
      const Vector3d point = origin + (0.5 + 1e-5 * i) * direction;
      const Vector3i index = (point / 0.1).array().floor().cast<int>();
      if (sampled.empty() || sampled.back() != index) sampled.push_back(index);
    }
    // A corner that a ray cuts by less than the sample distance may be missing among the samples.
    std::size_t at = 0;
    for (const Vector3i& index : sampled) {
      while (at < walked.size() && walked[at] != index) ++at;
      ASSERT_LT(at, walked.size()) << repetition;
    }
    EXPECT_LE(walked.size(), sampled.size() + 2);
  }
}

TEST(VoxelLabels, LabelsInFrontAndBehindOfOccupied) {
  VoxelLabels labels(1.0);
  labels.set({5, 0, 0}, Label::occupied);
  const Vector3d origin(-1.0, 0.5, 0.5), along = Vector3d::UnitX();
  labels.insert_ray(origin, along, {1.0, 10.5});
  EXPECT_EQ(labels.at({0, 0, 0}), Label::empty);
  EXPECT_EQ(labels.at({4, 0, 0}), Label::empty);
  EXPECT_EQ(labels.at({5, 0, 0}), Label::occupied);
  EXPECT_EQ(labels.at({6, 0, 0}), Label::unknown);
  EXPECT_EQ(labels.at({9, 0, 0}), Label::unknown);
  EXPECT_EQ(labels.at({10, 0, 0}), Label::none);  // outside the interval
  // From the other side the space behind becomes empty, and never unknown again.
  labels.insert_ray({12.0, 0.5, 0.5}, -along, {1.0, 11.5});
  EXPECT_EQ(labels.at({6, 0, 0}), Label::empty);
  EXPECT_EQ(labels.at({4, 0, 0}), Label::empty);
  labels.insert_ray(origin, along, {1.0, 10.5});
  EXPECT_EQ(labels.at({6, 0, 0}), Label::empty);
}

TEST(VoxelLabels, FindsFrontiersBetweenEmptyAndOccupied) {
  VoxelLabels labels(1.0);
  labels.set({0, 0, 0}, Label::occupied);
  labels.set({1, 0, 0}, Label::unknown);
  labels.set({3, 0, 0}, Label::unknown);
  EXPECT_TRUE(labels.frontiers().empty());
  labels.set({1, 1, 1}, Label::empty);
  ASSERT_EQ(labels.frontiers().size(), 1U);
  EXPECT_EQ(labels.frontiers().front(), Vector3i(1, 0, 0));
}

TEST(CandidateDirections, AreAsManyAsPublished) {
  PbNbvSettings settings;
  const auto sphere = make_candidate_directions(settings);
  EXPECT_EQ(sphere.size(), 800U);
  settings.region = Region::hemisphere;
  for (const Vector3d& direction : make_candidate_directions(settings)) {
    EXPECT_NEAR(direction.norm(), 1.0, 1e-12);
    EXPECT_GT(direction.z(), 0.0);
  }
}

// With four sectors the first four views are in four sectors, and the fifth is free.
TEST(SectorRule, VisitsSectorsFromBothSides) {
  SectorRule rule(4, 0.3);
  EXPECT_EQ(rule.sector(0.3), 0U);
  EXPECT_EQ(rule.sector(0.3 + 0.5 * pi), 1U);
  EXPECT_EQ(rule.sector(0.3 - 0.5 * pi), 3U);
  EXPECT_FALSE(rule.admits(0));
  EXPECT_TRUE(rule.admits(1));
  EXPECT_FALSE(rule.admits(2));
  EXPECT_TRUE(rule.admits(3));
  rule.visit(3);
  EXPECT_TRUE(rule.admits(2));
  EXPECT_TRUE(rule.admits(1));
  rule.visit(2);
  EXPECT_FALSE(rule.is_complete());
  EXPECT_TRUE(rule.admits(1));
  EXPECT_FALSE(rule.admits(2));
  rule.visit(1);
  EXPECT_TRUE(rule.is_complete());
  EXPECT_TRUE(rule.admits(0));
  EXPECT_TRUE(SectorRule(1, 0.0).is_complete());
}

// Two equal ellipsoids in a row have the weights 1 and 1/2; swapping the classes changes the sign.
TEST(Score, WeighsByRankInDepth) {
  const ScoreImage image = image_of(1001, 1001, 800.0);
  const View view{Vector3d::Zero(), Vector3d::UnitX()};
  const Ellipsoid near = sphere_at({3.0, 0.0, 0.0}, 0.5), far = sphere_at({5.0, 0.0, 0.0}, 0.5);
  const auto area = [&](const Ellipsoid& one) {
    return static_cast<double>(
        count_pixels(one, geometry::camera_pose(view).inverse(), image, Reading::published));
  };
  const std::vector<ScoredEllipsoid> first{{far, false}, {near, true}};
  const std::vector<ScoredEllipsoid> swapped{{far, true}, {near, false}};
  const double score = compute_score(first, view, image, Reading::published);
  EXPECT_DOUBLE_EQ(score, area(near) - 0.5 * area(far));
  EXPECT_DOUBLE_EQ(compute_score(swapped, view, image, Reading::published), -score);
}

// Three ellipsoids whose order by depth is a cycle of three: the released code takes the order as
// the rank, so that each weight is that of another ellipsoid.
TEST(Score, UsesOrderAsRankInReleasedReading) {
  const ScoreImage image = image_of(1001, 1001, 800.0);
  const View view{Vector3d::Zero(), Vector3d::UnitX()};
  const std::vector<ScoredEllipsoid> ellipsoids{{sphere_at({7.0, 0.0, 0.0}, 0.5), true},
                                                {sphere_at({3.0, 0.0, 0.0}, 0.5), true},
                                                {sphere_at({5.0, 0.0, 0.0}, 0.5), true}};
  std::vector<double> areas;
  for (const ScoredEllipsoid& one : ellipsoids) {
    areas.push_back(static_cast<double>(count_pixels(
        one.ellipsoid, geometry::camera_pose(view).inverse(), image, Reading::published)));
  }
  EXPECT_DOUBLE_EQ(compute_score(ellipsoids, view, image, Reading::published),
                   areas[0] / 4.0 + areas[1] + areas[2] / 2.0);
  EXPECT_DOUBLE_EQ(compute_score(ellipsoids, view, image, Reading::released),
                   areas[0] / 2.0 + areas[1] / 4.0 + areas[2]);
}

/// Returns settings with few voxels, candidates and ellipsoids, so that the tests are fast under
/// sanitizers.
PbNbvConfig quick_config() {
  PbNbvConfig config;
  config.settings.voxel = 0.1;
  config.settings.candidates = 200;
  config.settings.parallels = 12;
  config.settings.max_ellipsoids = 6;
  config.view_distance = 1.5;
  config.spacing = 0.02;
  config.seed = 7;
  return config;
}

std::vector<View> survey(const PbNbvConfig& config, std::size_t count) {
  const Camera camera({.width = 106, .height = 60});
  PbNbvPlanner planner(config, camera);
  std::vector<View> views;
  std::optional<View> view = geometry::look_at({2.0, 0.0, 0.0}, Vector3d::Zero());
  while (view && views.size() < count) {
    views.push_back(*view);
    const std::vector<tests::Sphere> spheres{{{0, 0, 0}, 0.4}, {{0.4, 0.3, 0.1}, 0.25}};
    view = planner.next_view(tests::scan_spheres(spheres, camera, *view, 0.0, views.size()));
  }
  return views;
}

TEST(PbNbvPlanner, VisitsFourSectorsWithFirstFourViews) {
  const auto views = survey(quick_config(), 8);
  ASSERT_EQ(views.size(), 8U);
  std::set<int> quadrants;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vector3d away = -views[i].direction;
    quadrants.insert(
        static_cast<int>(std::floor(std::atan2(away.y(), away.x()) / (0.5 * pi) + 0.5 + 4.0)) % 4);
  }
  EXPECT_EQ(quadrants.size(), 4U);
}

TEST(PbNbvPlanner, PlansSameViewsForAnyThreadCount) {
  for (const Reading reading : {Reading::published, Reading::released}) {
    PbNbvConfig config = quick_config();
    config.reading = reading;
    const auto alone = survey(config, 5);
    config.threads = 3;
    const auto together = survey(config, 5);
    ASSERT_EQ(alone.size(), together.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      EXPECT_EQ(alone[i].position, together[i].position) << i;
    }
  }
}

TEST(PbNbvPlanner, NeverRepeatsViewsAndKeepsLimits) {
  PbNbvConfig config = quick_config();
  config.limits.min_height = 0.3;
  const auto views = survey(config, 10);
  ASSERT_EQ(views.size(), 10U);
  for (std::size_t i = 1; i < views.size(); ++i) {
    EXPECT_GE(views[i].position.z(), 0.3);
    for (std::size_t j = 1; j < i; ++j) {
      EXPECT_GT((views[i].direction - views[j].direction).norm(), 1e-6);
    }
  }
}

TEST(PbNbvPlanner, DrawsViewsWithoutEllipsoids) {
  PbNbvConfig config = quick_config();
  config.settings.max_ellipsoids = 0;
  const auto views = survey(config, 6);
  config.seed = 8;
  const auto others = survey(config, 6);
  ASSERT_EQ(views.size(), 6U);
  EXPECT_NE(views.back().position, others.back().position);
}

}  // namespace
}  // namespace skycap::survey::pb_nbv
