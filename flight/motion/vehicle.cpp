#include "flight/motion/vehicle.h"

#include <cmath>

#include "geometry/error.h"
#include "geometry/requirement.h"

namespace skycap::flight {

const char* to_string(MissionApp app) {
  switch (app) {
    case MissionApp::fly:
      return "DJI Fly";
    case MissionApp::litchi:
      return "Litchi";
    default:
      return "DJI Pilot 2";
  }
}

void Vehicle::validate() const {
  const auto require = [&](bool holds, const std::string& field, double value,
                           const std::string& right) {
    skycap::require(holds && std::isfinite(value), "vehicle \"" + name + "\": " + field, value,
                    right);
  };
  const auto positive = [&](double value, const std::string& field) {
    require(value > 0.0, field, value, "positive");
  };
  positive(radius, "radius"), positive(max_speed, "max_speed");
  positive(gimbal_rate, "gimbal_rate");
  positive(mass, "mass"), positive(rotor_diameter, "rotor_diameter");
  positive(battery_wh, "battery_wh"), positive(endurance_min, "endurance_min");
  positive(rotors, "rotors"), positive(max_waypoints, "max_waypoints");
  require(avionics_power >= 0.0, "avionics_power", avionics_power, "zero or more");
  require(drag_area >= 0.0, "drag_area", drag_area, "zero or more");
  require(max_wind >= 0.0, "max_wind", max_wind, "zero or more");
  require(energy_error >= 0.0 && energy_error < 1.0, "energy_error", energy_error,
          "at least 0 and below 1");
  require(gimbal_min <= gimbal_max, "gimbal_min", gimbal_min, "at most gimbal_max");
  mode.validate(name);
}

double stop_overshoot(const Vehicle& vehicle) {
  return vehicle.autopilot == AutopilotType::ardupilot ? return_overshoot(vehicle.mode) : 0.0;
}

}  // namespace skycap::flight
