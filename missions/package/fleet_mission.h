/// Division of a finished survey among several vehicles.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/fleet/fleet_bound.h"
#include "flight/flight_options.h"
#include "flight/route/route.h"
#include "geometry/io/output_folder.h"
#include "missions/package/fleet/timetable_file.h"
#include "missions/package/flight_files.h"

namespace skycap::missions::package {

/// Vehicle of a fleet with its verified route. The route has no capture points if none are assigned
/// to the vehicle.
struct FleetMember {
  /// Flight options of this vehicle, see FlightOptions::for_vehicle().
  flight::FlightOptions flight;
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  flight::Route route;
  FlightFiles files;
};

struct FleetMission {
  std::vector<FleetMember> members;  ///< Vehicles with their routes.
  /// Sorties of all vehicles, in order of vehicle and sortie.
  std::vector<package::TimetableRow> timetable;
  std::vector<flight::Unreached> unreached;  ///< Stations that none of the vehicles can reach.
  double makespan = 0.0;           ///< Time from the first take-off to the last landing [s].
  double total_flight_time = 0.0;  ///< Total flight time of all vehicles [s].
  double delay = 0.0;              ///< Delay of the last landing caused by the separation [s].
  /// Lower bound for all fleets with such legs, see flight::VerifiedCosts.
  flight::FleetBound bound;
  flight::FleetBound lower_bound;  ///< Lower bound for all fleets, independent of the legs.
  /// Verified minimum distance between vehicles at all times, limited to reported_distance [m].
  double distance = 0.0;
};

/// Upper limit of reported distances between vehicles [m].
inline constexpr double reported_distance = 100.0;

/// Division that is set by the caller: indices of capture points per vehicle, in flight order.
using FleetOrders = std::vector<std::vector<std::uint32_t>>;

/// Divides the capture points of `alone`, the verified route of the first vehicle, among the
/// vehicles. The division is based on the costs of verified legs. Each vehicle's route is planned
/// and verified like in plan_flight(). Take-offs are delayed until the separation of all flights is
/// verified. With `orders`, the division is that of the caller, and each vehicle flies its capture
/// points in this order or in reverse; those that it cannot reach are listed by its route. Throws
/// all errors of plan_route(). Throws Error{bad_config} if the capture points cannot be divided, or
/// if a vehicle violates the clearance to one on the ground.
FleetMission plan_fleet(const flight::FlightOptions& options, const flight::FreeSpace& measured,
                        const flight::Route& alone,
                        std::span<const flight::LandingSurface> landing_surfaces, unsigned threads,
                        const std::stop_token& stop = {}, const FleetOrders* orders = nullptr);

/// Stages the timetable and the route files of each vehicle, see staged_fleet().
void stage_fleet(const std::string& name, FleetMission& fleet, const flight::FreeSpace& measured,
                 std::span<const flight::Format> formats, geometry::OutputFolder& folder);

/// Plans the fleet mission like plan_fleet(), and stages its timetable and the route files of each
/// vehicle. The files are in `formats` and in the native format of the vehicle's autopilot. Without
/// `formats`, package_formats() is used. `name` is the name of the mission.
std::shared_ptr<const FleetMission> staged_fleet(
    const std::string& name, const flight::FlightOptions& options,
    const flight::FreeSpace& measured, const flight::Route& alone,
    std::span<const flight::LandingSurface> landing_surfaces,
    std::span<const flight::Format> formats, geometry::OutputFolder& folder, unsigned threads,
    const std::stop_token& stop = {});

}  // namespace skycap::missions::package
