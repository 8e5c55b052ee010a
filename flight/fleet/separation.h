/// How near two vehicles come to each other, proven for all times at once.
///
/// A vehicle on a straight leg moves forward only. Within any span of time it is therefore on the
/// part of the leg between its places at both ends of the span, whatever its speed is in between,
/// and the distance of two vehicles is no less than that of two such parts. Spans are halved until
/// that lower bound is large enough, or until a place is found that is too near: the bound goes to
/// the exact distance as spans go to nothing.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "flight/fly_test/flight_script.h"

namespace skycap::flight {

/// A sortie with its place in the timetable.
struct TimedFlight {
  FlightScript script;
  double jerk = 0.0;   ///< of the vehicle that flies it, see set_point() [m/s^3]
  double start = 0.0;  ///< leaves the pad [s]

  double landing() const { return start + duration(script); }
};

/// What is asked of two flights.
struct SeparationRule {
  double distance = 10.0;  ///< between their places, which errors are a part of [m]
  double tolerance = 0.0;  ///< each may be so much early or late all along, or lately [s]
};

/// Two places that the timetable allows two vehicles to be at together.
struct Encounter {
  double distance = 0.0;  ///< [m]
  double time = 0.0;      ///< of the first of the two, by the timetable [s]
  Eigen::Vector3d first = Eigen::Vector3d::Zero(), second = Eigen::Vector3d::Zero();
};

/// An encounter nearer than the rule asks for; nothing if it is proven that there is none: wherever
/// within the tolerance of its timetable each vehicle is, at all times when both fly.
std::optional<Encounter> too_near(const TimedFlight& first, const TimedFlight& second,
                                  const SeparationRule& rule);

/// A proven lower bound for all encounters within the tolerance, at most `up_to`, and less than a
/// millimetre below the least [m].
double proven_distance(const TimedFlight& first, const TimedFlight& second, double tolerance,
                       double up_to);

/// Least distance of any place of a flight from a place on the ground [m].
double distance_from(const FlightScript& script, const Eigen::Vector3d& place);

}  // namespace skycap::flight
