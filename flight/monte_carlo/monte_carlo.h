/// Repeated simulation of a mission in random wind. Every second flight is recalled at a random
/// time. Additional returns are flown from many positions along the exact lines of the law.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "flight/monte_carlo/simulated_flight.h"

namespace skycap::flight {

struct FlyTestOptions {
  std::size_t flights = 100;
  /// Number of random start positions. Further returns start at every second of the flight.
  std::size_t returns = 0;
  double wind_speed = 5.0;      ///< Maximum steady wind speed, from any direction [m/s].
  double position_error = 0.1;  ///< Maximum navigation error [m].
  double up_to = 12.0;          ///< Distance limit: larger distances are ignored [m].
  std::uint64_t seed = 1;
  unsigned threads = 0;  ///< 0: all processors.
  /// Progress callback, called by one thread at a time.
  std::function<void(std::size_t flights)> report;
  std::stop_token stop{};
};

/// One flight with its random values and results.
struct TestFlight {
  FlightDraw draw;
  SimulatedFlight simulated;
};

/// Results of the returns for one judge.
struct ReturnTest {
  std::size_t simulated = 0;
  std::size_t nearer = 0;  ///< Number of returns that violate the judge's limit.
  Closest nearest{};       ///< Minimum distance of all returns.
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< Start of that return.
};

struct FlyTest {
  double planned_time = 0.0;  ///< Duration of the script in calm air [s].
  /// In order of their numbers. Fewer than requested after a stop.
  std::vector<TestFlight> flights;
  std::vector<ReturnTest> returns;  ///< One entry per judge.
  bool is_complete = true;
};

/// Runs the test. The result does not depend on the number of threads.
FlyTest fly_test(const SimulatedMission& mission, std::span<const ClearanceCriterion> criteria,
                 const FlyTestOptions& options);

/// Returns the number of flights that violate the limit of a judge. The limit of flights with a
/// return is lower by ClearanceCriterion::overshoot.
std::size_t flights_nearer(const FlyTest& test, std::span<const ClearanceCriterion> criteria,
                           std::size_t criterion);

}  // namespace skycap::flight
