#include "missions/evaluation/reliability.h"

#include <cmath>

#include <gtest/gtest.h>

namespace skycap::missions::evaluation {
namespace {

using survey::surfel::EstimatedPatch;
using survey::surfel::MissingReason;

EstimatedPatch patch_at(float x, float normal_z, float covered_share) {
  return {{x, 0, 0}, {0, 0, normal_z}, 1.0F, covered_share, MissingReason::none};
}

geometry::SurfaceSamples samples_at(std::initializer_list<float> positions) {
  geometry::SurfaceSamples samples;
  for (const float x : positions) {
    samples.points.emplace_back(x, 0.0F, 0.0F);
    samples.normals.emplace_back(0.0F, 0.0F, 1.0F);
  }
  return samples;
}

// The two sides of a thin wall have different estimates. One sample is beyond all patches, and one
// does not count.
TEST(Reliability, UsesNearestPatchWithSameOrientation) {
  const std::vector<EstimatedPatch> estimate{
      patch_at(0.0F, 1.0F, 0.25F), patch_at(0.0F, -1.0F, 0.95F), patch_at(4.0F, 1.0F, 0.95F)};
  const auto samples = samples_at({0.0F, 0.1F, 0.2F, 0.3F, 4.1F, 9.0F, 4.2F});
  const std::vector<std::uint8_t> is_covered{1, 0, 0, 0, 1, 1, 0}, counts{1, 1, 1, 1, 1, 1, 0};
  const Reliability found = reliability(estimate, samples, is_covered, counts, 0.5);

  EXPECT_NEAR(found.bands[2].estimated, 0.25, 1e-6);
  EXPECT_NEAR(found.bands[2].covered, 0.25, 1e-12);
  EXPECT_NEAR(found.bands[2].share, 4.0 / 6.0, 1e-12);
  EXPECT_NEAR(found.bands[9].estimated, 0.95, 1e-6);
  EXPECT_EQ(found.bands[9].covered, 1.0);
  EXPECT_NEAR(found.unknown_share, 1.0 / 6.0, 1e-12);
  EXPECT_EQ(found.unknown_covered, 1.0);
  EXPECT_NEAR(found.error, (0.05) / 5.0, 1e-6);
}

// Calibrated probabilities have no error. Full certainty has the error of its wrong estimates.
TEST(Reliability, HasNoErrorForCalibratedProbabilities) {
  std::vector<EstimatedPatch> estimate, sure;
  geometry::SurfaceSamples samples;
  std::vector<std::uint8_t> is_covered;
  for (int position = 0; position < 1000; ++position) {
    const auto x = static_cast<float>(position);
    // Covered if (position / 10) % 10 < tenth: a fraction of tenth / 10.
    const int tenth = position % 10;
    estimate.push_back(patch_at(x, 1.0F, static_cast<float>(tenth) / 10.0F + 1e-4F));
    sure.push_back(patch_at(x, 1.0F, 1.0F));
    samples.points.emplace_back(x, 0.0F, 0.0F);
    samples.normals.emplace_back(0.0F, 0.0F, 1.0F);
    is_covered.push_back((position / 10) % 10 < tenth ? 1 : 0);
  }
  EXPECT_NEAR(reliability(estimate, samples, is_covered, {}, 0.4).error, 0.0, 2e-4);
  EXPECT_NEAR(reliability(sure, samples, is_covered, {}, 0.4).error, 0.55, 1e-6);
}

TEST(Reliability, IsZeroWithoutPatches) {
  const Reliability found = reliability({}, {}, {}, {}, 1.0);
  EXPECT_EQ(found.error, 0.0);
  EXPECT_EQ(found.unknown_share, 0.0);
}

}  // namespace
}  // namespace skycap::missions::evaluation
