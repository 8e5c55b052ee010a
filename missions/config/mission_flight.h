/// What the flight layer needs to know of a mission, in its own terms.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/export/geodesy.h"
#include "flight/interpreter/flight_facts.h"
#include "flight/motion/picture_bounds.h"
#include "flight/motion/vehicle.h"
#include "flight/route/route.h"
#include "flight/space/measured_space.h"
#include "flight/space/obstacles.h"
#include "missions/config/mission.h"

namespace skycap::missions::config {

/// What flies the mission, which must be one that is flown.
const flight::Vehicle& vehicle_of(const config::Mission& mission);

/// The preset whose autopilot stands in where a file is written for another one than the
/// vehicle's own.
flight::Vehicle stand_in(flight::Dialect dialect);

/// The vehicle as that autopilot flies it: unchanged if it is its own, else with the stand-in's
/// mission mode, and codes if they are DJI's. Size, energy and gimbal stay the vehicle's.
flight::Vehicle flown_by(flight::Vehicle vehicle, flight::Dialect dialect);

/// The clearance's terms: the margin is what errors and vehicle leave of it.
flight::ClearanceBudget clearance_of(const config::Mission& mission);

/// Where space must be measured to be free.
Eigen::AlignedBox3d unknown_box_of(const config::Mission& mission);

/// Further boxes where it must.
std::vector<Eigen::AlignedBox3d> unknown_beside_of(const config::Mission& mission);

/// Whether a survey may begin there: outside of those boxes and off what prior data knows, with
/// room to spare; or with nothing flown.
bool is_in_known_airspace(const config::Mission& mission, const Eigen::Vector3d& place);

/// Measured space before anything is measured.
flight::MeasuredSpaceConfig measured_space_of(const config::Mission& mission);

/// How the scans of a scanner that is flown prove space free; nothing if they do not: lines prove
/// nothing between them.
std::optional<flight::SweepRays> sweep_rays_of(const config::Mission& mission);

/// What holds whatever is measured: the ground, no-fly volumes, the geofence.
flight::Obstacles flight_rules(const config::Mission& mission);

/// The pad: as given, or on the ground beside the unknown box, as near to the first view as can be.
Eigen::Vector3d pad_of(const config::Mission& mission, const Eigen::Vector3d& first_view);

/// How far the vehicle climbs from the pad before its first leg.
double takeoff_climb_of(const config::Mission& mission);

/// The greatest z at which a height of return is looked for, of a vehicle whose pad is at `pad_z`:
/// over the unknown box, no-fly volumes and `obstacles_top`, under the greatest height that the
/// site allows.
double highest_return(const config::Mission& mission, double pad_z, double obstacles_top);

/// The autopilots that the mission's files are written for: a DJI vehicle's .plan and .waypoints
/// are for others.
std::vector<flight::Dialect> dialects_of(const flight::Vehicle& vehicle);

flight::RouteOptions route_options_of(const config::Mission& mission, const Eigen::Vector3d& pad);

/// Whether a laser scanner measures all the way, so that nothing is waited for at views.
bool scans_in_flight(const config::Mission& mission);

/// Rest at a view, before the capture and after it [s]: what the flight asks for, and no less than
/// the sensor needs.
double hold_of(const config::Mission& mission);
double hold_after_of(const config::Mission& mission);

/// How sharp its pictures are at the view distance; nothing for a laser scanner.
std::optional<flight::PictureBounds> picture_bounds_of(const config::Mission& mission);

/// Whether the mission says where on the Earth it is.
bool has_place(const config::Mission& mission);

/// The origin of the mission's frame; at 0 N 0 E if the mission has no place.
flight::Site site_of(const config::Mission& mission);

/// What the mission's route files must agree with. Where the pad is not given, heights above it
/// count from the foot of the scene. The views are not known.
flight::FlightFacts flight_facts(const config::Mission& mission);

}  // namespace skycap::missions::config
