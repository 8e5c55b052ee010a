#include "flight/monte_carlo/monte_carlo.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <optional>

#include "flight/monte_carlo/return_flight.h"
#include "geometry/parallel.h"

namespace skycap::flight {
namespace {

using Eigen::Vector3d;

/// Random number streams separate from those of the flights.
constexpr std::uint64_t draw_stream = 1ULL << 32, position_stream = 2ULL << 32,
                        return_stream = 3ULL << 32;

FlightDraw make_draw(std::size_t number, const SimulatedMission& mission,
                     const FlyTestOptions& options, double planned_time) {
  geometry::RandomNumbers random(options.seed, draw_stream + number);
  FlightDraw draw{.seed = options.seed, .number = number};
  const double from = random.between(0.0, 2.0 * std::numbers::pi);
  draw.wind =
      random.between(0.0, options.wind_speed) * Eigen::Vector2d(std::sin(from), std::cos(from));
  draw.position_error = options.position_error;
  const double moment = random.between(0.0, planned_time);
  if (mission.rtl_profile && number % 2 == 1) draw.return_time = moment;
  return draw;
}

/// Returns the start positions of returns: evenly distributed over the legs, and at every second of
/// the flight.
std::vector<Vector3d> draw_positions(const SimulatedMission& mission,
                                     const FlyTestOptions& options) {
  std::vector<Vector3d> positions;
  double length = 0.0;
  const auto is_relevant = [](const ScriptedLeg& leg) { return !leg.is_over_pad; };
  const double jerk = mission.motion.vehicle().mode.jerk;
  double clock = 0.0, begin = 0.0;
  for (const ScriptedLeg& leg : mission.script) {
    if (is_relevant(leg)) length += (leg.to - leg.from).norm();
    for (; clock < begin + leg.duration(); clock += 1.0) {
      if (is_relevant(leg)) positions.push_back(set_point(leg, jerk, clock - begin).position);
    }
    begin += leg.duration();
  }
  geometry::RandomNumbers random(options.seed, position_stream);
  for (std::size_t i = 0; i < options.returns; ++i) {
    double along = random.between(0.0, length);
    for (const ScriptedLeg& leg : mission.script) {
      if (!is_relevant(leg)) continue;
      const double own = (leg.to - leg.from).norm();
      if (along < own) {
        positions.push_back(leg.from + along / own * (leg.to - leg.from));
        break;
      }
      along -= own;
    }
  }
  return positions;
}

/// Returns the closest approach of a return to an obstacle. Excludes the column above the pad that
/// the pilot must check.
Closest nearest_return(const RtlProfile& rtl_profile, const std::vector<Vector3d>& path,
                       const ClearanceCriterion& criterion, double up_to) {
  Closest nearest{up_to};
  const auto update_nearest = [&](const FreeSpace& space, const Segment& line) {
    const Closest found = space.closest(line, nearest.distance);
    if (found.kind != ObstacleKind::none && found.distance < nearest.distance) nearest = found;
  };
  for (std::size_t i = 1; i + 1 < path.size(); ++i)
    update_nearest(criterion.space, {path[i - 1], path[i]});
  const Vector3d over = path[path.size() - 2], ground = path.back();
  const Vector3d seam(over.x(), over.y(),
                      std::min(over.z(), ground.z() + rtl_profile.landing_climb));
  update_nearest(criterion.space, {over, seam});
  update_nearest(criterion.pad_space, {seam, ground});
  return nearest;
}

std::vector<ReturnTest> fly_returns(const SimulatedMission& mission,
                                    std::span<const ClearanceCriterion> criteria,
                                    const FlyTestOptions& options) {
  std::vector<ReturnTest> tests(criteria.size());
  if (!mission.rtl_profile || options.returns == 0) return tests;
  const std::vector<Vector3d> positions = draw_positions(mission, options);
  for (std::size_t j = 0; j < criteria.size(); ++j) {
    std::vector<Closest> nearest(positions.size());
    geometry::parallel_for(positions.size(), options.threads, [&](std::size_t i) {
      if (options.stop.stop_requested()) return;
      geometry::RandomNumbers random(options.seed, return_stream + i);
      nearest[i] = nearest_return(*mission.rtl_profile,
                                  return_path(*mission.rtl_profile, positions[i], random),
                                  criteria[j], options.up_to);
    });
    if (options.stop.stop_requested()) return {};
    ReturnTest& test = tests[j];
    test.simulated = positions.size();
    test.nearest.distance = options.up_to;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      if (nearest[i].distance < criteria[j].return_limit) ++test.nearer;
      if (nearest[i].distance >= test.nearest.distance) continue;
      test.nearest = nearest[i];
      test.from = positions[i];
    }
  }
  return tests;
}

}  // namespace

FlyTest fly_test(const SimulatedMission& mission, std::span<const ClearanceCriterion> criteria,
                 const FlyTestOptions& options) {
  FlyTest test;
  test.planned_time = duration(mission.script);
  std::vector<std::optional<TestFlight>> flights(options.flights);
  std::mutex reporting;
  std::size_t simulated = 0;
  geometry::parallel_for(options.flights, options.threads, [&](std::size_t i) {
    if (options.stop.stop_requested()) return;
    const FlightDraw draw = make_draw(i, mission, options, test.planned_time);
    flights[i] = TestFlight{draw, fly(mission, draw, criteria, options.up_to)};
    const std::lock_guard lock(reporting);
    if (options.report) options.report(++simulated);
  });
  for (std::optional<TestFlight>& flight : flights) {
    if (flight) test.flights.push_back(std::move(*flight));
  }
  test.returns = fly_returns(mission, criteria, options);
  test.is_complete = !options.stop.stop_requested();
  return test;
}

std::size_t flights_nearer(const FlyTest& test, std::span<const ClearanceCriterion> criteria,
                           std::size_t criterion) {
  return static_cast<std::size_t>(
      std::ranges::count_if(test.flights, [&](const TestFlight& flight) {
        const double overshoot = flight.draw.return_time ? criteria[criterion].overshoot : 0.0;
        return flight.simulated.nearest[criterion].closest.distance <
               criteria[criterion].limit - overshoot;
      }));
}

}  // namespace skycap::flight
