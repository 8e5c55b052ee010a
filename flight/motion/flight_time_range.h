/// How much longer than Motion says an autopilot may fly, and the energy that is planned with then.
///
/// PX4's law of a leg is the one of its source, but two missions flown in its simulator took 1.5 to
/// 1.8 times as long as it says (docs/explanation/sensor-and-flight-models.md): its time is a
/// range.
#pragma once

#include "flight/motion/motion.h"

namespace skycap::flight {

/// The upper end, as a multiple of the predicted time: 1 where predictions were confirmed by
/// flights, or where no flight says otherwise.
inline double longest_flight(const Vehicle& vehicle) {
  constexpr double longest_on_px4 = 1.8;
  return vehicle.dialect == Dialect::px4 ? longest_on_px4 : 1.0;
}

/// Of full batteries, what a sortie may take by Motion's prediction, so that the battery lasts if
/// it takes as long as its conditions allow; power is taken to be the same all the time [J].
inline double plannable_energy(const Motion& motion) {
  return motion.usable_energy() / motion.conditions().longest_flight;
}

}  // namespace skycap::flight
