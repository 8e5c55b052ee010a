#include "survey/surfel/prior_predictions.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "survey/surfel/predicted_surface.h"
#include "tests/support/sphere_sensor.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using State = surfel::PriorPredictions::State;

const geometry::Camera camera{geometry::CameraConfig{}};
const std::vector<tests::Sphere> ball = {{}};
constexpr float spacing = 0.02F;
constexpr float jump = 0.06F;
constexpr double radius = 0.5;  // radius of tests::Sphere

/// Returns points of a Fibonacci lattice on a sphere of the ball's size.
surfel::PriorSurface sphere_at(const Vector3f& centre, float uncertainty) {
  constexpr int count = 40'000;
  surfel::PriorSurface surface;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, r = std::sqrt(1.0 - z * z);
    const Vector3f normal =
        Vector3d(r * std::cos(golden * i), r * std::sin(golden * i), z).cast<float>();
    surface.positions.push_back(centre + static_cast<float>(radius) * normal);
    surface.normals.push_back(normal);
    surface.areas.push_back(static_cast<float>(4.0 * std::numbers::pi * radius * radius / count));
    surface.uncertainties.push_back(uncertainty);
  }
  return surface;
}

struct Knowledge {
  surfel::SurfelMap map{spacing};
  surfel::FreeSpaceHistory space{0.6F * spacing, true};
  void scan_from(const Vector3d& viewpoint) {
    const surfel::BlockImage image = surfel::make_block_image(
        tests::scan_spheres(ball, camera, geometry::look_at(viewpoint, {0, 0, 0})), camera,
        {.block_px = 4, .jump = jump});
    space.add(image, 0.0F);
    map.add(image, surfel::CoverageModel(0.005, {}), jump, std::nullopt);
  }
};

TEST(PriorPredictions, CoverWholeAreaWithPatches) {
  const surfel::PriorPredictions predictions(sphere_at({0, 0, 0}, 0.0F), spacing);
  double area = 0.0;
  for (const surfel::PriorPatch& patch : predictions.patches()) {
    area += patch.area;
    EXPECT_NEAR(patch.position.norm(), radius, 0.1 * spacing);
    EXPECT_GT(patch.normal.dot(patch.position), 0.9 * radius);
  }
  EXPECT_NEAR(area, std::numbers::pi, 1e-3);
  EXPECT_LT(predictions.patches().size(), 40'000U / 2);
}

// Surface visible from +x is found. The far side remains open.
TEST(PriorPredictions, AreFoundWhereMeasured) {
  Knowledge known;
  known.scan_from({2, 0, 0});
  surfel::PriorPredictions predictions(sphere_at({0, 0, 0}, 0.01F), spacing);
  predictions.update(known.map, known.space);
  ASSERT_FALSE(predictions.patches().empty());
  for (std::size_t i = 0; i < predictions.patches().size(); ++i) {
    const float x = predictions.patches()[i].position.x();
    if (x > 0.25F) {
      EXPECT_EQ(predictions.state(i), State::found) << x;
    }
    if (x < 0.0F) {
      EXPECT_EQ(predictions.state(i), State::open) << x;
    }
  }
}

// In the planner's predictions, the observed side is not predicted and the far side is.
TEST(PriorPredictions, ArePredictedOnlyWhereOpen) {
  Knowledge known;
  known.scan_from({2, 0, 0});
  surfel::PredictedSurface predicted({});
  predicted.expect({sphere_at({0, 0, 0}, 0.01F), spacing});
  predicted.predict(known.map, known.space, std::nullopt);
  std::size_t num_predicted = 0;
  for (const surfel::PredictedPatch& patch : predicted.patches()) {
    if (patch.kind != surfel::prior_kind) continue;
    EXPECT_LE(patch.position.x(), 0.25F);
    ++num_predicted;
  }
  EXPECT_GT(num_predicted, 1000U);
}

// A predicted sphere next to the ball does not exist: the sensor sees through it.
TEST(PriorPredictions, AreRefutedWhereSensorSeesThroughThem) {
  Knowledge known;
  known.scan_from({2, 0, 0});
  surfel::PriorPredictions predictions(sphere_at({0.9F, 0.0F, 0.0F}, 0.01F), spacing);
  predictions.update(known.map, known.space);
  std::size_t refuted = 0;
  ASSERT_FALSE(predictions.patches().empty());
  for (std::size_t i = 0; i < predictions.patches().size(); ++i) {
    refuted += predictions.state(i) == State::refuted ? 1 : 0;
    const Vector3f& position = predictions.patches()[i].position;
    if (position.x() > 0.6F && position.x() < 1.2F &&
        position.tail<2>().norm() < 0.15F) {  // in the image, in front of the ball
      EXPECT_EQ(predictions.state(i), State::refuted);
    }
  }
  EXPECT_GT(refuted, 20U);
}

/// Returns the rate of the prior after an observation from +x, graded by all surface that faces it.
double rate_after_observation(const Vector3f& centre) {
  Knowledge known;
  surfel::PredictedSurface predicted({});
  predicted.expect({sphere_at(centre, 0.01F), spacing});
  const double before = predicted.prior_hit_rate();
  EXPECT_GT(before, 0.8);
  predicted.predict(known.map, known.space, std::nullopt);
  std::vector<surfel::PredictedSurface::Expected> expected;
  for (std::uint32_t i = 0; i < predicted.patches().size(); ++i) {
    const surfel::PredictedPatch& patch = predicted.patches()[i];
    if (patch.kind == surfel::prior_kind && patch.normal.x() > 0.7F) expected.push_back({i, 1.0F});
  }
  EXPECT_GT(expected.size(), 20U);
  known.scan_from({2, 0, 0});
  predicted.grade(expected, known.map, known.space, 0);
  return predicted.prior_hit_rate();
}

TEST(PredictedSurface, KeepsCorrectPriorAndDiscardsWrongPrior) {
  EXPECT_GT(rate_after_observation({0, 0, 0}), 0.85);
  EXPECT_LT(rate_after_observation({0.3F, 0.0F, 0.0F}), 0.5);
}

}  // namespace
}  // namespace skycap::survey
