/// Sampled flights as text: position, yaw and pitch of the camera at equal intervals of time.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "survey/inspection/smooth_route.h"

namespace skycap::missions::inspection {

/// Returns CSV with the header `t,x,y,z,yaw,pitch` after comment lines that state the meaning. Time
/// is in seconds from the start, position in metres in the mission frame. Yaw is counter-clockwise
/// from east (+x) and continuous. Pitch is 0 at the horizon and positive upwards [rad].
std::string write_flight_csv(std::span<const survey::inspection::FlightSample> flight);

/// Reads a flight of any program: six numbers per line in the order t x y z yaw pitch, separated by
/// commas, semicolons or blanks. Lines that start with '#' and one header line are skipped. Throws
/// Error{bad_file} with the line of the first fault.
std::vector<survey::inspection::FlightSample> read_flight_csv(const std::filesystem::path& file);

}  // namespace skycap::missions::inspection
