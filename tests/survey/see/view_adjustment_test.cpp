#include "survey/see/view_adjustment.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::survey {
namespace {

using Eigen::Vector3d;

const see::ViewPlacement two_metres{.distance = 2.0};

/// Returns a frontier on the plane z = 0 with the surface at x < 0, first observed from (3, 0, 3).
see::Frontier edge_frontier() {
  see::Frontier frontier{.position = Vector3d::Zero(),
                         .observed_from = {3, 0, 3},
                         .observed_along = Vector3d(-1, 0, -1).normalized(),
                         .frame = {Vector3d::UnitZ(), Vector3d::UnitX(), Vector3d::UnitY()},
                         .view = {}};
  frontier.view = see::place_view(frontier.position, frontier.frame.normal, two_metres);
  return frontier;
}

// Trap T6: the sensor is on the free side and looks back at the frontier.
TEST(PlaceView, HasViewDistanceAndLooksBack) {
  const geometry::View view = see::place_view({1, 1, 1}, {0, 0, 1}, two_metres);
  EXPECT_TRUE(view.position.isApprox(Vector3d(1, 1, 3)));
  EXPECT_TRUE(view.direction.isApprox(Vector3d(0, 0, -1)));
}

TEST(PlaceView, RisesToMinHeightKeepingAzimuthAndDistance) {
  const see::ViewPlacement placement{.distance = 5.0, .min_height = 2.0};
  const geometry::View view =
      see::place_view({0, 0, 0}, Vector3d(3, 4, -12).normalized(), placement);
  EXPECT_NEAR(view.position.z(), 2.0, 1e-12);
  EXPECT_NEAR(view.position.norm(), 5.0, 1e-12);
  EXPECT_NEAR(view.position.y() / view.position.x(), 4.0 / 3.0, 1e-12);
  EXPECT_TRUE(view.direction.isApprox(-view.position.normalized()));
  EXPECT_TRUE(
      see::place_view({0, 0, 0}, {0, 0, 1}, placement).position.isApprox(Vector3d(0, 0, 5)));
  // No position on the sphere is high enough, so the view is straight above.
  EXPECT_TRUE(
      see::place_view({0, 0, -9}, {1, 0, 0}, placement).position.isApprox(Vector3d(0, 0, -4)));
}

// The observed points are at x < 0, so the view moves over the edge to x > 0. The displacement and
// the rotation about e_b add up: tan(alpha) = (s+1)a/d, theta = alpha - atan(a/d), angle = alpha +
// theta.
TEST(AdjustView, MovesOverEdgeByReleasedAngles) {
  see::Frontier frontier = edge_frontier();
  see::AttemptRecord record;
  const double a = 0.3, d = 2.0;
  ASSERT_TRUE(
      see::adjust_view(frontier, record, {-a, 0, 0}, two_metres, see::Adjustment::rotation));
  const double alpha = std::atan(2 * a / d), theta = alpha - std::atan(a / d);
  const Vector3d expected(d * std::sin(alpha + theta), 0, d * std::cos(alpha + theta));
  EXPECT_TRUE(frontier.view.position.isApprox(expected, 1e-12));
  EXPECT_TRUE(frontier.view.direction.isApprox(-expected.normalized(), 1e-12));
}

// Along e_b, the rotation cancels part of the displacement. The remainder is the angle of the
// centroid.
TEST(AdjustView, TurnsByCentroidAngleAlongBoundary) {
  see::Frontier frontier = edge_frontier();
  see::AttemptRecord record;
  ASSERT_TRUE(
      see::adjust_view(frontier, record, {0, -0.3, 0}, two_metres, see::Adjustment::rotation));
  const double beta = std::atan(0.3 / 2.0);
  EXPECT_TRUE(
      frontier.view.position.isApprox(2.0 * Vector3d(0, std::sin(beta), std::cos(beta)), 1e-12));
}

TEST(AdjustView, ShiftsWithoutTurningWhenConfigured) {
  see::Frontier frontier = edge_frontier();
  see::AttemptRecord record;
  ASSERT_TRUE(see::adjust_view(frontier, record, {-0.3, 0, 0}, two_metres, see::Adjustment::shift));
  EXPECT_TRUE(frontier.view.direction.isApprox(-Vector3d(0.6, 0, 2.0).normalized(), 1e-12));
}

// Closer centroids lead to adjustments with a doubling gain. Then the side is switched once, and
// after another attempt the adjustment ends.
TEST(AdjustView, TriesEachSideUntilItStopsImproving) {
  see::Frontier frontier = edge_frontier();
  see::AttemptRecord record{.views = 7};
  const auto adjust = [&](double distance) {
    return see::adjust_view(frontier, record, {-distance, 0, 0}, two_metres,
                            see::Adjustment::rotation);
  };
  EXPECT_TRUE(adjust(0.5));
  EXPECT_TRUE(adjust(0.4));
  EXPECT_EQ(record.gain, 4.0);
  EXPECT_TRUE(adjust(0.4));  // not closer: back to the line of observation
  EXPECT_TRUE(frontier.view.direction.isApprox(-Vector3d(1, 0, 1).normalized(), 1e-12));
  EXPECT_EQ(record.gain, 1.0);
  EXPECT_EQ(record.views, 7);  // the number of views increases further
  EXPECT_TRUE(adjust(0.9));    // new start: any centroid counts as closer
  EXPECT_FALSE(adjust(0.9));
}

TEST(AdjustView, StopsAtOnceWhenConfigured) {
  see::Frontier frontier = edge_frontier();
  see::AttemptRecord record;
  EXPECT_FALSE(see::adjust_view(frontier, record, {-1, 0, 0}, two_metres, see::Adjustment::none));
}

}  // namespace
}  // namespace skycap::survey
