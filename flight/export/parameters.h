/// Parameter files: what a mission's items cannot say, above all how high the vehicle returns.
///
/// ArduPilot reads "NAME,VALUE" lines (Mission Planner, MAVProxy, QGroundControl), with "#" before
/// comments. Version 4.7 has renamed parameters and changed centimetres to metres; an unknown name
/// is passed over, so the files hold both. PX4's are QGroundControl's: "1<TAB>1<TAB>NAME<TAB>VALUE
/// <TAB>TYPE", type 6 an integer and 9 a float; QGroundControl refuses a value of another type.
///
/// Sources: ArduPilot's ArduCopter/Parameters.cpp and mode_rtl.cpp, libraries/AC_WPNav, AC_Fence,
/// AP_BattMonitor, and the wiki's list of changed names; PX4's module parameters of navigator,
/// commander, mc_pos_control and flight_mode_manager; QGroundControl's ParameterManager.cc.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flight/export/flight_plan.h"
#include "flight/export/text.h"

namespace skycap::flight {

struct Parameter {
  std::string name;
  double value = 0.0;
};

/// "mission.param" for ArduPilot, "mission.params" for PX4, as their ground stations look for them,
/// or with another stem; empty for DJI's, whose missions carry their settings.
std::string parameters_name(Dialect dialect, const std::string& stem = "mission");

/// The settings for the plan's vehicle: return, speeds, fence, failsafes, and in comments what to
/// upload in which order. Throws Error{bad_config} for DJI's vehicles, and if the plan has no
/// certified returns.
std::string write_parameters(const FlightPlan& plan);

/// The values in either kind of file. Throws Error{bad_file} naming the first line that is neither
/// a comment nor a parameter.
std::vector<Parameter> read_parameters(const std::string& text);

/// How high the vehicle returns with these, above home; nothing if they do not say.
std::optional<double> return_height(const std::vector<Parameter>& parameters, Dialect dialect);

/// Parameters under which the autopilot would return in another way than ReturnLaw says, such as
/// "RTL_CONE_SLOPE is 3; it must be 0". A parameter that is missing is at its default.
Problems return_problems(const std::vector<Parameter>& parameters, Dialect dialect);

/// A return altitude [m] as files and summaries state it: in full, such as "62" and "42.7". Rounded
/// to whole metres it could be above a ceiling or below what is proven.
std::string return_altitude_text(double height);

}  // namespace skycap::flight
