/// Whether the home and the rally points that a mission file states are those of the mission.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "flight/export/mavlink_files.h"
#include "flight/interpreter/flight_facts.h"

namespace skycap::flight {

/// The file's home is what the pilot sees; relative heights count from the real one. `pad`: where
/// the file takes off, nothing if it does not. A file without a home has no problems.
Problems check_home(const MissionFile& file, const std::optional<Eigen::Vector3d>& pad,
                    const FlightFacts& facts);

/// Returns go to the nearest rally point: those of the file must be those that are proven, at
/// home's height, which the return altitude counts from.
Problems check_rally(const MissionFile& file, const FlightFacts& facts);

}  // namespace skycap::flight
