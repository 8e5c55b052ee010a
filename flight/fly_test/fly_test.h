/// A mission flown many times in the simulator, each time in another wind and every second time
/// called home at a random moment; and the returns from many places, as straight as autopilots are
/// told to fly them.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stop_token>
#include <vector>

#include "flight/fly_test/simulated_flight.h"

namespace skycap::flight {

struct FlyTestOptions {
  std::size_t flights = 100;
  std::size_t returns = 0;      ///< from places at random; more begin at every second of the flight
  double wind_speed = 5.0;      ///< the strongest steady wind, from any side [m/s]
  double position_error = 0.1;  ///< greatest [m]
  double up_to = 12.0;          ///< distances beyond are of no interest [m]
  std::uint64_t seed = 1;
  unsigned threads = 0;                             ///< zero: all processors
  std::function<void(std::size_t flights)> report;  ///< called by one thread at a time
  std::stop_token stop{};
};

/// One flight, what it drew, and what came of it.
struct TestFlight {
  FlightDraw draw;
  SimulatedFlight flown;
};

/// Returns against one judge.
struct ReturnTest {
  std::size_t flown = 0;
  std::size_t nearer = 0;                          ///< than the judge allows
  Closest nearest{};                               ///< of all
  Eigen::Vector3d from = Eigen::Vector3d::Zero();  ///< where that return began
};

struct FlyTest {
  double planned_time = 0.0;        ///< of the script, in calm air [s]
  std::vector<TestFlight> flights;  ///< by number; fewer than asked for if it was stopped
  std::vector<ReturnTest> returns;  ///< by judge
  bool is_complete = true;
};

/// The same for any number of threads.
FlyTest fly_test(const FlownMission& mission, std::span<const Judge> judges,
                 const FlyTestOptions& options);

/// How many of the flights came nearer than that judge allows.
std::size_t flights_nearer(const FlyTest& test, std::span<const Judge> judges, std::size_t judge);

}  // namespace skycap::flight
