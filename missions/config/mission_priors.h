/// What follows from a mission's prior data: maps, models, terrain and earlier scans of its site.
#pragma once

#include <memory>

#include "missions/config/mission_reader.h"
#include "missions/config/report.h"
#include "missions/site_data/site_priors.h"
#include "survey/skycap/prior_surface.h"

namespace skycap::missions::config {

/// Checks the keys of `prior`, makes its paths absolute, for the package holds the mission
/// elsewhere, and reads its files into mission.priors; `report` is told which it is at. Throws
/// Error{bad_config} as MissionFile::refuse(), naming the key of the source.
void read_priors(config::MissionFile& given, const Report& report = {});

/// planner.scene_box where the mission has none but targets: around them, with 3 m on every side,
/// or half of the way to the nearest neighbour that the sensor sees, if that is less, or what they
/// may be off, if that is more. Where views are taken from must not be in it: there nothing is free
/// before it is measured.
void derive_scene_box(config::Mission& mission);

/// z below which everything is solid: the scene's, or of a terrain its lowest place less what that
/// may be off, if it is lower.
double ground_height_of(const config::Mission& mission);

/// z of the ground at a place: with terrain as legs keep off it, known or taken to be there; else
/// the scene's.
double ground_at(const config::Mission& mission, const Eigen::Vector2d& place);

/// Whether what the mission's sensor measures in simulation is prior data: of the role truth, or,
/// if scene.model is "prior", the targets.
bool is_truth_prior(const config::Mission& mission);

/// That, as one mesh. Empty if the mission's truth is none of its prior data.
geometry::Mesh prior_truth(const config::Mission& mission);

/// Whether the mission has a target, or something in the way, among its prior data.
bool has_target(const config::Mission& mission);
bool has_obstacle(const config::Mission& mission);

/// What stands beside the truth by prior data in the way, as one mesh: all that has a surface but
/// for what is a target or the truth, too. Empty unless the mission's sensor is to see it.
geometry::Mesh prior_neighbours(const config::Mission& mission);

/// The surfaces of the mission's targets for its planner to guess by; null without any.
std::shared_ptr<const survey::skycap::PriorSurface> prior_surface(const config::Mission& mission);

/// The mission's prior data; none of it if it has none.
const site_data::SitePriors& priors_of(const config::Mission& mission);

}  // namespace skycap::missions::config
