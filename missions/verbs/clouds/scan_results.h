/// What scans of lasers and of cameras share. For the sources of this room.
#pragma once

#include <nlohmann/json.hpp>

#include "geometry/io/output_folder.h"
#include "missions/equipment/sensor_reader.h"
#include "missions/file/mission.h"
#include "missions/recording/scan_flight.h"
#include "missions/recording/scan_journal.h"
#include "missions/scene/sensed_scene.h"
#include "missions/verbs/verbs.h"

namespace skycap::missions::verbs {

/// The figures of a scan.
inline constexpr const char* scan_name = "scan.json";

recording::ScanFlight flown_by(const ScanVerbOptions& options, const file::Mission& mission,
                               recording::Carrier carrier);

/// What a scan is made of: the sensor's description, the scene, the flight.
nlohmann::ordered_json identity_of(const equipment::SensorDescription& sensor,
                                   const scene::SensedScene& scene,
                                   const recording::ScanFlight& flight);

/// Begins a scan, or goes on with an interrupted one (`resumes`) from what is returned.
nlohmann::ordered_json open_journal(recording::ScanJournal& journal, bool resumes,
                                    const ScanVerbOptions& options, const file::Mission& mission,
                                    const nlohmann::ordered_json& identity, const Console& console);

/// Commits a scan; one that was interrupted goes beside a complete one instead of over it.
void commit_scan(geometry::OutputFolder& folder, bool is_complete);

}  // namespace skycap::missions::verbs
