#include "survey/volumetric/volumetric_planner.h"

#include <cmath>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/support/complaint.h"
#include "tests/support/not_empty.h"
#include "tests/support/sphere_sensor.h"
#include "tests/support/stopped_planner.h"

namespace skycap::survey {
namespace {

using enum volumetric::VolumetricMetric;
using Eigen::Vector3d;
using geometry::Camera;
using geometry::look_at;
using geometry::View;
using testing::HasSubstr;

const Camera camera({.width = 106, .height = 60});

volumetric::VolumetricConfig config_for(volumetric::VolumetricMetric metric) {
  volumetric::VolumetricConfig config;
  config.metric = metric;
  config.resolution = 0.05;
  config.spacing = 0.02;
  config.candidates = 24;
  config.sphere_radius = 2.0;
  config.seed = 7;
  return config;
}

/// Returns the views of a survey of two spheres, until no candidates are left.
std::vector<View> surveyed(const volumetric::VolumetricConfig& config) {
  volumetric::VolumetricPlanner planner(config, camera);
  std::vector<View> views;
  std::optional<View> view = look_at({2.0, 0.0, 0.0}, Vector3d::Zero());
  while (view) {
    views.push_back(*view);
    const std::vector<tests::Sphere> spheres{{{0, 0, 0}, 0.4}, {{0.4, 0.3, 0.1}, 0.25}};
    view = planner.next_view(tests::scan_spheres(spheres, camera, *view, 0.01, views.size()));
  }
  return views;
}

double compute_length(const std::vector<View>& views) {
  double length = 0.0;
  for (std::size_t i = 1; i < views.size(); ++i) {
    length += (views[i].position - views[i - 1].position).norm();
  }
  return length;
}

TEST(SelectBest, WeighsGainFractionAgainstDistanceFraction) {
  const std::vector<double> gains{1.0, 3.0}, distances{1.0, 9.0};
  EXPECT_EQ(volumetric::select_best(gains, distances, 0.0, volumetric::TieRule::first),
            1U);  // 0.25 and 0.75
  EXPECT_EQ(volumetric::select_best(gains, distances, 0.5, volumetric::TieRule::first),
            1U);  // 0.20 and 0.30
  EXPECT_EQ(volumetric::select_best(gains, distances, 1.0, volumetric::TieRule::first),
            0U);  // 0.15 and -0.15
}

TEST(SelectBest, UsesDistanceWithoutGainAndGainWithoutDistance) {
  const std::vector<double> none{0.0, 0.0}, some{2.0, 1.0};
  EXPECT_EQ(volumetric::select_best(none, some, 1.0, volumetric::TieRule::first), 1U);
  EXPECT_EQ(volumetric::select_best(some, none, 1.0, volumetric::TieRule::first), 0U);
}

TEST(SelectBest, BreaksTiesByRule) {
  const std::vector<double> gains{1.0, 1.0, 1.0}, distances{3.0, 2.0, 2.0};
  EXPECT_EQ(volumetric::select_best(gains, distances, 0.0, volumetric::TieRule::first), 0U);
  EXPECT_EQ(volumetric::select_best(gains, distances, 0.0, volumetric::TieRule::nearest), 1U);
}

TEST(SphereViews, LookAtCentreFromSphere) {
  const Vector3d centre(1.0, -2.0, 3.0);
  for (const View& view :
       testing_support::not_empty(volumetric::sphere_views(100, centre, 4.0, std::nullopt, 3))) {
    EXPECT_NEAR((view.position - centre).norm(), 4.0, 1e-12);
    EXPECT_LT((view.position + 4.0 * view.direction - centre).norm(), 1e-12);
  }
}

// On a sphere with uniform density, each coordinate is uniform (Archimedes) with mean 0 and
// variance 1/3. The tolerance is five standard deviations for 20,000 views.
TEST(SphereViews, AreUniformlyDistributed) {
  const std::size_t count = 20'000;
  Vector3d mean = Vector3d::Zero(), squares = Vector3d::Zero();
  for (const View& view : volumetric::sphere_views(count, Vector3d::Zero(), 1.0, std::nullopt, 5)) {
    mean += view.position / static_cast<double>(count);
    squares += view.position.cwiseAbs2() / static_cast<double>(count);
  }
  const double n = static_cast<double>(count);
  EXPECT_LT(mean.cwiseAbs().maxCoeff(), 5.0 * std::sqrt(1.0 / 3.0 / n));
  EXPECT_LT((squares.array() - 1.0 / 3.0).abs().maxCoeff(), 5.0 * std::sqrt(4.0 / 45.0 / n));
}

TEST(SphereViews, StayAboveMinHeight) {
  for (const View& view :
       testing_support::not_empty(volumetric::sphere_views(200, Vector3d::Zero(), 2.0, 0.5, 5))) {
    EXPECT_GE(view.position.z(), 0.5);
  }
  EXPECT_THAT(testing_support::thrown_message(
                  [&] { volumetric::sphere_views(10, Vector3d::Zero(), 2.0, 3.0, 5); }),
              testing::HasSubstr("above the minimum height of 3 m"));
}

TEST(VolumetricPlanner, VisitsEveryCandidateOnce) {
  const volumetric::VolumetricConfig config = config_for(proximity_count);
  const std::vector<View> views = surveyed(config);
  ASSERT_EQ(views.size(), 1 + config.candidates);
  for (const View& candidate : testing_support::not_empty(volumetric::sphere_views(
           config.candidates, Vector3d::Zero(), 2.0, std::nullopt, config.seed))) {
    EXPECT_EQ(std::ranges::count(views, candidate.position, &View::position), 1);
  }
}

// If all gains are equal, as for OA and UV between unvisited views, the path length decides. The
// survey is then the nearest-neighbour tour of the candidates.
TEST(VolumetricPlanner, SelectsNearestCandidateWhenGainsTie) {
  volumetric::VolumetricConfig config = config_for(rear_side_voxel);
  config.settings.rays = {1.0, 0.0, 0.01};  // one ray that misses the scene: zero gain everywhere
  const std::vector<View> views = surveyed(config);
  for (std::size_t i = 1; i < views.size(); ++i) {
    const double ray = (views[i].position - views[i - 1].position).norm();
    for (std::size_t later = i + 1; later < views.size(); ++later) {
      EXPECT_LE(ray, (views[later].position - views[i - 1].position).norm());
    }
  }
}

TEST(VolumetricPlanner, DoesNotDependOnThreadCount) {
  for (const volumetric::VolumetricMetric metric :
       {rear_side_voxel, rear_side_entropy, occlusion_aware, unobserved_voxel, proximity_count,
        area_factor, average_entropy}) {
    volumetric::VolumetricConfig config = config_for(metric);
    const std::vector<View> alone = surveyed(config);
    config.threads = 3;
    const std::vector<View> together = surveyed(config);
    ASSERT_EQ(alone.size(), together.size());
    for (std::size_t i = 0; i < alone.size(); ++i) {
      EXPECT_EQ(alone[i].position, together[i].position) << "view " << i;
    }
  }
}

TEST(VolumetricPlanner, StopsWhilePlanningView) {
  volumetric::VolumetricPlanner planner(config_for(occlusion_aware), camera);
  const View view = look_at({2.0, 0.0, 0.0}, Vector3d::Zero());
  const auto scan = tests::scan_spheres({{}}, camera, view, 0.01);
  tests::expect_stop_while_planning(planner, scan);
}

TEST(VolumetricPlanner, TravelsFartherWithoutPathCost) {
  volumetric::VolumetricConfig config = config_for(occlusion_aware);
  const double with_cost = compute_length(surveyed(config));
  config.settings.cost_weight = 0.0;
  EXPECT_GT(compute_length(surveyed(config)), 1.5 * with_cost);
}

TEST(VolumetricPlanner, KeepsPointSpacing) {
  volumetric::VolumetricPlanner planner(config_for(occlusion_aware), camera);
  const View view = look_at({2.0, 0.0, 0.0}, Vector3d::Zero());
  const auto scan = tests::scan_spheres({{}}, camera, view, 0.01);
  planner.next_view(scan);
  const auto& points = planner.cloud().positions;
  EXPECT_EQ(planner.last_step().points_new, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) ASSERT_GT((points[i] - points[j]).norm(), 0.02F - 1e-6F);
  }
  planner.next_view(scan);
  EXPECT_EQ(planner.last_step().points_new, 0U);
}

TEST(VolumetricPlanner, InsertsDownsampledScansWhenConfigured) {
  const View view = look_at({2.0, 0.0, 0.0}, Vector3d::Zero());
  const auto scan = tests::scan_spheres({{}}, camera, view);
  volumetric::VolumetricConfig config = config_for(occlusion_aware);
  const Eigen::Vector3f surface(0.499F, 0.001F, 0.001F);
  for (const bool downsampled : {false, true}) {
    config.settings.downsampled = downsampled;
    volumetric::VolumetricPlanner planner(config, camera);
    planner.next_view(scan);
    planner.next_view(scan);  // adds no points to the cloud
    EXPECT_EQ(planner.map().state_at(surface).kind,
              downsampled ? volumetric::VoxelKind::uncertain : volumetric::VoxelKind::occupied);
  }
}

TEST(VolumetricPlanner, CarvesNoReturnPixelsWhenConfigured) {
  const View view = look_at({2.0, 0.0, 0.0}, Vector3d::Zero());
  const auto scan = tests::scan_spheres({{}}, camera, view);
  volumetric::VolumetricConfig config = config_for(occlusion_aware);
  const Eigen::Vector3f beside(0.6F, 0.7F, 0.0F);  // visible next to the sphere
  for (const bool carves : {false, true}) {
    config.settings.carve_no_returns = carves;
    volumetric::VolumetricPlanner planner(config, camera);
    planner.next_view(scan);
    EXPECT_EQ(planner.map().state_at(beside).kind != volumetric::VoxelKind::untouched, carves);
  }
}

TEST(VolumetricPlanner, IgnoresMeasurementsOutsideSceneBox) {
  volumetric::VolumetricConfig config = config_for(occlusion_aware);
  config.scene_box = Eigen::AlignedBox3d(Vector3d(-1, -1, 0), Vector3d(1, 1, 1));
  volumetric::VolumetricPlanner planner(config, camera);
  planner.next_view(tests::scan_spheres({{}}, camera, look_at({2.0, 0.0, 0.0}, Vector3d::Zero())));
  for (const auto& point : planner.cloud().positions) EXPECT_GE(point.z(), 0.0F);
  EXPECT_EQ(planner.map().state_at({0.45F, 0.0F, -0.2F}).kind, volumetric::VoxelKind::untouched);
}

TEST(VolumetricPlanner, ProposesNextBestForRejectedView) {
  volumetric::VolumetricConfig config = config_for(proximity_count);
  config.candidates = 3;
  volumetric::VolumetricPlanner planner(config, camera);
  const auto scan = tests::scan_spheres({{}}, camera, look_at({2.0, 0.0, 0.0}, Vector3d::Zero()));
  const auto first = planner.next_view(scan);
  const auto second = planner.next_alternative_view();
  ASSERT_TRUE(first && second);
  EXPECT_NE(first->position, second->position);
  EXPECT_TRUE(planner.next_alternative_view());
  EXPECT_FALSE(planner.next_alternative_view());
}

TEST(VolumetricPlanner, RejectsFirstScanWithoutScenePoints) {
  volumetric::VolumetricPlanner planner(config_for(occlusion_aware), camera);
  EXPECT_THAT(testing_support::thrown_message([&] { planner.next_view(geometry::Scan{}); }),
              testing::HasSubstr("the first scan contains no point of the scene"));
}

TEST(VolumetricConfig, ReportsTheInvalidField) {
  const auto message = [](auto change) -> std::string {
    volumetric::VolumetricConfig config = config_for(occlusion_aware);
    change(config);
    try {
      config.validate();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  using Config = volumetric::VolumetricConfig;
  EXPECT_EQ(message([](Config&) {}), "");
  EXPECT_THAT(message([](Config& c) { c.resolution = 0.0; }), HasSubstr("resolution is 0"));
  EXPECT_THAT(message([](Config& c) { c.spacing = -1.0; }), HasSubstr("spacing is -1"));
  EXPECT_THAT(message([](Config& c) { c.sphere_radius = -2.0; }), HasSubstr("sphere_radius is -2"));
  EXPECT_THAT(message([](Config& c) { c.candidates = 0; }), HasSubstr("candidates_per_view"));
  EXPECT_THAT(message([](Config& c) { c.settings.cost_weight = -1.0; }), HasSubstr("cost_weight"));
  EXPECT_THAT(message([](Config& c) { c.settings.ray_depth = 0.0; }), HasSubstr("ray_depth is 0"));
  EXPECT_THAT(message([](Config& c) { c.settings.shadow_length = 300.0; }),
              HasSubstr("shadow_length is 300"));
  EXPECT_THAT(message([](Config& c) { c.settings.rays.rays_per_pixel = 2.0; }),
              HasSubstr("rays_per_pixel is 2"));
  EXPECT_THAT(message([](Config& c) { c.settings.rays.window_begin = 0.9; }),
              HasSubstr("window_begin is 0.9"));
  EXPECT_THAT(message([](Config& c) { c.settings.rays.window_end = 1.5; }),
              HasSubstr("window_end is 1.5"));
}

}  // namespace
}  // namespace skycap::survey
