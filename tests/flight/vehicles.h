/// Vehicles for the tests of flight/, one or two for each autopilot dialect. These tests do not use
/// the shipped presets, which belong to missions/.
#pragma once

#include <span>
#include <string>

#include "flight/motion/vehicle.h"

namespace skycap::flight {

/// Returns "generic" (PX4), "generic_ardupilot" (ArduCopter's defaults), "m350_rtk" and "m30t"
/// (DJI).
std::span<const Vehicle> vehicle_profiles();
const Vehicle& vehicle_profile(const std::string& name);

}  // namespace skycap::flight
