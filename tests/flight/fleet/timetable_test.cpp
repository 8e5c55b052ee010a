#include "flight/fleet/timetable.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

constexpr double jerk = 5.0;

ScriptedLeg leg_between(const Vector3d& from, const Vector3d& to) {
  return {.from = from,
          .to = to,
          .moving = rest_to_rest_time((to - from).norm(), 4.0, 2.0, jerk),
          .speed = 4.0,
          .acceleration = 2.0};
}

/// Returns a flight that climbs, flies to `position` and back, and descends.
FlightScript there_and_back(const Vector3d& pad, const Vector3d& position) {
  const Vector3d above = pad + Vector3d(0, 0, 6);
  return {leg_between(pad, above), leg_between(above, position), leg_between(position, above),
          leg_between(above, pad)};
}

std::vector<TimedFlight> make_flights(const std::vector<FleetSortie>& sorties,
                                      const Timetable& table) {
  std::vector<TimedFlight> flights;
  for (std::size_t i = 0; i < sorties.size(); ++i) {
    flights.push_back({sorties[i].script, jerk, table.starts[i]});
  }
  return flights;
}

/// Returns true if flights of different vehicles violate the separation.
bool has_conflict(const std::vector<TimedFlight>& flights,
                  const std::vector<std::size_t>& vehicle_indices, const SeparationRule& rule) {
  for (std::size_t i = 0; i < flights.size(); ++i) {
    for (std::size_t j = i + 1; j < flights.size(); ++j) {
      if (vehicle_indices[i] != vehicle_indices[j] && too_near(flights[i], flights[j], rule))
        return true;
    }
  }
  return false;
}

TEST(Timetable, StartsSeparateFlightsAtOnce) {
  const std::vector<FleetSortie> sorties{{0, 0, there_and_back({0, 0, 0}, {0, 50, 10}), jerk},
                                         {1, 0, there_and_back({30, 0, 0}, {30, 40, 10}), jerk}};
  const Timetable table = timetable(sorties, 2, {.distance = 20.0, .tolerance = 10.0});
  EXPECT_EQ(table.starts, (std::vector<double>{0.0, 0.0}));
  EXPECT_DOUBLE_EQ(table.delay, 0.0);
  EXPECT_NEAR(table.makespan, duration(sorties[0].script), 1e-9);
}

// The paths cross. No other pair of start times, with one start at 0, has an earlier last landing.
TEST(Timetable, HasMinimalDelayForCrossingFlights) {
  const std::vector<FleetSortie> sorties{{0, 0, there_and_back({0, 0, 0}, {40, 60, 10}), jerk},
                                         {1, 0, there_and_back({40, 0, 0}, {0, 40, 10}), jerk}};
  const SeparationRule rule{.distance = 10.0, .tolerance = 1.0};
  const std::vector<std::size_t> vehicles{0, 1};
  EXPECT_TRUE(has_conflict(make_flights(sorties, {.starts = {0.0, 0.0}}), vehicles, rule));
  const Timetable table = timetable(sorties, 2, rule);
  EXPECT_FALSE(has_conflict(make_flights(sorties, table), vehicles, rule));
  for (int seconds = 0; seconds < 60; ++seconds) {
    const double later = seconds;
    for (const auto& starts : {std::vector<double>{0.0, later}, std::vector<double>{later, 0.0}}) {
      const std::vector<TimedFlight> flights = make_flights(sorties, {.starts = starts});
      if (has_conflict(flights, vehicles, rule)) continue;
      EXPECT_LE(table.makespan, std::max(flights[0].landing(), flights[1].landing()) + 1e-9);
    }
  }
}

// All vehicles have the same path, so they can only fly one after the other.
TEST(Timetable, FliesSequentiallyWhenPathsAreShared) {
  std::vector<FleetSortie> sorties;
  for (std::size_t v = 0; v < 3; ++v) {
    sorties.push_back({v, 0, there_and_back({0, 0, 0}, {0, 5, 8}), jerk});
  }
  const SeparationRule rule{.distance = 60.0, .tolerance = 4.0};
  const Timetable table = timetable(sorties, 3, rule);
  EXPECT_FALSE(has_conflict(make_flights(sorties, table), {0, 1, 2}, rule));
  const double one = duration(sorties[0].script);
  EXPECT_GE(table.makespan, 3.0 * one + 4.0 * rule.tolerance);
  // Start times are whole seconds.
  EXPECT_LE(table.makespan, 3.0 * one + 4.0 * rule.tolerance + 6.0);
  EXPECT_NEAR(table.delay, table.makespan - one, 1e-9);
}

TEST(Timetable, StartsNextSortieAfterLanding) {
  const std::vector<FleetSortie> sorties{{0, 1, there_and_back({0, 0, 0}, {0, 50, 10}), jerk},
                                         {0, 0, there_and_back({0, 0, 0}, {20, 50, 10}), jerk},
                                         {1, 0, there_and_back({60, 0, 0}, {60, 50, 10}), jerk}};
  const Timetable table = timetable(sorties, 2, {.distance = 10.0, .tolerance = 5.0});
  EXPECT_EQ(table.starts[1], 0.0);
  EXPECT_GE(table.starts[0], duration(sorties[1].script));
  EXPECT_LE(table.starts[0], duration(sorties[1].script) + 1.0);
}

// The left path crosses that of the other vehicle; the right path is slightly longer.
TEST(Timetable, SelectsVariantThatLandsFirst) {
  std::vector<FleetSortie> sorties{{0, 0, there_and_back({0, 0, 0}, {0, 50, 10}), jerk},
                                   {1, 0, there_and_back({30, 0, 0}, {0, 40, 10}), jerk, 0},
                                   {1, 0, there_and_back({30, 0, 0}, {60, 45, 10}), jerk, 1}};
  const SeparationRule rule{.distance = 15.0, .tolerance = 3.0};
  const Timetable table = timetable(sorties, 2, rule);
  EXPECT_EQ(table.variants, (std::vector<std::size_t>{0, 1}));
  EXPECT_EQ(table.starts, (std::vector<double>{0.0, 0.0, 0.0}));
  sorties.pop_back();
  const Timetable alone = timetable(sorties, 2, rule);
  EXPECT_EQ(alone.variants, (std::vector<std::size_t>{0, 0}));
  EXPECT_GT(alone.makespan, table.makespan);
}

}  // namespace
}  // namespace skycap::flight
