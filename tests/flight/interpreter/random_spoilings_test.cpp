// Random corruptions of each kind of mission file. Each file is rejected, or an independent flight
// of its items keeps the clearance according to CGAL's exact distances.
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

constexpr int corruptions = 200;

/// Georeference of the sample plan.
const Ground ground{51.753458, -1.254022, 111.5, 46.7, {-30, -25, 0}};

bool keeps_clear(const std::vector<Eigen::Vector3d>& positions) {
  static const CgalOracle oracle(sample_site().mesh);
  return keeps_clear(oracle, positions, 2.0 - 3.0 * rounding_bound);
}

class RandomCorruptions : public testing::TestWithParam<AutopilotType> {};

TEST_P(RandomCorruptions, AreRejectedOrHarmless) {
  std::mt19937_64 random(GetParam() == AutopilotType::px4 ? 5 : 6);
  int harmless = 0, rejected = 0;
  for (int i = 0; i < corruptions; ++i) {
    MavlinkMission file = sample_file(GetParam());
    corrupt(file, random, ground.around(25, 25));
    if (!find_problems(file, GetParam()).empty()) {
      ++rejected;
      continue;
    }
    ++harmless;
    EXPECT_TRUE(keeps_clear(make_flight(file.items, ground))) << "spoiling " << i;
  }
  EXPECT_GT(rejected, corruptions / 2);
  EXPECT_GT(harmless, 3);
}

INSTANTIATE_TEST_SUITE_P(Interpreter, RandomCorruptions,
                         testing::Values(AutopilotType::px4, AutopilotType::ardupilot),
                         [](const auto& parameter) {
                           return parameter.param == AutopilotType::px4 ? "px4" : "ardupilot";
                         });

TEST(RandomWpmlCorruptions, AreRejectedOrHarmless) {
  const FlightPlan plan = sample_plan(vehicle_profile("m350_rtk"));
  const KmzContent good = unpack_kmz(write_kmz(plan));
  const FlightFacts facts = make_flight_facts(plan);
  std::mt19937_64 random(7);
  int harmless = 0, rejected = 0;
  for (int i = 0; i < corruptions; ++i) {
    KmzContent kmz = good;
    std::string& text = i % 4 == 0 ? kmz.template_kml : kmz.waylines_wpml;
    text = corrupted(text, random);
    bool is_rejected = !validate_kmz(pack_kmz(kmz)).empty();
    is_rejected = is_rejected || !find_problems(interpret(kmz, facts)).empty();
    ++(is_rejected ? rejected : harmless);
    if (!is_rejected) {
      EXPECT_TRUE(keeps_clear(make_flight(kmz.waylines_wpml, ground))) << "spoiling " << i;
    }
  }
  EXPECT_GT(rejected, corruptions / 4);
  EXPECT_GT(harmless, 3);
}

}  // namespace
}  // namespace skycap::flight
