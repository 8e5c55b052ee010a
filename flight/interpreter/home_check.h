/// Consistency of the home position and rally points of a mission file with the mission.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "flight/export/mavlink_files.h"
#include "flight/interpreter/flight_facts.h"

namespace skycap::flight {

/// Returns the problems of the file's home, which the pilot sees, whereas relative heights refer to
/// the real home. `pad` is the take-off position of the file, or std::nullopt. A file without home
/// has no problems.
Problems check_home(const MavlinkMission& file, const std::optional<Eigen::Vector3d>& pad,
                    const FlightFacts& facts);

/// Returns the problems of the rally points. Since returns go to the nearest rally point, the file
/// must contain exactly the verified ones. They must be at the height of home, to which the return
/// altitude refers.
Problems check_rally(const MavlinkMission& file, const FlightFacts& facts);

}  // namespace skycap::flight
