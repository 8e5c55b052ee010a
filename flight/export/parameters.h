/// Parameter files for settings that mission items cannot contain, in particular the return
/// altitude.
///
/// ArduPilot reads "NAME,VALUE" lines (Mission Planner, MAVProxy, QGroundControl) with "#"
/// comments. Version 4.7 renamed parameters and changed centimetres to metres. Since unknown names
/// are ignored, files contain both names. PX4 uses QGroundControl's format
/// "1<TAB>1<TAB>NAME<TAB>VALUE<TAB>TYPE" with type 6 for integers and 9 for floats. QGroundControl
/// rejects a value of a different type.
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

/// Returns the file name that ground stations expect: "mission.param" for ArduPilot,
/// "mission.params" for PX4, or with a different stem. Empty for DJI, whose missions contain their
/// settings.
std::string parameters_name(AutopilotType autopilot, const std::string& stem = "mission");

/// Returns the settings for the plan's vehicle: return, speeds, fence and failsafes. Comments list
/// the upload order. Throws Error{bad_config} for DJI vehicles, and if the plan has no verified
/// returns.
std::string write_parameters(const FlightPlan& plan);

/// Reads a parameter file of either format. Throws Error{bad_file} with the first line that is
/// neither a comment nor a parameter.
std::vector<Parameter> read_parameters(const std::string& text);

/// Returns the return altitude above home that the parameters specify [m], or std::nullopt.
std::optional<double> return_height(const std::vector<Parameter>& parameters,
                                    AutopilotType autopilot);

/// Returns the parameters that make the autopilot's return differ from RtlProfile, such as
/// "RTL_CONE_SLOPE is 3; it must be 0". A missing parameter has its default value.
Problems return_problems(const std::vector<Parameter>& parameters, AutopilotType autopilot);

/// Returns a return altitude [m] for files and summaries without rounding, such as "62" or "42.7".
/// Rounded to whole metres, it could exceed a ceiling or undercut the verified altitude.
std::string return_altitude_text(double height);

}  // namespace skycap::flight
