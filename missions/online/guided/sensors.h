/// Sources of the scans of a flown survey.
#pragma once

#include <filesystem>
#include <stop_token>

#include "flight/flight_options.h"
#include "missions/online/guided/live_flight.h"
#include "missions/online/live/live_options.h"
#include "missions/online/live/scan_input.h"

namespace skycap::missions::online {

/// Returns a sensor that reads scans which another program writes to `folder`. For scan 7, the
/// sensor writes scan-0007.pose when the vehicle is at rest at the view. The file has one line in
/// the format of parse_pose_text().
///
/// The other program then writes scan-0007.EXT (.ply, .pcd, .las, .laz, .e57, .xyz or .png) in the
/// sensor's optical frame. It must rename the file to that name only when the file is complete.
/// `input` specifies how depth images are read.
///
/// The sensor throws Error{bad_file} after a stop request or after `patience` seconds of real time.
/// Throws Error{bad_file} if `folder` is not a folder.
Sensor folder_sensor(const flight::FlightOptions& flight, const LiveOptions& live,
                     const std::filesystem::path& folder, ScanInput input, double patience,
                     std::stop_token stop);

}  // namespace skycap::missions::online
