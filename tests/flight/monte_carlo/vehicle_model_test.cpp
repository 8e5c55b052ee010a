#include "flight/monte_carlo/vehicle_model.h"

#include <gtest/gtest.h>

#include "tests/flight/vehicles.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double step = 0.04;

class VehicleModelFlight : public testing::Test {
 protected:
  void fly(const SetPoint& target, double time, const Vector3d& air = Vector3d::Zero()) {
    for (double t = 0.0; t < time; t += step) model_.fly(target, error_, air, step);
  }

  Motion motion_{vehicle_profile("generic"), Conditions{}};
  VehicleModel model_{motion_, {1, 2, 30}};
  Vector3d error_ = Vector3d::Zero();
};

TEST_F(VehicleModelFlight, UsesHoverPowerWhenHovering) {
  fly({{1, 2, 30}}, 100.0);
  EXPECT_EQ(model_.position(), Vector3d(1, 2, 30));
  EXPECT_NEAR(model_.energy(), 100.0 * motion_.hover_power(), 2.0 * step * motion_.hover_power());
}

TEST_F(VehicleModelFlight, ReturnsToSetPointInSteadyWind) {
  fly({{1, 2, 30}}, 2.0, {8, 0, 0});
  EXPECT_GT(model_.position().x(), 1.01);  // the wind first displaces the vehicle
  fly({{1, 2, 30}}, 60.0, {8, 0, 0});
  EXPECT_NEAR((model_.position() - Vector3d(1, 2, 30)).norm(), 0.0, 0.005);
}

TEST_F(VehicleModelFlight, IsDisplacedByPositionError) {
  error_ = {0.2, -0.1, 0.3};
  fly({{1, 2, 30}}, 60.0);
  EXPECT_NEAR((model_.position() - (Vector3d(1, 2, 30) - error_)).norm(), 0.0, 0.005);
}

// A setpoint with constant velocity is followed without lag.
TEST_F(VehicleModelFlight, FollowsSteadySetPointWithoutLag) {
  SetPoint target{{1, 2, 30}, {3, 0, 0}};
  for (int i = 0; i < 1500; ++i) {
    model_.fly(target, error_, Vector3d::Zero(), step);
    target.position.x() += 3.0 * step;
  }
  EXPECT_NEAR((model_.position() - target.position).norm(), 0.0, 0.01);
  EXPECT_NEAR(model_.velocity().x(), 3.0, 0.01);
}

}  // namespace
}  // namespace skycap::flight
