/// How a laser scanner is commanded by the formats of route files.
///
/// What a vehicle carries is the payload of its WPML codes. DJI's documentation of WPML (common
/// elements, edition of 2022) has the number of the Zenmuse L1, the camera types of its Payload SDK
/// that of the L2, which the former does not list.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "flight/export/export.h"
#include "flight/export/flight_plan.h"

namespace skycap::flight {

inline constexpr int zenmuse_l1 = 90742, zenmuse_l2 = 84;
inline constexpr int psdk_payload = 65534;  ///< not of DJI: no file commands it

/// The name of the scanner with that payload number that files can command; empty for all others.
std::string commanded_scanner(int payload);

/// The IMU calibration of DJI's scanners: back and forth so often at both ends of the recording,
/// over at most so much of the first and last straight leg (DJI Pilot 2's own: three times 30 m).
inline constexpr int calibration_turns = 3;
inline constexpr double calibration_length = 30.0, min_calibration_length = 10.0;  ///< [m]

/// Where a scanner looks that is fixed to the vehicle.
struct ScannerAim {
  double azimuth = 0.0;   ///< of its optical axis, anticlockwise from the vehicle's nose [rad]
  double pitch = 0.0;     ///< of its optical axis, 0 at the horizon [rad]
  bool is_moving = true;  ///< measures in flight, else at stops
};

/// The plan as files of this format hold it for a scanner.
///
/// KMZ and a scanner that files can command: the vehicle's heading is that of the scanner's optical
/// axis, so that the gimbal needs no yaw of its own, and the gimbal has the axis's pitch; it
/// records from the first waypoint to the last one; before and after that the vehicle calibrates
/// its IMU on verified legs, as far as `energy_left` [J] allows. Other formats cannot command such
/// a scanner, nor can KMZ one that measures at stops: Error{bad_config} names it. Scanners that
/// record by themselves are left to the pilot, with a note. Formats for maps and set-point
/// followers command nothing: their plan is unchanged.
FlightPlan with_scanner_commands(FlightPlan plan, Format format, const ScannerAim& aim,
                                 double energy_left, std::vector<std::string>& notes);

/// Between which waypoints a commanded scanner records: from the last one at the place of the first
/// before any station, to the first one at the place of the last behind all stations.
struct RecordedWaypoints {
  std::size_t first = 0, last = 0;
};
RecordedWaypoints recorded_waypoints(const FlightPlan& plan);

}  // namespace skycap::flight
