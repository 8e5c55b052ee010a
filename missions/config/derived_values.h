/// Values that follow from several keys of a document that is being completed: for resolve() and
/// the checks across keys. Each is valid once what it follows from is, in the order of resolve().
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Geometry>

#include "flight/flight_options.h"
#include "geometry/place/pose.h"
#include "missions/config/mission_document.h"
#include "survey/planners/planner_options.h"
#include "survey/view_limits.h"

namespace skycap::missions::config {

/// Whether the document says where on the Earth it is.
bool has_place(const MissionDocument& document);

/// The origin of its frame; at 0 N 0 E if it has no place.
flight::Site site_of(const MissionDocument& document);

/// The settings of SEE and SEE++ with what every planner uses.
survey::see::SeeConfig see_config(const MissionDocument& document);

/// epsilon: as given, or rho^(-1/2).
double spacing_of(const MissionDocument& document);

/// From how far planners look at a surface: planner.view_distance, else where the sensor's pixels
/// are as dense as planner.density wants points.
double view_distance_of(const MissionDocument& document);

/// Where space must be measured to be free; empty: nowhere.
Eigen::AlignedBox3d unknown_box_of(const MissionDocument& document);

/// z below which everything is solid: the scene's, or of a terrain its lowest place less what that
/// may be off, if it is lower.
double ground_height_of(const MissionDocument& document);

/// The least z of a view that limits.ground_clearance allows; nothing without it.
std::optional<double> least_view_height(const MissionDocument& document);

/// The limits of site, limits and the vehicle together, heights as z in the mission's frame.
survey::ViewLimits view_limits(const MissionDocument& document);

/// The most views of a survey: the document's, and for volumetric planners V if that is less.
std::size_t view_limit(const MissionDocument& document);

/// Whether the document has a target, or something in the way, among its prior data.
bool has_target(const MissionDocument& document);
bool has_obstacle(const MissionDocument& document);

/// The role of the prior data that stands in for scene.model: truth, or the targets if scene.model
/// is "prior"; nothing if none does.
std::optional<site_data::Role> truth_role(const MissionDocument& document);

flight::FlightOptions flight_options(const MissionDocument& document);

/// With the limits and the prior surface.
survey::PlannerOptions planner_options(const MissionDocument& document,
                                       const flight::FlightOptions& flight);

session::StartOptions start_options(const MissionDocument& document,
                                    const flight::FlightOptions& flight);

}  // namespace skycap::missions::config
