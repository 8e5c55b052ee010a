#include "flight/fly_test/fly_test.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>

#include "flight/fly_test/return_flight.h"
#include "geometry/parallel.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Random number streams separate from those of the flights.
constexpr std::uint64_t stream_of_draws = 1ULL << 32, stream_of_places = 2ULL << 32,
                        stream_of_returns = 3ULL << 32;

FlightDraw draw_of(std::size_t number, const FlownMission& mission, const FlyTestOptions& options,
                   double planned_time) {
  geometry::RandomNumbers random(options.seed, stream_of_draws + number);
  FlightDraw draw{.seed = options.seed, .number = number};
  const double from = random.between(0.0, 2.0 * std::numbers::pi);
  draw.wind =
      random.between(0.0, options.wind_speed) * Eigen::Vector2d(std::sin(from), std::cos(from));
  draw.position_error = options.position_error;
  const double moment = random.between(0.0, planned_time);
  if (mission.law && number % 2 == 1) draw.called_home = moment;
  return draw;
}

/// Returns the start positions of returns: evenly distributed over the legs, and at every second of
/// the flight.
std::vector<Vector3d> places_of(const FlownMission& mission, const FlyTestOptions& options) {
  std::vector<Vector3d> places;
  double length = 0.0;
  const auto is_of_interest = [](const ScriptedLeg& leg) { return !leg.is_over_pad; };
  const double jerk = mission.motion.vehicle().mode.jerk;
  double clock = 0.0, begin = 0.0;
  for (const ScriptedLeg& leg : mission.script) {
    if (is_of_interest(leg)) length += (leg.to - leg.from).norm();
    for (; clock < begin + leg.duration(); clock += 1.0) {
      if (is_of_interest(leg)) places.push_back(set_point(leg, jerk, clock - begin).position);
    }
    begin += leg.duration();
  }
  geometry::RandomNumbers random(options.seed, stream_of_places);
  for (std::size_t i = 0; i < options.returns; ++i) {
    double along = random.between(0.0, length);
    for (const ScriptedLeg& leg : mission.script) {
      if (!is_of_interest(leg)) continue;
      const double own = (leg.to - leg.from).norm();
      if (along < own) {
        places.push_back(leg.from + along / own * (leg.to - leg.from));
        break;
      }
      along -= own;
    }
  }
  return places;
}

/// Returns the closest approach of a return to an obstacle. Excludes the column above the pad that
/// the pilot must check.
Closest nearest_return(const ReturnLaw& law, const std::vector<Vector3d>& way, const Judge& judge,
                       double up_to) {
  Closest nearest{up_to};
  const auto look = [&](const FreeSpace& space, const Segment& line) {
    const Closest found = space.closest(line, nearest.distance);
    if (found.kind != ObstacleKind::none && found.distance < nearest.distance) nearest = found;
  };
  for (std::size_t i = 1; i + 1 < way.size(); ++i) look(judge.space, {way[i - 1], way[i]});
  const Vector3d over = way[way.size() - 2], ground = way.back();
  const Vector3d seam(over.x(), over.y(), std::min(over.z(), ground.z() + law.landing_climb));
  look(judge.space, {over, seam});
  look(judge.pad_space, {seam, ground});
  return nearest;
}

std::vector<ReturnTest> fly_returns(const FlownMission& mission, std::span<const Judge> judges,
                                    const FlyTestOptions& options) {
  std::vector<ReturnTest> tests(judges.size());
  if (!mission.law || options.returns == 0) return tests;
  const std::vector<Vector3d> places = places_of(mission, options);
  for (std::size_t j = 0; j < judges.size(); ++j) {
    std::vector<Closest> nearest(places.size());
    geometry::parallel_for(places.size(), options.threads, [&](std::size_t i) {
      if (options.stop.stop_requested()) return;
      geometry::RandomNumbers random(options.seed, stream_of_returns + i);
      nearest[i] = nearest_return(*mission.law, return_way(*mission.law, places[i], random),
                                  judges[j], options.up_to);
    });
    if (options.stop.stop_requested()) return {};
    ReturnTest& test = tests[j];
    test.flown = places.size();
    test.nearest.distance = options.up_to;
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (nearest[i].distance < judges[j].return_limit) ++test.nearer;
      if (nearest[i].distance >= test.nearest.distance) continue;
      test.nearest = nearest[i];
      test.from = places[i];
    }
  }
  return tests;
}

}  // namespace

FlyTest fly_test(const FlownMission& mission, std::span<const Judge> judges,
                 const FlyTestOptions& options) {
  FlyTest test;
  test.planned_time = duration(mission.script);
  std::vector<std::optional<TestFlight>> flights(options.flights);
  std::mutex reporting;
  std::size_t flown = 0;
  geometry::parallel_for(options.flights, options.threads, [&](std::size_t i) {
    if (options.stop.stop_requested()) return;
    const FlightDraw draw = draw_of(i, mission, options, test.planned_time);
    flights[i] = TestFlight{draw, fly(mission, draw, judges, options.up_to)};
    const std::lock_guard lock(reporting);
    if (options.report) options.report(++flown);
  });
  for (std::optional<TestFlight>& flight : flights) {
    if (flight) test.flights.push_back(std::move(*flight));
  }
  test.returns = fly_returns(mission, judges, options);
  test.is_complete = !options.stop.stop_requested();
  return test;
}

std::size_t flights_nearer(const FlyTest& test, std::span<const Judge> judges, std::size_t judge) {
  return static_cast<std::size_t>(
      std::ranges::count_if(test.flights, [&](const TestFlight& flight) {
        return flight.flown.nearest[judge].closest.distance < judges[judge].limit;
      }));
}

}  // namespace skycap::flight
