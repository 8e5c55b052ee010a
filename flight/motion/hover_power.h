/// What a vehicle's data sheet says of the power of hovering, which calibrates Motion.
#pragma once

#include "flight/motion/vehicle.h"

namespace skycap::flight {

/// Electrical power of hovering at sea level that the battery and the endurance stand for [W].
double data_sheet_power(const Vehicle& vehicle);

/// How long the battery lasts at a hover power [W]: the inverse of data_sheet_power() [min].
double endurance_at(const Vehicle& vehicle, double hover_power);

/// Electrical power that the rotors take at least to hover at sea level: with no losses but those
/// of momentum theory and blade drag [W].
double min_rotor_power(const Vehicle& vehicle);

}  // namespace skycap::flight
