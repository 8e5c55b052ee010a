#include "missions/batch/benchmark/protocol_g.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::missions {
namespace {

using Eigen::Vector3f;

TEST(ProtocolG, AveragesCoverageOverFirstViews) {
  const std::vector<double> coverage{0.2, 0.6, 0.7};
  EXPECT_DOUBLE_EQ(batch::compute_auc(coverage, 1), 0.2);
  EXPECT_DOUBLE_EQ(batch::compute_auc(coverage, 2), 0.4);
  EXPECT_DOUBLE_EQ(batch::compute_auc(coverage, 5), (0.2 + 0.6 + 3 * 0.7) / 5);
}

// A diagonal of 20 cells; each of its cells has one sample.
TEST(ProtocolG, CountsCellsWithSamples) {
  std::vector<Vector3f> samples, cloud;
  std::vector<std::uint8_t> is_visible;
  for (int i = 0; i <= 20; ++i) {
    const float at = i == 20 ? 20.0F : static_cast<float>(i) + 0.5F * static_cast<float>(i > 0);
    samples.emplace_back(at, at, at);  // the corners 0 and 20 make the box
    is_visible.push_back(i < 10 ? 1 : 0);
  }
  for (int i = 0; i < 5; ++i) cloud.emplace_back(Vector3f::Constant(static_cast<float>(i) + 0.4F));
  cloud.emplace_back(1.5F, 9.5F, 1.5F);     // a cell without a sample
  cloud.emplace_back(30.0F, 30.0F, 30.0F);  // outside the box
  const auto coverage = batch::compute_grid_coverage(cloud, samples, is_visible);
  EXPECT_DOUBLE_EQ(coverage.all, 5.0 / 20.0);
  EXPECT_DOUBLE_EQ(coverage.visible, 5.0 / 10.0);
}

TEST(ProtocolG, MeasuresChamferDistanceOfShiftedPlane) {
  std::vector<Vector3f> plane, shifted;
  for (int i = 0; i < 900; ++i) {
    plane.emplace_back(0.1F * static_cast<float>(i % 30), 0.1F * static_cast<float>(i / 30), 0.0F);
    shifted.push_back(plane.back() + Vector3f(0.0F, 0.0F, 0.03F));
  }
  EXPECT_DOUBLE_EQ(batch::compute_chamfer_distance(plane, plane), 0.0);
  EXPECT_NEAR(batch::compute_chamfer_distance(plane, shifted), 0.03, 1e-6);
  EXPECT_DOUBLE_EQ(batch::compute_chamfer_distance(plane, {}), 0.0);
  // Points within a voxel count once: a cluster of many points has the weight of one.
  std::vector<Vector3f> weighted = shifted;
  for (int i = 0; i < 1000; ++i) weighted.emplace_back(0.0F, 0.0F, 0.001F);
  EXPECT_NEAR(batch::compute_chamfer_distance(plane, weighted),
              0.5 * (900 * 0.03 / 901 + 899 * 0.03 / 900), 1e-6);
}

}  // namespace
}  // namespace skycap::missions
