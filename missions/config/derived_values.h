/// Values that resolve() and the cross-key checks derive from several keys of a document. Each
/// function requires that the keys it depends on are already completed, in the order of resolve().
#pragma once

#include <cstddef>
#include <optional>

#include <Eigen/Geometry>

#include "flight/flight_options.h"
#include "geometry/pose/pose.h"
#include "missions/config/mission_document.h"
#include "survey/planners/planner_options.h"
#include "survey/view_limits.h"

namespace skycap::missions::config {

/// Returns whether the document has a georeference (latitude and longitude).
bool is_georeferenced(const MissionDocument& document);

/// Returns the georeference of the frame's origin, or 0° N 0° E if the document has none.
flight::Site make_site(const MissionDocument& document);

/// Returns the settings of SEE and SEE++, including the sampling settings shared by all planners.
survey::see::SeeConfig see_config(const MissionDocument& document);

/// Returns the distance [m] within which stored points must cover a surface so that their mean
/// density is at least planner.density_per_m2, or infinity without that key. A covering of a plane
/// by discs of radius R has at least 2 / (3 sqrt(3) R^2) discs per area. Source: Kershner, The
/// Number of Circles Covering a Set, American Journal of Mathematics 61, 1939.
double compute_density_distance(const MissionDocument& document);

/// Returns rho [1/m^3] for planner.density_per_m2 n, with which SEE and SEE++ require n points per
/// m^2 in a disc of radius r: k = 4/3 pi r^3 rho = n pi r^2. Requires the key.
double compute_volume_density(const MissionDocument& document);

/// Returns the distance [m] within which the planner skycap plans a stored point of each position:
/// evaluation.coverage_distance or compute_density_distance(), whichever is smaller.
double compute_planned_distance(const MissionDocument& document);

/// Returns epsilon, the point spacing [m]: planner.spacing, or rho^(-1/2) if the key is missing.
double compute_spacing(const MissionDocument& document);

/// Returns the distance between views and surfaces [m]: planner.view_distance, or else the distance
/// at which the sensor's pixel density equals planner.density.
double compute_view_distance(const MissionDocument& document);

/// Returns the box in which unobserved space is treated as occupied; an empty box disables this.
Eigen::AlignedBox3d compute_unknown_box(const MissionDocument& document);

/// Returns the z [m] below which everything is solid. This is the scene's base height, or the
/// minimum terrain height minus its uncertainty if that is lower.
double compute_ground_height(const MissionDocument& document);

/// Returns the minimum z of a view [m] according to limits.ground_clearance, if that key is set.
std::optional<double> min_view_height(const MissionDocument& document);

/// Combines the view limits of `site`, `limits` and the vehicle. Heights are z in the mission frame
/// [m].
survey::ViewLimits view_limits(const MissionDocument& document);

/// Returns the maximum number of views. For volumetric planners it is limited by V as well.
std::size_t view_limit(const MissionDocument& document);

/// Return whether the prior data contains a target or an obstacle, respectively.
bool has_target(const MissionDocument& document);
bool has_obstacle(const MissionDocument& document);

/// Returns whether the outline of the pattern is the target, because the mission uses targets as
/// ground truth and has no prior data.
bool has_outline_as_truth(const MissionDocument& document);

/// Returns the role of the prior data used as ground truth instead of scene.model. It is `truth`,
/// or `target` if scene.model is "prior"; nullopt if scene.model provides the scene.
std::optional<site_data::Role> truth_role(const MissionDocument& document);

flight::FlightOptions flight_options(const MissionDocument& document);

/// Returns the planner's options, including the view limits and, for the planner skycap, the prior
/// surface.
survey::PlannerOptions planner_options(const MissionDocument& document,
                                       const flight::FlightOptions& flight);

session::StartOptions start_options(const MissionDocument& document,
                                    const flight::FlightOptions& flight);

}  // namespace skycap::missions::config
