/// A depth camera's flight. For the sources of this room.
#pragma once

#include "geometry/io/output_folder.h"
#include "missions/cli/verbs.h"
#include "missions/config/mission_setup.h"
#include "missions/config/sensor_reader.h"

namespace skycap::missions::cli {

/// Takes its images and commits them; returns the exit code.
int scan_with_camera(const ScanVerbOptions& options, const config::MissionSetup& setup,
                     const config::SensorDescription& sensor, geometry::OutputFolder& folder,
                     const Console& console);

}  // namespace skycap::missions::cli
