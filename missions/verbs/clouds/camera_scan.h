/// A depth camera's flight. For the sources of this room.
#pragma once

#include "geometry/io/output_folder.h"
#include "missions/equipment/sensor_reader.h"
#include "missions/file/mission.h"
#include "missions/verbs/verbs.h"

namespace skycap::missions::verbs {

/// Takes its images and commits them; returns the exit code.
int scan_with_camera(const ScanVerbOptions& options, const file::Mission& mission,
                     const equipment::SensorDescription& sensor, geometry::OutputFolder& folder,
                     const Console& console);

}  // namespace skycap::missions::verbs
