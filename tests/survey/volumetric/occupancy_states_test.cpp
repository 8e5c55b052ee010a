#include "survey/volumetric/occupancy_states.h"

#include <cmath>

#include <gtest/gtest.h>

namespace skycap::survey {
namespace {

using Code = volumetric::OccupancyStates::Code;

// Log-odds have single precision, so probabilities are accurate to about 1e-7.
constexpr double single = 1e-6;

/// Returns the occupancy after `count` equal measurements, in closed form.
double occupancy_after(int count, double each, double clamping_min, double clamping_max) {
  const double odds = std::pow(each / (1.0 - each), count);
  return std::min(std::max(odds / (1.0 + odds), clamping_min), clamping_max);
}

TEST(OccupancyStates, FollowSensorModelUpToItsClamps) {
  volumetric::OccupancyStates states({});
  Code hits = volumetric::OccupancyStates::untouched,
       misses = volumetric::OccupancyStates::untouched;
  for (int count = 1; count <= 8; ++count) {
    hits = states.after_hit(hits);
    misses = states.after_miss(misses);
    EXPECT_NEAR(states.state(hits).occupancy, occupancy_after(count, 0.7, 0.12, 0.97), single);
    EXPECT_NEAR(states.state(misses).occupancy, occupancy_after(count, 0.4, 0.12, 0.97), single);
  }
}

TEST(OccupancyStates, AreOccupiedFromSecondHitAndFreeFromFourthMiss) {
  volumetric::OccupancyStates states({});
  Code hits = volumetric::OccupancyStates::untouched,
       misses = volumetric::OccupancyStates::untouched;
  for (int count = 1; count <= 6; ++count) {
    hits = states.after_hit(hits);
    misses = states.after_miss(misses);
    EXPECT_EQ(states.state(hits).kind,
              count < 2 ? volumetric::VoxelKind::uncertain : volumetric::VoxelKind::occupied);
    EXPECT_EQ(states.state(misses).kind,
              count < 4 ? volumetric::VoxelKind::uncertain : volumetric::VoxelKind::free);
    EXPECT_TRUE(states.state(hits).stops_rays);
    EXPECT_FALSE(states.state(misses).stops_rays);
  }
}

TEST(OccupancyStates, HaveEntropyOfTheirOccupancy) {
  volumetric::OccupancyStates states({});
  const volumetric::VoxelState& untouched = states.state(volumetric::OccupancyStates::untouched);
  EXPECT_EQ(untouched.entropy, std::log(2.0));
  Code code = volumetric::OccupancyStates::untouched;
  for (int count = 0; count < 7; ++count) code = states.after_miss(code);
  EXPECT_NEAR(states.state(code).entropy, 0.366925, 1e-6);  // H(0.12), computed by hand
}

TEST(OccupancyStates, StartFromPriorWhenShadowIsMeasured) {
  volumetric::OccupancyStates states({});
  for (const Code depth : {Code{1}, Code{17}, volumetric::OccupancyStates::deepest_shadow}) {
    EXPECT_EQ(states.state(depth).kind, volumetric::VoxelKind::shadowed);
    EXPECT_EQ(states.state(depth).shadow_depth, depth);
    EXPECT_EQ(states.after_hit(depth), states.after_hit(volumetric::OccupancyStates::untouched));
    EXPECT_EQ(states.after_miss(depth), states.after_miss(volumetric::OccupancyStates::untouched));
  }
}

// With a full table, the error of a value is at most the gap between stored values.
TEST(OccupancyStates, ReplaceNewValuesByNearestWhenTableIsFull) {
  const std::size_t values = 30;
  volumetric::OccupancyStates states({}, volumetric::OccupancyStates::deepest_shadow + 1 + values);
  Code code = volumetric::OccupancyStates::untouched;
  for (int i = 0; i < 2000; ++i) {
    const float before =
        volumetric::OccupancyStates::is_measured(code) ? states.log_odds(code) : 0.0F;
    const bool is_hit = i % 3 == 0;
    code = is_hit ? states.after_hit(code) : states.after_miss(code);
    const float expected = std::clamp(before + (is_hit ? 0.8473F : -0.4055F), -1.99243F, 3.47610F);
    ASSERT_NEAR(states.log_odds(code), expected, 0.5) << "measurement " << i;
  }
  EXPECT_EQ(states.size(), volumetric::OccupancyStates::deepest_shadow + 1 + values);
}

}  // namespace
}  // namespace skycap::survey
