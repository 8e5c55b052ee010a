/// A finished survey as a mission that several vehicles fly together.
#pragma once

#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/fleet/fleet_bound.h"
#include "flight/flight_options.h"
#include "flight/route/route.h"
#include "flight/space/measured_space.h"
#include "geometry/io/output_folder.h"
#include "missions/package/fleet/timetable_file.h"
#include "missions/package/flight_files.h"

namespace skycap::missions::package {

/// One vehicle, and its certified route; a route without stations if nothing is left for it.
struct FleetMember {
  flight::FlightOptions flight;  ///< its own, see FlightOptions::of_vehicle()
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  flight::Route route;
  FlightFiles files;
};

struct FleetMission {
  std::vector<FleetMember> members;              ///< by vehicle
  std::vector<package::TimetableRow> timetable;  ///< by vehicle and sortie
  std::vector<flight::Unreached> unreached;      ///< by any of them
  double makespan = 0.0;     ///< from the first take-off to the last landing [s]
  double flown = 0.0;        ///< all together in the air [s]
  double delay = 0.0;        ///< of the last landing, for the separation's sake [s]
  flight::FleetBound bound;  ///< of all fleets on legs like these, see flight::CertifiedCosts
  flight::FleetBound least;  ///< of all fleets whatever their legs
  double distance = 0.0;     ///< proven between any two at all times, at most reported_distance [m]
};

/// Distances between vehicles are reported up to this [m].
inline constexpr double reported_distance = 100.0;

/// Shares the stations of `alone`, the certified route of the first vehicle, among the mission's
/// fleet, by what certified legs take. Every vehicle's route is planned and certified as
/// plan_flight() does it; starts are put off until all flights are proven to keep apart. Throws
/// what plan_route() throws, and Error{bad_config} if the stations cannot be shared out or if a
/// vehicle flies too low over where another one stands.
FleetMission plan_fleet(const flight::FlightOptions& options, const flight::MeasuredSpace& measured,
                        const flight::Route& alone, std::span<const flight::PadGround> grounds,
                        unsigned threads, const std::stop_token& stop = {});

/// The same with every vehicle's route files in these formats and its own autopilot's (without
/// `formats`: in package_formats() of each), and the timetable, staged. `name` is the mission's.
std::shared_ptr<const FleetMission> staged_fleet(
    const std::string& name, const flight::FlightOptions& options,
    const flight::MeasuredSpace& measured, const flight::Route& alone,
    std::span<const flight::PadGround> grounds, std::span<const flight::Format> formats,
    geometry::OutputFolder& folder, unsigned threads, const std::stop_token& stop = {});

}  // namespace skycap::missions::package
