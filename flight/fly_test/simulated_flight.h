/// One flight of a mission in wind, with a receiver's errors, and called home on the way or not.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/fly_test/flight_script.h"
#include "flight/fly_test/nearest_pass.h"
#include "flight/way_home/return_law.h"

namespace skycap::flight {

/// What flights are judged against: what is not free, over the pad and elsewhere, and how near they
/// may come to it. Keeps references.
struct Judge {
  std::string name;
  const FreeSpace& space;
  const FreeSpace& pad_space;
  double limit = 0.0;         ///< for flights in weather [m]
  double return_limit = 0.0;  ///< for returns along the very lines that autopilots are told [m]
};

/// A mission's file, ready to be flown.
struct FlownMission {
  FlightScript script;
  Motion motion;
  std::optional<ReturnLaw> law;  ///< of one autopilot; without: it is never called home
};

/// What one flight has drawn.
struct FlightDraw {
  std::uint64_t seed = 0, number = 0;
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();  ///< [m/s]
  double position_error = 0.0;                     ///< greatest [m]
  std::optional<double> called_home;               ///< after this time [s]
};

/// How near it came to anything.
struct NearestPlace {
  Closest closest{};
  double time = 0.0;  ///< since take-off [s]
  bool is_on_way_home = false;
};

struct SimulatedFlight {
  double time = 0.0;                  ///< until the motors stopped [s]
  double energy = 0.0;                ///< [J]
  double off_line = 0.0;              ///< farthest from where it was to be on its leg's line [m]
  std::vector<NearestPlace> nearest;  ///< by judge
};

/// Time between two places of a simulated flight [s].
inline constexpr double simulation_step = 0.04;

/// Where the vehicle is on a flight, step by step, from the pad until its motors stop.
std::vector<Eigen::Vector3d> track_of(const FlownMission& mission, const FlightDraw& draw);

/// Distances are looked for up to `up_to`.
SimulatedFlight fly(const FlownMission& mission, const FlightDraw& draw,
                    std::span<const Judge> judges, double up_to);

}  // namespace skycap::flight
