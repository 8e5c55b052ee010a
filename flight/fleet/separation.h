/// Verified distance between two vehicles over all times.
///
/// A vehicle on a straight leg only moves forward. Within a time span it is on the part of the leg
/// between its positions at both ends of the span, regardless of its speed profile. The distance of
/// two vehicles is therefore at least that of two such parts. Spans are halved until this lower
/// bound suffices or a violation is found. The bound converges to the exact distance as spans
/// shrink.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "flight/monte_carlo/flight_script.h"

namespace skycap::flight {

/// Sortie with its timetable entry.
struct TimedFlight {
  FlightScript script;
  double jerk = 0.0;   ///< Jerk of the vehicle, see set_point() [m/s^3].
  double start = 0.0;  ///< Departure from the pad [s].

  double landing() const { return start + duration(script); }
};

/// Requirements for two flights.
struct SeparationRule {
  /// Minimum distance of the planned positions, including position errors [m].
  double distance = 10.0;
  /// Maximum deviation from the timetable, early or late, at any time [s].
  double tolerance = 0.0;
};

/// Two positions that the timetable permits at the same time.
struct Encounter {
  double distance = 0.0;  ///< Distance [m].
  double time = 0.0;      ///< Timetable time of the first vehicle [s].
  Eigen::Vector3d first = Eigen::Vector3d::Zero(), second = Eigen::Vector3d::Zero();
};

/// Returns an encounter that violates the rule. Returns std::nullopt if none exists for any
/// deviation within the tolerance, verified for all times when both vehicles fly.
std::optional<Encounter> too_near(const TimedFlight& first, const TimedFlight& second,
                                  const SeparationRule& rule);

/// Returns a verified lower bound for all encounters within the tolerance [m]. It is at most
/// `up_to` and less than 1 mm below the minimum.
double verified_distance(const TimedFlight& first, const TimedFlight& second, double tolerance,
                         double up_to);

/// Returns the minimum distance between a flight and a position on the ground [m].
double distance_from(const FlightScript& script, const Eigen::Vector3d& position);

}  // namespace skycap::flight
