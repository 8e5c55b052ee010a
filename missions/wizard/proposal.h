/// Proposes a complete first mission for a site, with a comment on each value.
#pragma once

#include <filesystem>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/motion/vehicle.h"
#include "missions/wizard/mission_text.h"
#include "missions/wizard/site_request.h"

namespace skycap::missions::wizard {

/// Returns the text of a mission to be written to `file`. It proposes the target, prior data, pad,
/// geofence, unknown box, sensor and view distance. The scene is the target, for a dry run. Throws
/// Error{bad_config} if the target is not found, if the files have no georeference, or if no pad is
/// possible within 100 m of the target. Throws the errors of config::parse_mission().
std::string propose_mission(const SiteRequest& request, const std::filesystem::path& file);

/// Minimum clearance of the mission of a site [m].
inline constexpr double proposed_clearance = 2.0;

/// Returns the clearance that a vehicle requires [m], rounded up to a multiple of 0.5 m: its
/// radius, the errors, and a margin of at least 0.5 m that covers its overshoot at stops.
double compute_min_clearance(const flight::Vehicle& vehicle);

/// Derives values from a target's box and the `uncertainty` of its position [m]: unknown box,
/// coverage distance, view distance and geofence. Without terrain, the ground is at z = 0. With
/// terrain, the unknown box extends below the target, because the ground may descend next to it.
MissionValues values_for(MissionValues values, const Eigen::AlignedBox3d& target,
                         double uncertainty, bool has_terrain);

/// Returns the values with a pad and with the geofence extended around it.
MissionValues with_pad(MissionValues values, const Eigen::Vector3d& pad);

/// Returns the z at which climbs from pads end [m], the clearance below the fence's ceiling.
double compute_max_climb_altitude(const MissionValues& values);

}  // namespace skycap::missions::wizard
