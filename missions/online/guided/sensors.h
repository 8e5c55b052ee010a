/// Where the scans of a flown survey come from.
#pragma once

#include <filesystem>
#include <stop_token>

#include "flight/flight_options.h"
#include "missions/online/guided/live_flight.h"
#include "missions/online/live/live_options.h"
#include "missions/online/live/scan_input.h"

namespace skycap::missions::online {

/// Scans that another program leaves in a folder. For scan 7 the file scan-0007.pose is written, in
/// one line as parse_pose_text() reads it, when the vehicle is at rest at the view; the
/// scan is the file scan-0007.EXT that then appears (.ply, .pcd, .las, .laz, .e57, .xyz or .png),
/// in the sensor's optical frame, which gets that name when it is whole. `input` says how depth
/// images are read. The sensor gives up when the stop is requested or after `patience` [s] by the
/// clock on the wall, with Error{bad_file}. Throws that, too, if the folder is none.
Sensor folder_sensor(const flight::FlightOptions& flight, const LiveOptions& live,
                     const std::filesystem::path& folder, ScanInput input, double patience,
                     std::stop_token stop);

}  // namespace skycap::missions::online
