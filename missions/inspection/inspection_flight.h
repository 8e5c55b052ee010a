/// Flight of an inspection as a mission with waypoints: from the take-off point to the start of the
/// planned curve, along the curve without stops, and back, in sorties of one battery each.
///
/// The waypoints are on the planned curve. Autopilots cut the corner at a waypoint that they pass.
/// flight::turn_distance() bounds the cut. The interpreter of the files (flight/interpreter)
/// verifies the clearance of all curves that this allows. Gimbal and heading follow the plan from
/// waypoint to waypoint.
#pragma once

#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "missions/inspection/inspection_site.h"
#include "missions/package/flight_files.h"
#include "survey/inspection/flight_evaluation.h"
#include "survey/inspection/inspection_planner.h"

namespace skycap::missions::inspection {

/// Maximum distance of the flown curve from the planned one, for which missions plan additional
/// clearance [m].
inline constexpr double flown_deviation = 0.2;

struct InspectionFlight {
  package::SurveyMission mission;  ///< Route with its files; the files are set when staged.
  Eigen::Vector3d pad = Eigen::Vector3d::Zero();
  std::size_t waypoints = 0;       ///< On the planned curve.
  double deviation_bound = 0.0;    ///< Maximum distance of the flown from the planned curve [m].
  double recorded_duration = 0.0;  ///< From the start to the end of all recordings [s].
  /// Points of the structure that the flown curve sees, with the aim that the autopilot commands.
  survey::inspection::PerRule<std::size_t> seen{};
};

/// Returns waypoints on a planned flight, with the aim of the camera and the time of each leg.
/// Straight legs between them are at most a quarter of flown_deviation from the flight.
std::vector<flight::CapturePoint> make_waypoints(
    std::span<const survey::inspection::FlightSample> flight);

/// Planned flight of a camera around a structure.
struct PlannedFlight {
  std::span<const survey::inspection::FlightSample> samples;
  const survey::inspection::StructureCloud& cloud;
  survey::inspection::InspectionCamera camera;
  double acceleration = 0.0;           ///< Maximum acceleration [m/s^2].
  std::optional<Eigen::Vector3d> pad;  ///< Take-off point. Empty: chosen beside the structure.
};

/// Plans the route of an inspection with verified legs and returns. Throws the errors of
/// flight::plan_route(), and Error{bad_geometry} if the vehicle cannot reach any waypoint.
InspectionFlight plan_inspection_flight(const config::MissionSetup& setup,
                                        const InspectionSpace& space, const PlannedFlight& planned,
                                        const std::stop_token& stop);

/// Throws Error{bad_geometry} if the autopilot's curve could be farther than `allowed` [m] from the
/// planned one.
void check_deviation(const InspectionFlight& flight, double allowed);

/// Returns the options of the flight: with stops at corners, in the order of the inspection.
flight::FlightOptions inspection_flight_options(const InspectionSpace& space);

/// Returns the formats that can express an inspection for an autopilot.
std::span<const flight::Format> inspection_formats(flight::AutopilotType autopilot);

/// Returns why a format with geodetic positions cannot command an inspection for any autopilot.
/// Empty: it can.
std::string unsupported_reason(flight::Format format);

}  // namespace skycap::missions::inspection
