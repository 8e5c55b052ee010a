/// One flight of a mission in wind with navigation errors, with or without a recall.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/monte_carlo/flight_script.h"
#include "flight/monte_carlo/nearest_pass.h"
#include "flight/rtl/rtl_profile.h"

namespace skycap::flight {

/// Obstacles that flights are judged against, with the distance limits. Keeps references to the
/// spaces, above the pad and elsewhere.
struct ClearanceCriterion {
  std::string name;
  const FreeSpace& space;
  const FreeSpace& pad_space;
  double limit = 0.0;         ///< Minimum distance of flights with wind and errors [m].
  double return_limit = 0.0;  ///< Minimum distance of returns along the exact lines of the law [m].
  /// Distance by which the limit of interrupted flights is lower: they may pass a stop by as much
  /// (stop_overshoot()) [m].
  double overshoot = 0.0;
};

/// Mission file prepared for simulation.
struct SimulatedMission {
  FlightScript script;
  Motion motion;
  std::optional<RtlProfile> rtl_profile;  ///< Law of exactly one autopilot. Empty: no recalls.
};

/// Random values of one flight.
struct FlightDraw {
  std::uint64_t seed = 0, number = 0;
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< Air velocity [m/s].
  double position_error = 0.0;                     ///< Maximum navigation error [m].
  std::optional<double> return_time;               ///< Time of the recall [s].
};

/// Closest approach of a flight to an obstacle.
struct NearestApproach {
  Closest closest{};
  double time = 0.0;  ///< Time since take-off [s].
  bool is_returning = false;
};

struct SimulatedFlight {
  double time = 0.0;                     ///< Time until the motors stopped [s].
  double energy = 0.0;                   ///< Electrical energy [J].
  double off_line = 0.0;                 ///< Maximum deviation from the line of the leg [m].
  std::vector<NearestApproach> nearest;  ///< One entry per judge.
};

/// Simulation time step [s].
inline constexpr double simulation_step = 0.04;

/// Returns the positions of a flight step by step, from the pad until the motors stop.
std::vector<Eigen::Vector3d> compute_track(const SimulatedMission& mission, const FlightDraw& draw);

/// Simulates a flight. Distances are searched up to `up_to` [m].
SimulatedFlight fly(const SimulatedMission& mission, const FlightDraw& draw,
                    std::span<const ClearanceCriterion> criteria, double up_to);

}  // namespace skycap::flight
