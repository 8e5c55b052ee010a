/// A flight that is measured in pieces, here or as the tasks of an engine. For the sources of this
/// room.
#pragma once

#include <filesystem>

#include "missions/cli/verbs.h"
#include "missions/config/mission_setup.h"
#include "missions/config/sensor_reader.h"

namespace skycap::missions::cli {

/// Does with the pieces of a laser scanner's flight what the options say; returns the exit code.
/// `out` is the folder of the results.
int split_scan(const ScanVerbOptions& options, const config::MissionSetup& setup,
               const config::SensorDescription& sensor, const std::filesystem::path& out,
               const Console& console);

}  // namespace skycap::missions::cli
