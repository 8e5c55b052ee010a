/// A first mission file for a site: it runs as it is, and says of each value what it is for.
#pragma once

#include <filesystem>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "missions/wizard/mission_text.h"
#include "missions/wizard/wishes.h"

namespace skycap::missions::wizard {

/// The text of a mission that is to be written to `file`: the target, the prior data, where the
/// pad, the fence and the space that nobody knows are proposed to be, a sensor, and how closely it
/// is looked at. Its scene is the target, for a dry run. Throws Error{bad_config} if the target is
/// not found, if the files do not say where they are, or if there is no room for a pad within 100 m
/// of the target; what config::parse_mission() throws.
std::string propose_mission(const Wishes& wishes, const std::filesystem::path& file);

/// What is in the way of flying a proposed mission keeps so far from it at least [m].
inline constexpr double proposed_clearance = 2.0;

/// The values with what follows from the place of a target that may be off by `uncertainty`: the
/// space around it that nobody knows, how closely and from where it is looked at, a fence around
/// all that. Without terrain the ground is at z = 0; on terrain it may fall away beside the target.
MissionValues values_for(MissionValues values, const Eigen::AlignedBox3d& target,
                         double uncertainty, bool has_terrain);

/// The values with a pad, and the fence around that, too.
MissionValues with_pad(MissionValues values, const Eigen::Vector3d& pad);

/// Where climbs from pads end: under the fence's top.
double top_of_climbs(const MissionValues& values);

}  // namespace skycap::missions::wizard
