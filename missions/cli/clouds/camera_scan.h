/// Simulated scan with a depth camera. Private to missions/cli/clouds.
#pragma once

#include "geometry/io/output_folder.h"
#include "missions/cli/commands.h"
#include "missions/config/mission_setup.h"
#include "missions/config/sensor_reader.h"

namespace skycap::missions::cli {

/// Records and commits the depth images of a flight. Returns the exit code.
int scan_with_camera(const ScanCommandOptions& options, const config::MissionSetup& setup,
                     const config::SensorDescription& sensor, geometry::OutputFolder& folder,
                     const Console& console);

}  // namespace skycap::missions::cli
