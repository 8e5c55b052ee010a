// Two who were written apart, the law that returns are proven by and the way that the simulator
// flies, must agree.
#include "flight/fly_test/return_flight.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "flight/space/segment_distance.h"
#include "tests/flight/scenes.h"
#include "tests/flight/vehicles.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double level = 40.0;

/// How far a place is from all that the law proves.
double outside(const std::vector<ReturnPiece>& pieces, const Vector3d& place) {
  double least = 1e9;
  for (const ReturnPiece& piece : pieces) {
    least = std::min(least, std::sqrt(nearest(piece.line, place).squared_distance) - piece.spread);
  }
  return least;
}

class AReturn : public testing::TestWithParam<Dialect> {
 protected:
  ReturnLaw law() const { return {{GetParam()}, level, {{0, 0, 0}, {60, 10, 1}}, 5.0}; }
};

INSTANTIATE_TEST_SUITE_P(ReturnFlight, AReturn,
                         testing::Values(Dialect::px4, Dialect::ardupilot, Dialect::dji));

TEST_P(AReturn, StaysWithinWhatIsProven) {
  geometry::RandomNumbers draws(7, 1);
  for (int i = 0; i < 2000; ++i) {
    const Vector3d place{draws.between(-70, 90), draws.between(-70, 70), draws.between(6, 50)};
    std::vector<ReturnPiece> proven = return_pieces(law(), place);
    for (const ReturnPiece& column : landing_columns(law(), std::max(level, place.z()))) {
      proven.push_back(column);
    }
    const std::vector<Vector3d> way = return_way(law(), place, draws);
    ASSERT_EQ(way.front(), place);
    ASSERT_LE(way.back().z(), 1.0);
    ASSERT_GT(way.size(), 1U);
    for (std::size_t k = 1; k < way.size(); ++k) {
      const Segment line{way[k - 1], way[k]};
      for (double share = 0.0; share <= 1.0; share += 0.02) {
        const Vector3d there = line.at(share);
        if (there.z() < way.back().z() + law().landing_climb) continue;  // the pilot's
        ASSERT_LT(outside(proven, there), 1e-9) << "from " << place.transpose();
      }
    }
  }
}

TEST_P(AReturn, ComesDownAtTheNearestLandingPlace) {
  geometry::RandomNumbers draws(8, 1);
  for (int i = 0; i < 200; ++i) {
    const Vector3d place{draws.between(70, 90), draws.between(-20, 20), draws.between(6, 30)};
    const Vector3d end = return_way(law(), place, draws).back();
    EXPECT_LT((end - Vector3d(60, 10, 1)).norm(), 8.0 + 1e-9);  // DJI's may land where they are
  }
}

TEST_P(AReturn, TakesAsLongAsItsParts) {
  geometry::RandomNumbers draws(9, 1), same(9, 1);
  const Motion motion(vehicle_profile("generic"), {});
  const Vector3d place(80, -40, 12);
  const FlightScript script = return_script(law(), motion, place, draws);
  const std::vector<Vector3d> way = return_way(law(), place, same);
  EXPECT_EQ(script.front().from, place);
  EXPECT_EQ(script.back().to, way.back());
  EXPECT_TRUE(script.back().is_over_pad);
  double least = motion.landing_time(way[way.size() - 2].z() - way.back().z());
  for (std::size_t i = 1; i + 1 < way.size(); ++i) {
    least += motion.leg_time(way[i] - way[i - 1]) - motion.vehicle().mode.settle_time;
  }
  EXPECT_GT(duration(script), least);
  EXPECT_LT(duration(script), least + 12.0);
}

}  // namespace
}  // namespace skycap::flight
