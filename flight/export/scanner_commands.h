/// Commands for laser scanners in the formats of route files.
///
/// WPML identifies the payload of a vehicle by a number. Source for the Zenmuse L1: DJI's WPML
/// documentation, common elements, edition of 2022. Source for the L2, which that page does not
/// list: the camera types of DJI's Payload SDK.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "flight/export/export.h"
#include "flight/export/flight_plan.h"

namespace skycap::flight {

inline constexpr int zenmuse_l1 = 90742, zenmuse_l2 = 84;
inline constexpr int psdk_payload = 65534;  ///< Payload of another maker. Files cannot command it.

/// Returns the name of the scanner with that payload number, or an empty string if files cannot
/// command it.
std::string commanded_scanner(int payload);

/// Number of flights back and forth in each IMU calibration of DJI's scanners, at the start and at
/// the end of the recording. DJI Pilot 2 uses the same number.
inline constexpr int calibration_turns = 3;
inline constexpr double calibration_length = 30.0,
                        min_calibration_length = 10.0;  ///< Maximum and minimum length [m].

/// Orientation of a scanner that is fixed to the vehicle.
struct ScannerAim {
  double azimuth =
      0.0;  ///< Azimuth of the optical axis, counter-clockwise from the vehicle's nose [rad].
  double pitch = 0.0;  ///< Pitch of the optical axis, 0 at the horizon [rad].
  bool is_moving =
      true;  ///< True if the scanner measures in flight, false if it measures at stops.
};

/// Returns the plan with the commands for a scanner that files of this format require.
///
/// With KMZ and a scanner that files can command, the vehicle's heading and the gimbal's pitch are
/// those of the optical axis. The gimbal therefore needs no yaw of its own. The scanner records
/// from the first to the last waypoint. Before and after the recording, the vehicle calibrates the
/// IMU on verified legs if `energy_left` [J] is sufficient. Otherwise a note asks the pilot to do
/// it. Throws Error{bad_config} with the scanner's name if the format cannot command it, or if it
/// measures at stops. For other scanners, a note asks the pilot to start the recording. Formats for
/// maps and set-point followers contain no commands. Their plan is returned unchanged.
FlightPlan with_scanner_commands(FlightPlan plan, Format format, const ScannerAim& aim,
                                 double energy_left, std::vector<std::string>& notes);

/// Waypoints between which a commanded scanner records: from the last waypoint at the first
/// position, before any capture point, to the first one at the last position, after all capture
/// points.
struct RecordedWaypoints {
  std::size_t first = 0, last = 0;
};
RecordedWaypoints recorded_waypoints(const FlightPlan& plan);

}  // namespace skycap::flight
