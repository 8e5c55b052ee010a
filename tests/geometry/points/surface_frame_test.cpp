#include "geometry/points/surface_frame.h"

#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double single_precision = 1e-5;  // accuracy of unit vectors computed from float points

void expect_orthonormal(const SurfaceFrame& frame) {
  EXPECT_NEAR(frame.normal.norm(), 1.0, 1e-9);
  EXPECT_NEAR(frame.outward.norm(), 1.0, 1e-9);
  EXPECT_NEAR(frame.normal.dot(frame.outward), 0.0, 1e-9);
  EXPECT_TRUE(frame.boundary.isApprox(frame.normal.cross(frame.outward), 1e-9));
}

// Edge of a strip in the plane z = 0. The surface is at x < 0, so +x points outwards.
const std::vector<Vector3f> plane_edge = {
    {0, 0, 0}, {-1, 0.5F, 0}, {-1, -0.5F, 0}, {-2, 0.1F, 0}, {-2, -0.1F, 0}};

TEST(SurfaceFrame, PointsToSensorAndOutwardFromMeasuredSide) {
  const SurfaceFrame frame = surface_frame({0, 0, 0}, plane_edge, {3, 0, 9});
  expect_orthonormal(frame);
  EXPECT_TRUE(frame.normal.isApprox(Vector3d::UnitZ(), single_precision));
  EXPECT_TRUE(frame.outward.isApprox(Vector3d::UnitX(), single_precision));
}

// Trap T6: the normal points to the free side.
TEST(SurfaceFrame, FlipsNormalWithSensor) {
  const SurfaceFrame frame = surface_frame({0, 0, 0}, plane_edge, {3, 0, -9});
  EXPECT_TRUE(frame.normal.isApprox(-Vector3d::UnitZ(), single_precision));
}

TEST(SurfaceFrame, RotatesWithScene) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  std::vector<Vector3f> turned;
  for (const Vector3f& p : plane_edge) turned.push_back((turn * p.cast<double>()).cast<float>());
  const SurfaceFrame straight = surface_frame({0, 0, 0}, plane_edge, {3, 0, 9});
  const SurfaceFrame frame = surface_frame({0, 0, 0}, turned, turn * Vector3d(3, 0, 9));
  EXPECT_TRUE(frame.normal.isApprox(turn * straight.normal, single_precision));
  EXPECT_TRUE(frame.outward.isApprox(turn * straight.outward, single_precision));
}

TEST(SurfaceFrame, PointsAcrossLineForCollinearPoints) {
  const std::vector<Vector3f> line = {{0, 0, 0}, {-1, 0, 0}, {-2, 0, 0}, {-3, 0, 0}};
  const SurfaceFrame frame = surface_frame({0, 0, 0}, line, {5, 0, 5});
  expect_orthonormal(frame);
  EXPECT_TRUE(frame.normal.isApprox(Vector3d::UnitZ(), single_precision));
  EXPECT_TRUE(frame.outward.isApprox(Vector3d::UnitX(), single_precision));
}

TEST(SurfaceFrame, IsOrthonormalForLineTowardsSensor) {
  const std::vector<Vector3f> line = {{0, 0, 0}, {-1, 0, 0}, {-2, 0, 0}};
  expect_orthonormal(surface_frame({0, 0, 0}, line, {5, 0, 0}));
}

TEST(SurfaceFrame, FacesSensorForTooFewOrIdenticalPoints) {
  const std::vector<std::vector<Vector3f>> poor = {
      {}, {{1, 1, 1}}, {{1, 1, 1}, {2, 1, 1}}, {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}};
  for (const auto& neighbours : poor) {
    const SurfaceFrame frame = surface_frame({1, 1, 1}, neighbours, {1, 4, 1});
    expect_orthonormal(frame);
    EXPECT_TRUE(frame.normal.isApprox(Vector3d::UnitY(), 1e-9));
  }
}

// A point in the centre of its neighbours has no outer side. The second principal axis is used.
TEST(SurfaceFrame, UsesMiddleAxisForCentredPoint) {
  const std::vector<Vector3f> centred = {{0, 0, 0}, {2, 0, 0}, {-2, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  const SurfaceFrame frame = surface_frame({0, 0, 0}, centred, {0, 0, 5});
  expect_orthonormal(frame);
  EXPECT_NEAR(std::abs(frame.outward.y()), 1.0, single_precision);
}

}  // namespace
}  // namespace skycap::geometry
