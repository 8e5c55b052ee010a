#include "survey/surfel/surfel_map.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/sphere_sensor.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using std::numbers::pi;

const geometry::Camera camera{geometry::CameraConfig{}};
const std::vector<tests::Sphere> ball = {{}};
constexpr float spacing = 0.02F;
constexpr float jump = 0.06F;

surfel::BlockImage image_from(const Vector3d& viewpoint, double sigma = 0.0,
                              std::uint64_t seed = 1) {
  return surfel::make_block_image(
      tests::scan_spheres(ball, camera, geometry::look_at(viewpoint, {0, 0, 0}), sigma, seed),
      camera, {.block_px = 4, .jump = jump});
}

// With views from all sides, the total area of the surfels is that of the sphere. 15% allow for
// packing and outlines.
TEST(SurfelMap, HasTotalAreaOfSurface) {
  surfel::SurfelMap map(spacing);
  const surfel::CoverageModel coverage_model(0.005, {});
  for (const Vector3d& viewpoint : {Vector3d(2, 0, 0), Vector3d(-2, 0, 0), Vector3d(0, 2, 0),
                                    Vector3d(0, -2, 0), Vector3d(0, 0, 2), Vector3d(0, 0, -2)}) {
    map.add(image_from(viewpoint), coverage_model, jump, std::nullopt);
  }
  EXPECT_NEAR(map.area(), pi, 0.15 * pi);
  EXPECT_GT(map.covered_area() / map.area(), 0.97);  // dense data without noise
}

TEST(SurfelMap, KeepsSurfelSpacingAndOutwardNormals) {
  surfel::SurfelMap map(spacing);
  map.add(image_from({2, 0, 0}), surfel::CoverageModel(0.005, {}), jump, std::nullopt);
  const surfel::Surfels& surfels = map.surfels();
  ASSERT_GT(surfels.size(), 500U);
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    EXPECT_GT(surfels.normals[i].dot(surfels.positions[i]), 0.0F);
    for (std::size_t j = 0; j < i; ++j) {
      ASSERT_GE((surfels.positions[i] - surfels.positions[j]).norm(), 0.9F * spacing);
    }
  }
}

// A second observation from the same position adds the same hazard as the first, and the coverage
// increases accordingly.
TEST(SurfelMap, AddsHazardsOfObservations) {
  const surfel::CoverageModel coverage_model(0.005, {.isotropic = 0.01});
  surfel::SurfelMap map(spacing);
  map.add(image_from({2, 0, 0}, 0.01, 1), coverage_model, jump, std::nullopt);
  const std::vector<float> after_one = map.surfels().hazards;
  const double covered_after_one = map.covered_area();
  map.add(image_from({2, 0, 0}, 0.01, 2), coverage_model, jump, std::nullopt);
  int tested = 0, doubled = 0;
  for (std::size_t i = 0; i < after_one.size(); ++i) {
    if (map.surfels().positions[i].x() < 0.35F) continue;  // beyond 60 degrees of incidence
    ++tested;
    // The normals of blocks, and therefore the ray densities, are inaccurate by some degrees.
    const float second = map.surfels().hazards[i] - after_one[i];
    doubled += std::abs(second - after_one[i]) < 0.25F * after_one[i] ? 1 : 0;
  }
  EXPECT_GT(tested, 200);
  // Noise moves one of twenty surfels too far off the surface to be hit again.
  EXPECT_GT(doubled, tested * 9 / 10);
  EXPECT_GT(map.covered_area(), covered_after_one);
}

// If surface is observed from one side, only its outline is open.
TEST(SurfelMap, IsOpenOnlyAtOutlineOfObservedSurface) {
  surfel::SurfelMap map(spacing);
  map.add(image_from({2, 0, 0}), surfel::CoverageModel(0.005, {}), jump, std::nullopt);
  const surfel::Surfels& surfels = map.surfels();
  int open_inside = 0, inside = 0, open_outside = 0;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const bool is_open = surfels.open_directions[i] != 0;
    // The outline is where the ray from (2, 0, 0) is tangent: x = 0.125.
    if (surfels.positions[i].x() > 0.27F) {
      ++inside;
      open_inside += is_open ? 1 : 0;
    } else {
      open_outside += is_open ? 1 : 0;
    }
  }
  EXPECT_LT(open_inside, inside / 20);  // random packing leaves a few gaps
  EXPECT_GT(open_outside, 40);          // the outline is 3.0 m long, 150 spacings
}

// Surfels on surface that `is_upper` marks as already measured represent no area, and later scans
// do not change this.
TEST(SurfelMap, AddsNoAreaInGapsOfMeasuredSurface) {
  const auto is_upper = [](const Vector3f& p) { return p.z() > 0.0F; };
  surfel::SurfelMap map(spacing);
  for (const Vector3d& viewpoint : {Vector3d(2, 0, 0), Vector3d(0, 2, 0)}) {
    map.add(image_from(viewpoint), surfel::CoverageModel(0.005, {}), jump, std::nullopt, is_upper);
  }
  const surfel::Surfels& surfels = map.surfels();
  int upper = 0;
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    EXPECT_EQ(surfels.areas[i] == 0.0F, surfels.positions[i].z() > 0.0F);
    upper += is_upper(surfels.positions[i]) ? 1 : 0;
  }
  EXPECT_GT(upper, 300);
  EXPECT_EQ(map.area_near({0, 0, 0.5F}, 0.2F, 0), 0.0);
  EXPECT_GT(map.area_near({0.5F, 0, -0.05F}, 0.2F, 0), 0.0);
}

// A second observation from the same position finds no new territory. An observation from the other
// side finds as much as the first one, which started without knowledge.
TEST(SurfelMap, CountsNewTerritoryBeyondKnownSurface) {
  const surfel::CoverageModel coverage_model(0.005, {});
  surfel::SurfelMap map(spacing);
  map.add(image_from({2, 0, 0}, 0.0, 1), coverage_model, jump, std::nullopt);
  EXPECT_DOUBLE_EQ(map.new_territory(0), map.covered_area());
  const double first_half = map.covered_area();
  std::size_t first = map.surfels().size();
  map.add(image_from({2, 0, 0}, 0.01, 2), coverage_model, jump, std::nullopt);
  EXPECT_LT(map.new_territory(first), 0.005 * first_half);
  first = map.surfels().size();
  map.add(image_from({-2, 0, 0}), coverage_model, jump, std::nullopt);
  EXPECT_NEAR(map.new_territory(first), first_half, 0.05 * first_half);
}

TEST(SurfelMap, IgnoresPointsOutsideRegion) {
  surfel::SurfelMap map(spacing);
  const Eigen::AlignedBox3f upper(Vector3f(-1, -1, 0), Vector3f(1, 1, 1));
  map.add(image_from({2, 0, 0}), surfel::CoverageModel(0.005, {}), jump, upper);
  for (const Vector3f& p : map.surfels().positions) EXPECT_GE(p.z(), -1e-3F);
  EXPECT_GT(map.surfels().size(), 100U);
}

}  // namespace
}  // namespace skycap::survey
