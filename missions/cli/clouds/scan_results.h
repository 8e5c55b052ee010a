/// Functions shared by laser and camera scans. Private to missions/cli/clouds.
#pragma once

#include <nlohmann/json.hpp>

#include "geometry/io/output_folder.h"
#include "missions/cli/commands.h"
#include "missions/config/sensor_reader.h"
#include "missions/scan/scan_flight.h"
#include "missions/scan/scan_journal.h"
#include "missions/scene/sensed_scene.h"

namespace skycap::missions::cli {

/// File name of the scan summary.
inline constexpr const char* scan_name = "scan.json";

/// Returns the flight along the route from the options or the mission keys. `seed` is the seed of
/// the navigation errors.
scan::ScanFlight make_scan_flight(const ScanCommandOptions& options,
                                  const scan::ScanFlightOptions& scan, std::uint64_t seed,
                                  scan::Platform platform);

/// Returns the inputs that identify a scan: sensor description, scene and flight.
nlohmann::ordered_json make_identity(const config::SensorDescription& sensor,
                                     const scene::SensedScene& scene,
                                     const scan::ScanFlight& flight);

/// Starts a journal, or reopens that of an interrupted scan if `resumes` is set. Returns the state
/// of the last checkpoint, or null for a new scan.
nlohmann::ordered_json open_journal(scan::ScanJournal& journal, bool resumes,
                                    const ScanCommandOptions& options, const support::Identity& run,
                                    const nlohmann::ordered_json& identity, const Console& console);

/// Commits a scan. An incomplete scan does not overwrite a complete one but is committed to the
/// subfolder `interrupted`.
void commit_scan(geometry::OutputFolder& folder, bool is_complete);

}  // namespace skycap::missions::cli
