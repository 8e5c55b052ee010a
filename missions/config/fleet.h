/// Several vehicles that share a mission: who they are, where they stand, what they keep apart.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "flight/fleet/separation.h"
#include "missions/config/mission.h"
#include "missions/config/mission_reader.h"

namespace skycap::missions::config {

/// Whether several vehicles share the mission.
bool is_fleet(const config::Mission& mission);

/// The fleet's pads: those given, or a row from the first one along the nearest side of the unknown
/// box, on the ground, a metre more than the separation apart, to either side in turn.
std::vector<Eigen::Vector3d> pads_of_fleet(const config::Mission& mission,
                                           const Eigen::Vector3d& first);

/// The mission as one of the fleet flies it, alone, from its pad, with its stations in the order
/// given.
config::Mission as_flown_by(const config::Mission& mission, std::size_t vehicle,
                            const Eigen::Vector3d& pad);

/// The mission with some of the fleet's vehicles, one at least, and with their pads.
config::Mission with_vehicles(config::Mission mission, const std::vector<std::size_t>& kept,
                              const std::vector<Eigen::Vector3d>& pads);

/// What is asked of any two of its flights.
flight::SeparationRule separation_of(const config::Mission& mission);

/// Has the first of the fleet's vehicles fly the survey; a fleet of one is none. Throws
/// Error{bad_config} as MissionFile::refuse() if keys about vehicles and pads contradict.
void lead_fleet(config::MissionFile& given);

/// What check_flight() asks of the first vehicle, of the others, too; and of all together that they
/// have a place on the Earth and a separation that holds their errors. Throws as lead_fleet().
void check_fleet(const config::MissionFile& given);

}  // namespace skycap::missions::config
