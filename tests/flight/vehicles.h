/// Vehicles for the tests of flight/, one or two of each dialect. The ones that ship are data of
/// missions/, which these tests do not know.
#pragma once

#include <span>
#include <string>

#include "flight/motion/vehicle.h"

namespace skycap::flight {

/// "generic" (PX4), "generic_ardupilot" (ArduCopter's defaults), "m350_rtk" and "m30t" (DJI).
std::span<const Vehicle> vehicle_profiles();
const Vehicle& vehicle_profile(const std::string& name);

}  // namespace skycap::flight
