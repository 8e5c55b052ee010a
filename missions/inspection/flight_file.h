/// Flights as text: samples of position, yaw and pitch of the camera at equal intervals of time,
/// and the corners of the polygon that a flight smooths.
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

/// Returns CSV with the header `x,y,z,heading_deg,gimbal_pitch_deg,delay_s`: metres in the mission
/// frame, degrees clockwise from north and above the horizon, and the delay of the leg to the next
/// corner.
std::string write_corners_csv(std::span<const survey::inspection::Vertex> corners);

/// Returns true if the first line of a file is the header of write_corners_csv().
bool is_corner_file(const std::filesystem::path& file);

/// Reads the file of write_corners_csv(). Throws Error{bad_file} with the line of the first fault,
/// and if it contains no corner.
std::vector<survey::inspection::Vertex> read_corners_csv(const std::filesystem::path& file);

}  // namespace skycap::missions::inspection
