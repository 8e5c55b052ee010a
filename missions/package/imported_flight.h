/// Verified flight along a route from another program or from a flown track, also of a fleet.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "flight/clearance/clearance.h"
#include "flight/flight_options.h"
#include "flight/flown/imported_route.h"
#include "flight/route/landing_surface.h"
#include "missions/package/fleet_mission.h"
#include "missions/package/flight_files.h"

namespace skycap::missions::package {

/// Waypoints at which the vehicle takes photos.
enum class ImportedCaptures {
  file,  ///< Where the file says so.
  all,
  none
};

struct ImportOptions {
  /// Maximum distance of a position from the simplified route [m]. Default: 0.5 m for tracks; a
  /// list of waypoints is not simplified.
  std::optional<double> tolerance;
  /// Legs that are not free go round the obstacle, and waypoints that are not free are skipped.
  /// False: the route is rejected.
  bool repairs = false;
  ImportedCaptures captures = ImportedCaptures::file;
};

inline constexpr double default_track_tolerance = 0.5;

/// Space in which a route is verified. The pointers must outlive the flight.
struct ImportSpace {
  const flight::FreeSpace* space = nullptr;     ///< Without the airspace rules.
  const flight::FreeSpace* over_pad = nullptr;  ///< For the climb; null: the airspace rules only.
  std::span<const flight::LandingSurface> landing_surfaces;
};

/// Leg of the route that the flight does not follow on a straight line.
struct ChangedLeg {
  std::string from, to;                 ///< Items of the file.
  double straight = 0.0, length = 0.0;  ///< Straight and flown length [m].
};

struct ImportedFlight {
  flight::ImportedRoute route;      ///< After simplification.
  std::size_t positions = 0;        ///< In the file.
  std::size_t on_pad = 0;           ///< Omitted positions of the climb and the landing.
  std::optional<double> tolerance;  ///< Tolerance of the simplification [m].
  double deviation = 0.0;  ///< Maximum distance of a position from the waypoints' legs [m].
  /// Legs and waypoints that are not verified, one sentence each. Empty: the flight is complete.
  std::vector<std::string> problems;
  std::size_t unverified_legs = 0;
  std::vector<ChangedLeg> changed;   ///< Legs that go round an obstacle, only with `repairs`.
  std::vector<std::string> skipped;  ///< Skipped waypoints, only with `repairs`.
  /// Empty if there are problems. The route of a fleet is that of its first vehicle with waypoints.
  std::optional<SurveyMission> mission;
  std::shared_ptr<FleetMission> fleet;  ///< Null for one vehicle.
};

/// Removes the climb and the landing from a route and simplifies it.
ImportedFlight simplify_import(flight::ImportedRoute route, const flight::FlightOptions& options,
                               const Eigen::Vector3d& pad, const ImportOptions& import);

/// Returns the capture points of the route, with straight paths between them. Unknown headings are
/// those of the legs. Unknown pitches are the nearest to the horizon that the gimbal can reach.
std::vector<flight::CapturePoint> import_capture_points(const flight::ImportedRoute& route,
                                                        const flight::FlightOptions& options,
                                                        ImportedCaptures captures);

/// Verifies the legs and plans the flight through the waypoints in their order, with take-off,
/// returns, energy and sorties. Positions are rounded in files: without repaired legs, the route
/// may be flight::rounding_bound closer than the clearance. Throws the errors of
/// flight::plan_route().
void plan_import(ImportedFlight& flight, const flight::FlightOptions& options,
                 const ImportSpace& space, const Eigen::Vector3d& pad, const ImportOptions& import,
                 const std::stop_token& stop);

/// Plans the flights of a fleet through the waypoints, each by the vehicle that the file names and
/// in its order. Without vehicles in the file, the waypoints are divided by plan_fleet(). Legs that
/// are not free go round the obstacles. Waypoints that a vehicle cannot reach are problems, or are
/// skipped with `repairs`. Throws Error{bad_file} for a vehicle that the fleet does not have, and
/// the errors of plan_fleet().
void plan_fleet_import(ImportedFlight& flight, const flight::FlightOptions& options,
                       const ImportSpace& space, const Eigen::Vector3d& pad,
                       const ImportOptions& import, unsigned threads, const std::stop_token& stop);

/// Returns the lines that the program prints about the route, and those of the flights of a fleet.
std::string import_text(const ImportedFlight& flight, const std::string& file,
                        const flight::FlightOptions& options);

}  // namespace skycap::missions::package
