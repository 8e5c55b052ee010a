/// Failures of a flight, which its steps return as ordinary results.
#pragma once

#include <optional>
#include <string>
#include <utility>

namespace skycap::missions::online {

/// Reason why a flight cannot continue.
enum class FailureKind {
  rejected,     ///< The autopilot rejects a command or executes it incorrectly.
  pilot,        ///< Another station has taken control.
  link,         ///< The link to the vehicle is lost.
  position,     ///< The vehicle's position estimate is invalid.
  off_leg,      ///< The vehicle has left its leg.
  battery,      ///< The battery requires a return.
  planner,      ///< Planning the next leg failed or timed out.
  sensor,       ///< The scan failed or timed out.
  pose,         ///< The scan contradicts the map, so the vehicle's position is unknown.
  stalled,      ///< This program stalled while the vehicle continued to fly.
  interrupted,  ///< The user requested a stop.
};

struct FlightFailure {
  FailureKind kind;
  std::string what;  ///< Message for the user.
};

inline FlightFailure rejected(std::string what) { return {FailureKind::rejected, std::move(what)}; }

using MaybeFailure = std::optional<FlightFailure>;

}  // namespace skycap::missions::online
