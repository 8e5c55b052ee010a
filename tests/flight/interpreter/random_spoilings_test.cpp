// Random spoilings of every kind of mission file: each is refused, or an independent flight of the
// same items keeps its distance from the building by CGAL's exact distances.
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/wpml_file.h"
#include "flight/interpreter/interpret.h"
#include "flight/interpreter/wpml_interpreter.h"
#include "tests/flight/interpreter/random_spoiling.h"
#include "tests/flight/interpreter/spoiled.h"

namespace skycap::flight {
namespace {

constexpr int spoilings = 200;

/// The sample's.
const Ground ground{51.753458, -1.254022, 111.5, 46.7, {-30, -25, 0}};

bool keeps_clear(const std::vector<Eigen::Vector3d>& places) {
  static const CgalOracle oracle(sample_site().mesh);
  return keeps_clear(oracle, places, 2.0 - 3.0 * rounding_bound);
}

class RandomSpoilings : public testing::TestWithParam<Dialect> {};

TEST_P(RandomSpoilings, AreRefusedOrHarmless) {
  std::mt19937_64 random(GetParam() == Dialect::px4 ? 5 : 6);
  int harmless = 0, refused = 0;
  for (int i = 0; i < spoilings; ++i) {
    MissionFile file = sample_file(GetParam());
    spoil(file, random, ground.around(25, 25));
    if (!problems_of(file, GetParam()).empty()) {
      ++refused;
      continue;
    }
    ++harmless;
    EXPECT_TRUE(keeps_clear(flight_of(file.items, ground))) << "spoiling " << i;
  }
  EXPECT_GT(refused, spoilings / 2);
  EXPECT_GT(harmless, 3);
}

INSTANTIATE_TEST_SUITE_P(Interpreter, RandomSpoilings,
                         testing::Values(Dialect::px4, Dialect::ardupilot),
                         [](const auto& parameter) {
                           return parameter.param == Dialect::px4 ? "px4" : "ardupilot";
                         });

TEST(RandomWpmlSpoilings, AreRefusedOrHarmless) {
  const FlightPlan plan = sample_plan(vehicle_profile("m350_rtk"));
  const KmzContent good = unpack_kmz(write_kmz(plan));
  const FlightFacts facts = facts_of(plan);
  std::mt19937_64 random(7);
  int harmless = 0, refused = 0;
  for (int i = 0; i < spoilings; ++i) {
    KmzContent kmz = good;
    std::string& text = i % 4 == 0 ? kmz.template_kml : kmz.waylines_wpml;
    text = spoiled(text, random);
    bool is_refused = !validate_kmz(pack_kmz(kmz)).empty();
    is_refused = is_refused || !problems_of(interpret(kmz, facts)).empty();
    ++(is_refused ? refused : harmless);
    if (!is_refused) {
      EXPECT_TRUE(keeps_clear(flight_of(kmz.waylines_wpml, ground))) << "spoiling " << i;
    }
  }
  EXPECT_GT(refused, spoilings / 4);
  EXPECT_GT(harmless, 3);
}

}  // namespace
}  // namespace skycap::flight
