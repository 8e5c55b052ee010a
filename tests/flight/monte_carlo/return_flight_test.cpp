// The profile for the verification of returns and the return flight of the simulator were
// implemented independently. They must agree.
#include "flight/monte_carlo/return_flight.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "flight/clearance/segment_distance.h"
#include "tests/flight/scenes.h"
#include "tests/flight/vehicles.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double level = 40.0;

/// Returns the distance of a position from the verified return paths.
double outside(const std::vector<ReturnSegment>& segments, const Vector3d& position) {
  double min = 1e9;
  for (const ReturnSegment& segment : segments) {
    min =
        std::min(min, std::sqrt(nearest(segment.line, position).squared_distance) - segment.spread);
  }
  return min;
}

class SampledReturn : public testing::TestWithParam<AutopilotType> {
 protected:
  RtlProfile rtl_profile() const { return {{GetParam()}, level, {{0, 0, 0}, {60, 10, 1}}, 5.0}; }
};

INSTANTIATE_TEST_SUITE_P(ReturnFlight, SampledReturn,
                         testing::Values(AutopilotType::px4, AutopilotType::ardupilot,
                                         AutopilotType::dji));

TEST_P(SampledReturn, StaysWithinVerifiedSegments) {
  geometry::RandomNumbers draws(7, 1);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d position{draws.between(-70, 90), draws.between(-70, 70), draws.between(6, 50)};
    std::vector<ReturnSegment> verified = return_segments(rtl_profile(), position);
    for (const ReturnSegment& column :
         landing_columns(rtl_profile(), std::max(level, position.z()))) {
      verified.push_back(column);
    }
    const std::vector<Vector3d> path = return_path(rtl_profile(), position, draws);
    ASSERT_EQ(path.front(), position);
    ASSERT_LE(path.back().z(), 1.0);
    ASSERT_GT(path.size(), 1U);
    for (std::size_t k = 1; k < path.size(); ++k) {
      const Segment line{path[k - 1], path[k]};
      for (double share = 0.0; share <= 1.0; share += 0.02) {
        const Vector3d there = line.at(share);
        if (there.z() < path.back().z() + rtl_profile().landing_climb)
          continue;  // This part must be checked by the pilot.
        ASSERT_LT(outside(verified, there), 1e-9) << "from " << position.transpose();
      }
    }
  }
}

TEST_P(SampledReturn, LandsAtNearestLandingPoint) {
  geometry::RandomNumbers draws(8, 1);
  for (int i = 0; i < 200; ++i) {
    const Vector3d position{draws.between(70, 90), draws.between(-20, 20), draws.between(6, 30)};
    const Vector3d end = return_path(rtl_profile(), position, draws).back();
    EXPECT_LT((end - Vector3d(60, 10, 1)).norm(),
              8.0 + 1e-9);  // DJI vehicles may land on the spot.
  }
}

TEST_P(SampledReturn, HasDurationOfItsParts) {
  geometry::RandomNumbers draws(9, 1), same(9, 1);
  const Motion motion(vehicle_profile("generic"), {});
  const Vector3d position(80, -40, 12);
  const FlightScript script = return_script(rtl_profile(), motion, position, draws);
  const std::vector<Vector3d> path = return_path(rtl_profile(), position, same);
  EXPECT_EQ(script.front().from, position);
  EXPECT_EQ(script.back().to, path.back());
  EXPECT_TRUE(script.back().is_over_pad);
  double min = motion.landing_time(path[path.size() - 2].z() - path.back().z());
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    min += motion.leg_time(path[i] - path[i - 1]) - motion.vehicle().mode.settle_time;
  }
  EXPECT_GT(duration(script), min);
  EXPECT_LT(duration(script), min + 12.0);
}

}  // namespace
}  // namespace skycap::flight
