/// Upper bound of flight time relative to the prediction of Motion, and the energy to plan with.
///
/// PX4's leg law follows its source code, but two missions in its simulator took 1.5 to 1.8 times
/// the predicted time. Predicted times on PX4 are therefore a range
/// (docs/explanation/sensor-and-flight-models.md).
#pragma once

#include "flight/motion/motion.h"

namespace skycap::flight {

/// Returns the maximum ratio of actual to predicted flight time. It is 1 where flights confirmed
/// the prediction or no flight data exist.
inline double longest_flight(const Vehicle& vehicle) {
  constexpr double longest_on_px4 = 1.8;
  return vehicle.autopilot == AutopilotType::px4 ? longest_on_px4 : 1.0;
}

/// Returns the predicted energy that a sortie may use [J]. The usable battery energy is divided by
/// the maximum time ratio of the conditions, assuming constant power.
inline double plannable_energy(const Motion& motion) {
  return motion.usable_energy() / motion.conditions().longest_flight;
}

}  // namespace skycap::flight
