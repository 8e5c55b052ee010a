/// What scans of lasers and of cameras share. For the sources of this room.
#pragma once

#include <nlohmann/json.hpp>

#include "geometry/io/output_folder.h"
#include "missions/cli/verbs.h"
#include "missions/config/sensor_reader.h"
#include "missions/scan/scan_flight.h"
#include "missions/scan/scan_journal.h"
#include "missions/scene/sensed_scene.h"

namespace skycap::missions::cli {

/// The figures of a scan.
inline constexpr const char* scan_name = "scan.json";

/// The flight that the options or the mission's keys say; the seed is that of navigation errors.
scan::ScanFlight flown_by(const ScanVerbOptions& options, const scan::FlownScanOptions& scan,
                          std::uint64_t seed, scan::Carrier carrier);

/// What a scan is made of: the sensor's description, the scene, the flight.
nlohmann::ordered_json identity_of(const config::SensorDescription& sensor,
                                   const scene::SensedScene& scene, const scan::ScanFlight& flight);

/// Begins a scan, or goes on with an interrupted one (`resumes`) from what is returned.
nlohmann::ordered_json open_journal(scan::ScanJournal& journal, bool resumes,
                                    const ScanVerbOptions& options, const support::Identity& run,
                                    const nlohmann::ordered_json& identity, const Console& console);

/// Commits a scan; one that was interrupted goes beside a complete one instead of over it.
void commit_scan(geometry::OutputFolder& folder, bool is_complete);

}  // namespace skycap::missions::cli
