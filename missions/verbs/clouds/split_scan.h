/// A flight that is measured in pieces, here or as the tasks of an engine. For the sources of this
/// room.
#pragma once

#include <filesystem>

#include "missions/equipment/sensor_reader.h"
#include "missions/file/mission.h"
#include "missions/verbs/verbs.h"

namespace skycap::missions::verbs {

/// Does with the pieces of a laser scanner's flight what the options say; returns the exit code.
/// `out` is the folder of the results.
int split_scan(const ScanVerbOptions& options, const file::Mission& mission,
               const equipment::SensorDescription& sensor, const std::filesystem::path& out,
               const Console& console);

}  // namespace skycap::missions::verbs
