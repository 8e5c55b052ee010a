/// Hover power from a vehicle's data sheet, which calibrates Motion.
#pragma once

#include "flight/motion/vehicle.h"

namespace skycap::flight {

/// Returns the electrical hover power [W] at sea level that follows from battery energy and
/// endurance.
double data_sheet_power(const Vehicle& vehicle);

/// Returns the endurance [min] for a hover power [W]. Inverse of data_sheet_power().
double endurance_at(const Vehicle& vehicle, double hover_power);

/// Returns the minimum electrical rotor power for hovering at sea level [W], with only the losses
/// of momentum theory and blade drag.
double min_rotor_power(const Vehicle& vehicle);

}  // namespace skycap::flight
