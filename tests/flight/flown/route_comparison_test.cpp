// Comparison of simulated flights that have known errors with their plan.
#include "flight/flown/route_comparison.h"

#include <algorithm>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/flight/flown/flown_logs.h"
#include "tests/support/complaint.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double speed = 4.0, rest = 2.0;

/// Stops of a serpentine in front of a facade, from a pad and back to it.
std::vector<Vector3d> stops() {
  std::vector<Vector3d> points{{0, -10, 0}};
  for (int row = 0; row < 3; ++row) {
    for (int i = 0; i < 5; ++i) {
      points.emplace_back(8.0 * (row % 2 == 0 ? i : 4 - i), 0.0, 10.0 + 6.0 * row);
    }
  }
  points.emplace_back(0, -10, 0);
  return points;
}

std::vector<std::size_t> all_captures() {
  std::vector<std::size_t> indices(15);
  for (std::size_t i = 0; i < indices.size(); ++i) indices[i] = i + 1;
  return indices;
}

PlannedFlight make_plan(const std::vector<Vector3d>& points) {
  PlannedFlight plan;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double length = (points[i] - points[i - 1]).norm();
    plan.legs.push_back({{points[i - 1], points[i]},
                         length / speed + rest,
                         "item " + std::to_string(i - 1),
                         "item " + std::to_string(i)});
    if (i + 1 < points.size()) {
      plan.captures.push_back({points[i], 0.0, -20.0, "item " + std::to_string(i)});
    }
  }
  return plan;
}

FlownTrack make_track(const std::vector<FlownState>& flight, const Vector3d& offset) {
  FlownTrack track;
  track.has_captures = true;
  for (const FlownState& flown : flight) {
    TrackState state = flown.state;
    state.position += offset;
    track.states.push_back(state);
    if (flown.is_capture) track.captures.push_back(state);
  }
  return track;
}

TEST(RouteComparison, FindsNoErrorInExactFlights) {
  const PlannedFlight plan = make_plan(stops());
  const RouteComparison found =
      compare_route(plan, make_track(fly_polyline(stops(), all_captures()), Vector3d::Zero()), {});
  for (std::size_t i = 0; i < plan.legs.size(); ++i) {
    EXPECT_TRUE(found.legs[i].is_flown) << i;
    EXPECT_GT(found.legs[i].flown_fraction, 0.99) << i;
    EXPECT_LT(found.legs[i].max_error, 1e-9) << i;
    if (i > 0) {
      EXPECT_NEAR(found.legs[i].duration, plan.legs[i].duration, 0.5) << i;
    }
  }
  for (const CaptureComparison& capture : found.captures) {
    EXPECT_TRUE(capture.is_made);
    EXPECT_LT(capture.error, 1e-9);
    EXPECT_LT(capture.turned.value(), 1e-9);
  }
  EXPECT_EQ(found.num_other_captures, 0);
}

/// 0.5 m off, three captures missed, and the two legs of one stop left out.
TEST(RouteComparison, FindsKnownErrors) {
  const PlannedFlight plan = make_plan(stops());
  std::vector<Vector3d> points = stops();
  // Stop 5 ends a row: without it, the vehicle flies from stop 4 directly to stop 6.
  points.erase(points.begin() + 5);
  std::vector<std::size_t> captures = all_captures();
  captures.pop_back();                                                       // one stop fewer
  std::erase_if(captures, [](std::size_t i) { return i == 8 || i == 12; });  // stops 9 and 13
  const Vector3d offset(0.0, 0.5, 0.0);
  const RouteComparison found = compare_route(
      plan, make_track(fly_polyline(points, captures), offset), {.max_deviation = 2.0});
  for (std::size_t i = 0; i < plan.legs.size(); ++i) {
    const bool is_left_out = i == 4 || i == 5;
    EXPECT_EQ(found.legs[i].is_flown, !is_left_out) << i;
    if (is_left_out) continue;
    EXPECT_LT(found.legs[i].max_error, 0.51) << i;
    // The first and the last leg are partly parallel to the offset.
    if (i > 0 && i + 1 < plan.legs.size()) {
      EXPECT_NEAR(found.legs[i].max_error, 0.5, 0.01) << i;
      EXPECT_NEAR(found.legs[i].mean_error, 0.5, 0.05) << i;
    }
  }
  for (std::size_t i = 0; i < plan.captures.size(); ++i) {
    EXPECT_EQ(found.captures[i].is_made, i != 4 && i != 8 && i != 12) << i;
    if (found.captures[i].is_made) {
      EXPECT_NEAR(found.captures[i].error, 0.5, 1e-9) << i;
    }
  }
  EXPECT_LT((found.mean_offset - offset).norm(), 1e-9);
}

TEST(RouteComparison, FindsTheEndOfAnAbortedFlight) {
  const PlannedFlight plan = make_plan(stops());
  std::vector<Vector3d> points = stops();
  points.erase(points.begin() + 9, points.end() - 1);  // returns after stop 8
  const RouteComparison found = compare_route(
      plan, make_track(fly_polyline(points, {1, 2, 3, 4, 5, 6, 7, 8}), Vector3d::Zero()), {});
  for (std::size_t i = 0; i < plan.captures.size(); ++i) {
    EXPECT_EQ(found.captures[i].is_made, i < 8) << i;
    EXPECT_EQ(found.legs[i].is_flown, i < 8) << i;
  }
}

TEST(RouteComparison, AcceptsLogsThatBeginInTheAir) {
  const std::vector<Vector3d> points = stops();
  const PlannedFlight plan = make_plan(points);
  // The log begins 3 m before the first stop, which is 14 m from the take-off point.
  std::vector<Vector3d> flown = points;
  flown.front() = points[1] + 3.0 * (points[0] - points[1]).normalized();
  const RouteComparison found =
      compare_route(plan, make_track(fly_polyline(flown, all_captures()), Vector3d::Zero()), {});
  EXPECT_LT(found.legs[0].flown_fraction, 0.5);
  for (const LegComparison& leg : found.legs) EXPECT_TRUE(leg.is_flown);
}

/// Places a part of a flight as a log of its own.
FlownTrack place_part(const std::vector<FlownState>& flight, std::size_t begin, std::size_t end) {
  FlownLog log{.kind = "part", .is_local = true, .has_captures = true};
  for (std::size_t i = begin; i < end; ++i) {
    const TrackState& state = flight[i].state;
    LoggedState logged{.time = state.time, .location = state.position};
    logged.camera_yaw_deg = state.camera_yaw_deg;
    logged.camera_pitch_deg = state.camera_pitch_deg;
    log.states.push_back(logged);
    if (flight[i].is_capture) log.captures.push_back(logged);
  }
  return place_track(log, {}, false, Vector3d::Zero(), TrackHeights::automatic);
}

/// A flight may be divided into two logs anywhere: during a leg, near a stop or at rest.
TEST(RouteComparison, FindsTheLegInWhichTwoLogsMeet) {
  const PlannedFlight plan = make_plan(stops());
  const std::vector<FlownState> flight = fly_polyline(stops(), all_captures());
  constexpr std::size_t at_least = 40, step = 3;  // both logs contain a movement
  for (std::size_t cut = at_least; cut + at_least < flight.size(); cut += step) {
    FlownTrack track;
    append_track(track, place_part(flight, 0, cut));
    append_track(track, place_part(flight, cut, flight.size()));
    const RouteComparison found = compare_route(plan, track, {});
    for (std::size_t i = 0; i < plan.legs.size(); ++i) {
      EXPECT_TRUE(found.legs[i].is_flown) << "leg " << i << ", cut at state " << cut;
    }
    for (const CaptureComparison& capture : found.captures) EXPECT_TRUE(capture.is_made);
  }
}

/// Both directions of the same path are different legs.
TEST(RouteComparison, DistinguishesLegsOverTheSamePath) {
  const std::vector<Vector3d> points{{0, 0, 10}, {40, 0, 10}, {0, 0, 10}, {0, 30, 10}};
  const PlannedFlight plan = make_plan(points);
  const RouteComparison whole =
      compare_route(plan, make_track(fly_polyline(points, {1, 2}), Vector3d::Zero()), {});
  for (const LegComparison& leg : whole.legs) EXPECT_GT(leg.flown_fraction, 0.95);
  EXPECT_NEAR(whole.legs[1].duration, plan.legs[1].duration, 0.5);
  // Without both legs, the vehicle turns at once.
  const RouteComparison part = compare_route(
      plan, make_track(fly_polyline({points[0], points[3]}, {}), Vector3d::Zero()), {});
  EXPECT_FALSE(part.legs[0].is_flown);
  EXPECT_FALSE(part.legs[1].is_flown);
  EXPECT_TRUE(part.legs[2].is_flown);
}

/// Two captures at one stop are distinguished by their direction.
TEST(RouteComparison, MatchesCapturesByDirection) {
  PlannedFlight plan = make_plan({{0, 0, 10}, {20, 0, 10}, {40, 0, 10}});
  plan.captures = {{{20, 0, 10}, 90.0, 0.0, "east"}, {{20, 0, 10}, 0.0, -20.0, "north"}};
  FlownTrack track = make_track(fly_polyline({{0, 0, 10}, {20, 0, 10}, {40, 0, 10}}, {1}),
                                Vector3d::Zero());  // looks north, 20 degrees down
  const RouteComparison found = compare_route(plan, track, {});
  EXPECT_FALSE(found.captures[0].is_made);
  EXPECT_TRUE(found.captures[1].is_made);
  track.captures.push_back(track.captures.front());
  track.captures.push_back(track.captures.front());
  EXPECT_EQ(compare_route(plan, track, {}).num_other_captures, 1);
}

TEST(RouteComparison, AssumesCapturesWithoutEvents) {
  const PlannedFlight plan = make_plan(stops());
  std::vector<Vector3d> points = stops();
  points.erase(points.begin() + 5);
  FlownTrack track = make_track(fly_polyline(points, {}), Vector3d::Zero());
  track.has_captures = false;
  const RouteComparison found = compare_route(plan, track, {.max_deviation = 2.0});
  EXPECT_TRUE(found.are_captures_assumed);
  for (std::size_t i = 0; i < plan.captures.size(); ++i) {
    EXPECT_EQ(found.captures[i].is_made, i != 4) << i;
  }
}

TEST(RouteComparison, RejectsInvalidDeviations) {
  const PlannedFlight plan = make_plan(stops());
  const FlownTrack track = make_track(fly_polyline(stops(), {}), Vector3d::Zero());
  EXPECT_THAT(
      testing_support::thrown_message([&] { compare_route(plan, track, {.max_deviation = 0.0}); }),
      HasSubstr("must be positive"));
}

}  // namespace
}  // namespace skycap::flight
