#include "survey/volumetric/volumetric_gain.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/sphere_sensor.h"
#include "tests/survey/volumetric/octomap_planning.h"

namespace skycap::survey {
namespace {

using enum volumetric::VolumetricMetric;
using Eigen::Vector3d;
using Eigen::Vector3f;
using geometry::Camera;
using geometry::look_at;
using geometry::View;

const std::vector<volumetric::VolumetricMetric> all_metrics{
    rear_side_voxel, rear_side_entropy, occlusion_aware, unobserved_voxel,
    proximity_count, area_factor,       average_entropy};

const double ln_2 = std::log(2.0);

double entropy(double p) { return -p * std::log(p) - (1.0 - p) * std::log(1.0 - p); }

// Log-odds have single precision, so probabilities and gains are accurate to about 1e-7.
constexpr double single = 1e-6;

TEST(RayPattern, HasPublishedNumberOfRays) {
  const Camera d435({});
  EXPECT_EQ(volumetric::ray_directions(d435, {}).size(), 43U * 25U);
  EXPECT_EQ(volumetric::ray_directions(d435, {0.1, 0.0, 1.0}).size(), 85U * 49U);
  const Camera building({.width = 2400, .height = 1750});
  EXPECT_EQ(volumetric::ray_directions(building, {}).size(), 121U * 88U);
  EXPECT_EQ(volumetric::ray_directions(building, {0.1, 0.0, 1.0}).size(), 241U * 176U);
}

TEST(RayPattern, PassesThroughPixelCentresColumnByColumn) {
  const Camera camera({.width = 100, .height = 50});
  const auto directions = volumetric::ray_directions(camera, {0.1, 0.25, 0.75});
  ASSERT_EQ(directions.size(), 6U * 3U);
  for (std::size_t i = 0; i < directions.size(); ++i) {
    // 12.5 is rounded down to row 12.
    const double column = 25.0 + 10.0 * static_cast<double>(i / 3);
    const double row = std::trunc(12.5 + 10.0 * static_cast<double>(i % 3));
    EXPECT_LT((directions[i] - camera.ray({column, row}).normalized()).norm(), 1e-12);
  }
}

TEST(AreaReward, MatchesCheckValuesOfBothCubics) {
  EXPECT_DOUBLE_EQ(volumetric::area_reward(0.2, 0.2), 1.0);
  EXPECT_DOUBLE_EQ(volumetric::area_reward(0.8, 0.8), 1.0);
  EXPECT_DOUBLE_EQ(volumetric::area_reward(0.1, 0.2), 0.5);
  EXPECT_DOUBLE_EQ(volumetric::area_reward(0.6, 0.2), 0.5);
  EXPECT_DOUBLE_EQ(volumetric::area_reward(0.4, 0.8), 0.5);
  EXPECT_DOUBLE_EQ(volumetric::area_reward(0.9, 0.8), 0.5);
  for (const double target_area : {0.2, 0.8}) {
    EXPECT_DOUBLE_EQ(volumetric::area_reward(0.0, target_area), 0.0);
    EXPECT_DOUBLE_EQ(volumetric::area_reward(1.0, target_area), 0.0);
  }
}

struct Scene {
  Camera camera;
  double resolution;
  double distance;
};

/// A scan of a sphere, and another view far from it on the same orbit.
class AfterOneScan : public testing::TestWithParam<Scene> {
 protected:
  void SetUp() override {
    const Scene& scene = GetParam();
    map_.emplace(scene.resolution, 18.0 * scene.resolution);
    const View first = look_at({scene.distance, 0.0, 0.0}, Vector3d::Zero());
    // The scan is coarser than the rays, to keep the test fast.
    const Camera coarse({.width = 212, .height = 120});
    const tests::Sphere sphere{Vector3d::Zero(), 0.2 * scene.distance};
    map_->insert(first.position.cast<float>(), tests::scan_spheres({sphere}, coarse, first).points);
  }

  double gain(volumetric::VolumetricMetric metric, const View& view) const {
    const Scene& scene = GetParam();
    return volumetric::information_gain(
        metric, *map_, view, volumetric::ray_directions(scene.camera, {}), scene.distance);
  }

  std::optional<volumetric::VolumetricMap> map_;
};

// In unmeasured space the weights are a geometric series of 1/2. The sum is therefore 2 ln 2 per
// ray, independent of what is behind: 1490.27 for the D435's rays, 14761.3 for the building's.
TEST_P(AfterOneScan, DistinguishesViewsOnlyByProximityAndArea) {
  const double rays = static_cast<double>(volumetric::ray_directions(GetParam().camera, {}).size());
  const double distance = GetParam().distance;
  for (const Vector3d& towards :
       {Vector3d(-1, 0, 0), Vector3d(0, 1, 0), Vector3d(0.1, 0.5, -0.8)}) {
    const View view = look_at(distance * towards.normalized(), Vector3d::Zero());
    // Sums of a thousand to ten thousand equal numbers: relative error n eps / 2.
    EXPECT_NEAR(gain(occlusion_aware, view), rays * 2.0 * ln_2, rays * rays * 1e-16);
    EXPECT_NEAR(gain(unobserved_voxel, view), rays * 2.0 * ln_2, rays * rays * 1e-16);
    EXPECT_EQ(gain(rear_side_voxel, view), 0.0);
    EXPECT_EQ(gain(rear_side_entropy, view), 0.0);
    EXPECT_EQ(gain(average_entropy, view), 0.0);
  }
  const View behind = look_at({-distance, 0.0, 0.0}, Vector3d::Zero());
  const View beside = look_at({0.0, distance, 0.0}, Vector3d::Zero());
  EXPECT_NE(gain(proximity_count, behind), gain(proximity_count, beside));
  EXPECT_NE(gain(area_factor, behind), gain(area_factor, beside));
}

INSTANTIATE_TEST_SUITE_P(Sensors, AfterOneScan,
                         testing::Values(Scene{Camera({}), 0.017, 2.3},
                                         Scene{Camera({.width = 2400,
                                                       .height = 1750,
                                                       .horizontal_fov = 1.047,
                                                       .vertical_fov = 0.698}),
                                               0.15, 60.0}));

/// A row of voxels along x, 0.1 m wide, and one ray through them.
class OneRay : public testing::Test {
 protected:
  /// Measures voxel 20 from voxel 10 `hits` times.
  void measure(int hits) {
    for (int i = 0; i < hits; ++i) map_.insert(centre(10), std::vector{centre(20)});
  }
  static Vector3f centre(int voxel) {
    return {0.1F * static_cast<float>(voxel) + 0.05F, 0.05F, 0.05F};
  }

  /// Returns the gain of the ray from voxel `from` through all voxels to `to`.
  double gain(volumetric::VolumetricMetric metric, int from, int to,
              const volumetric::GainSettings& settings = {}) const {
    const Vector3d position = centre(from).cast<double>();
    const double sense = to > from ? 1.0 : -1.0;
    return volumetric::information_gain(metric, map_, {position, {sense, 0.0, 0.0}},
                                        {Vector3d::UnitZ()}, 0.1 * std::abs(to - from), settings);
  }

  volumetric::VolumetricMap map_{0.1, 0.7};  // shadows of six voxels, ceiling 14
};

TEST_F(OneRay, CountsRearSideFromBehindWhenSurfaceIsOccupied) {
  measure(1);
  EXPECT_EQ(gain(rear_side_voxel, 25, 15), 0.0);  // p = 0.7 does not count as occupied
  measure(1);
  EXPECT_EQ(gain(rear_side_voxel, 25, 15), 1.0);
  // Voxels in front of it are only free after four passes.
  EXPECT_EQ(gain(rear_side_voxel, 10, 25), 1.0);
  measure(2);
  EXPECT_EQ(gain(rear_side_voxel, 10, 25), 0.0);
  EXPECT_EQ(gain(rear_side_voxel, 25, 15), 1.0);
}

// Five unmeasured voxels and then the surface, measured twice: V = 1, 1/2, ..., 1/32.
TEST_F(OneRay, SumsRearSideEntropyOfUncertainVoxelsAndSurface) {
  measure(2);
  const double p = 0.49 / (0.49 + 0.09);
  const double expected = ln_2 * (2.0 - 1.0 / 16.0) + entropy(p) / 32.0;
  EXPECT_NEAR(gain(rear_side_entropy, 25, 15), expected, single);
}

TEST_F(OneRay, AppliesEndRuleToRearSideEntropyOfFront) {
  measure(5);
  double visibility = 1.0;
  for (int i = 0; i < 10; ++i) visibility *= 0.12;
  const double expected = visibility * entropy(0.97);
  EXPECT_NEAR(gain(rear_side_entropy, 10, 25), expected, single * expected);
  volumetric::GainSettings published;
  published.rear_side_end = volumetric::RearSideEnd::behind_uncertain;
  EXPECT_EQ(gain(rear_side_entropy, 10, 25, published), 0.0);
}

TEST_F(OneRay, WeighsOcclusionAwareGainByPassedOccupancies) {
  measure(5);  // free voxels at 0.12, surface at 0.97
  for (const auto& [factor, kept] : {std::pair{volumetric::VisibilityFactor::occupancy, 0.12},
                                     {volumetric::VisibilityFactor::freedom, 0.88}}) {
    volumetric::GainSettings settings;
    settings.visibility = factor;
    double expected = 0.0, weight = 1.0;
    for (int i = 0; i < 10; ++i) expected += weight * entropy(0.12), weight *= kept;
    const double with_surface = expected + weight * entropy(0.97);
    EXPECT_NEAR(gain(occlusion_aware, 10, 25, settings), with_surface, single);
    EXPECT_EQ(gain(unobserved_voxel, 10, 25, settings), 0.0);  // no uncertain voxels
  }
}

TEST_F(OneRay, WeighsUnobservedVoxelsByAllVoxelsBeforeThem) {
  measure(5);
  map_.insert({2.05F, 0.05F, 1.05F}, std::vector<Vector3f>{{2.05F, 0.05F, -1.05F}});
  // Six untouched voxels 0 to 5, uncertain only; the ray ends there.
  EXPECT_NEAR(gain(unobserved_voxel, 0, 5), ln_2 * (2.0 - 1.0 / 32.0), 1e-12);
  // Ten untouched voxels, then free space without gain.
  EXPECT_NEAR(gain(unobserved_voxel, 0, 15), ln_2 * (2.0 - 1.0 / 512.0), 1e-12);
}

TEST_F(OneRay, CountsProximityByShadowDepth) {
  measure(1);
  // From behind: depths 6, 5, ..., 1 and the ceiling 14. The end voxel 27 of the shadow is not
  // marked.
  double expected = 0.0;
  for (int depth = 1; depth <= 6; ++depth) expected += 14.0 - depth;
  EXPECT_NEAR(gain(proximity_count, 35, 15), expected, 1e-9);
  EXPECT_EQ(gain(proximity_count, 10, 35), 0.0);  // the surface is in front of them
}

TEST_F(OneRay, AveragesEntropyOfRaysThatEndOnSurface) {
  measure(5);
  const double expected = (10.0 * entropy(0.12) + entropy(0.97)) / 11.0;
  EXPECT_NEAR(gain(average_entropy, 10, 25), expected, single);
  EXPECT_EQ(gain(average_entropy, 10, 18), 0.0);
}

TEST_F(OneRay, ComputesAreaFactorFromFirstVoxelMet) {
  measure(5);
  // Only occupied voxels: the fraction is 1, the target is 0.2, and the reward is zero for both.
  EXPECT_NEAR(gain(area_factor, 10, 25), 0.0, 1e-12);
  // Only unobserved voxels.
  EXPECT_EQ(gain(area_factor, 10, 15), 0.0);
}

// Two rays: one hits the surface from free space, one hits nothing.
TEST_F(OneRay, ComputesAreaFactorOfAllRaysOrHittingRays) {
  measure(5);
  const View view{centre(10).cast<double>(), Vector3d::UnitX()};
  const std::vector<Vector3d> directions{Vector3d::UnitZ(), Vector3d(1.0, 0.0, 0.2).normalized()};
  EXPECT_NEAR(volumetric::information_gain(area_factor, map_, view, directions, 1.6),
              volumetric::area_reward(0.5, 0.2), 1e-12);
  volumetric::GainSettings settings;
  settings.area_share = volumetric::AreaShare::hitting_rays;
  EXPECT_NEAR(volumetric::information_gain(area_factor, map_, view, directions, 1.6, settings), 0.0,
              1e-12);
}

// Independent reference on OctoMap. The sums have a different order: n eps for a thousand rays of
// some hundred voxels.
TEST(InformationGain, MatchesOctoMapReference) {
  const double resolution = 0.04;
  volumetric::VolumetricMap map(resolution, 18.0 * resolution);
  tests::ShadowTree tree(resolution, 18.0 * resolution);
  const Camera camera({.width = 212, .height = 120});
  const std::vector<tests::Sphere> spheres{{{0.0, 0.0, 0.0}, 0.4}, {{0.5, 0.2, 0.1}, 0.2}};
  const std::vector<Vector3d> positions{{2, 0, 0.3},     {1.9, 0.4, 0.2}, {1.8, 0.8, 0.1},
                                        {0.3, 1.9, 0.5}, {1.9, 0.2, 0.4}, {0.4, 2.0, 0.3},
                                        {1.7, 0.9, 0.6}};
  for (const Vector3d& position : positions) {
    const auto scan =
        tests::scan_spheres(spheres, camera, look_at(position, Vector3d::Zero()), 0.005, 3);
    map.insert(scan.sensor_position().cast<float>(), scan.points);
    tree.insert(scan.sensor_position().cast<float>(), scan.points);
  }
  const auto directions = volumetric::ray_directions(Camera({}), {});
  for (const volumetric::VolumetricMetric metric : all_metrics) {
    for (const Vector3d& towards : {Vector3d(1, 0.2, 0.1), Vector3d(-1, 0.3, 0.4),
                                    Vector3d(0.1, 0.2, 1), Vector3d(0.7, 0.7, -0.2)}) {
      const View view = look_at(2.0 * towards.normalized(), Vector3d::Zero());
      const double ours = volumetric::information_gain(metric, map, view, directions, 2.0);
      const double theirs = tree.gain(metric, view, directions, 2.0, false);
      EXPECT_NEAR(ours, theirs, 1e-9 * std::abs(theirs))
          << static_cast<int>(metric) << " from " << towards.transpose();
    }
  }
}

TEST(InformationGain, MatchesUnmeasuredSpaceForEmptyMap) {
  const volumetric::VolumetricMap map(0.1, 1.8);
  const View view = look_at({2.0, 0.0, 0.0}, Vector3d::Zero());
  const auto directions = volumetric::ray_directions(Camera({.width = 64, .height = 48}), {});
  for (const volumetric::VolumetricMetric metric : all_metrics) {
    const double gain = volumetric::information_gain(metric, map, view, directions, 50.0);
    const bool is_sum = metric == occlusion_aware || metric == unobserved_voxel;
    EXPECT_NEAR(gain, is_sum ? 2.0 * ln_2 * static_cast<double>(directions.size()) : 0.0, 1e-9);
  }
}

}  // namespace
}  // namespace skycap::survey
