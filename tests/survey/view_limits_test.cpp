#include "survey/view_limits.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using geometry::View;
using testing::HasSubstr;

constexpr double degree = std::numbers::pi / 180.0;

TEST(ViewLimits, AllowEveryViewByDefault) {
  EXPECT_TRUE(ViewLimits{}.allow({{0, 0, -100}, {0, 0, 1}}));
}

TEST(ViewLimits, ForbidByHeightPitchFenceAndNoFlyVolumes) {
  ViewLimits limits;
  limits.min_height = 2.0;
  limits.max_height = 50.0;
  limits.min_pitch = -90 * degree;
  limits.max_pitch = 30 * degree;
  limits.geofence = {{-100, -100}, {100, -100}, {100, 100}, {-100, 100}};
  limits.no_fly = {{"", {{10, 10}, {20, 10}, {20, 20}, {10, 20}}, 0, 30}};
  limits.validate();
  const Vector3d level = Vector3d::UnitX();
  EXPECT_TRUE(limits.allow({{0, 0, 10}, level}));
  EXPECT_FALSE(limits.allow({{0, 0, 1.9}, level}));
  EXPECT_FALSE(limits.allow({{0, 0, 51}, level}));
  EXPECT_FALSE(limits.allow({{0, 0, 10}, Vector3d(1, 0, 1).normalized()}));  // 45 degrees up
  EXPECT_FALSE(limits.allow({{150, 0, 10}, level}));
  EXPECT_TRUE(limits.allow({{100, 0, 10}, level}));  // on the fence
  EXPECT_FALSE(limits.allow({{15, 15, 10}, level}));
  EXPECT_FALSE(limits.allow({{10, 15, 30}, level}));  // on the edge of the volume
  EXPECT_TRUE(limits.allow({{15, 15, 40}, level}));   // above the volume
}

// Property: each returned view is allowed, has the requested distance and looks at the target.
TEST(ViewLimits, MakeTargetViewsWithinLimits) {
  ViewLimits limits;
  limits.min_height = 2.0;
  limits.max_height = 30.0;
  limits.min_pitch = -80 * degree;
  limits.max_pitch = 20 * degree;
  std::mt19937_64 generator(3);
  std::normal_distribution<double> normal;
  int found = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector3d target{normal(generator), normal(generator), 5.0 + 10.0 * normal(generator)};
    const Vector3d towards =
        Vector3d{normal(generator), normal(generator), normal(generator)}.normalized();
    const auto view = limits.make_target_view(target, towards, 20.0);
    if (!view) continue;
    ++found;
    EXPECT_TRUE(limits.allow(*view));
    EXPECT_NEAR((view->position - target).norm(), 20.0, 1e-9);
    EXPECT_NEAR((target - view->position).normalized().dot(view->direction), 1.0, 1e-12);
  }
  EXPECT_GT(found, 500);
}

TEST(ViewLimits, RaiseLowViewsAndKeepAllowedViews) {
  ViewLimits limits;
  limits.min_height = 2.0;
  const auto raised = limits.make_target_view({0, 0, 1}, Vector3d(1, 1, -1).normalized(), 10.0);
  ASSERT_TRUE(raised);
  EXPECT_NEAR(raised->position.z(), 2.0, 1e-4);  // the margin is a millionth of the distance
  EXPECT_NEAR(raised->position.x(), raised->position.y(), 1e-9);
  EXPECT_GT(raised->position.x(), 0.0);
  const auto kept = limits.make_target_view({0, 0, 1}, Vector3d(0, 0, 1), 10.0);
  ASSERT_TRUE(kept);
  EXPECT_TRUE(kept->position.isApprox(Vector3d(0, 0, 11)));
}

// A camera that cannot look up sees a low target from above, and one that cannot look down far sees
// it from the side.
TEST(ViewLimits, TurnViewsIntoThePitchRangeOfTheGimbal) {
  ViewLimits limits;
  limits.min_pitch = -1.0;
  limits.max_pitch = 0.0;
  const auto pitch_from = [&](const Vector3d& towards_view) -> std::optional<double> {
    const auto view = limits.make_target_view({0, 0, 5}, towards_view.normalized(), 10.0);
    return view ? std::optional(std::asin(view->direction.z())) : std::nullopt;
  };
  EXPECT_THAT(pitch_from({1, 0, -1}), testing::Optional(testing::DoubleNear(0.0, 1e-9)));
  EXPECT_THAT(pitch_from({1, 0, 9}), testing::Optional(testing::DoubleNear(-1.0, 1e-9)));
  EXPECT_THAT(pitch_from({1, 0, 1}), testing::Optional(testing::DoubleNear(-45.0 * degree, 1e-9)));
}

TEST(ViewLimits, ReportTheInvalidField) {
  const auto validation_error = [](const ViewLimits& limits) -> std::string {
    try {
      limits.validate();
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_config);
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(validation_error({.min_standoff = -1.0}), HasSubstr("stand_off"));
  EXPECT_THAT(validation_error({.min_height = 3.0, .max_height = 2.0}), HasSubstr("max_height"));
  EXPECT_THAT(validation_error({.geofence = {{0, 0}, {1, 0}}}), HasSubstr("geofence"));
  EXPECT_THAT(validation_error({.no_fly = {{"", {{0, 0}, {1, 0}, {1, 1}}, 1, 0}}}),
              HasSubstr("no_fly"));
  EXPECT_THAT(validation_error({.min_pitch = 1.0, .max_pitch = 0.0}), HasSubstr("pitch"));
}

}  // namespace
}  // namespace skycap::survey
