/// Inspection mission: a continuous flight around a known structure, verified against prior data.
#pragma once

#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "missions/config/mission_setup.h"
#include "missions/inspection/inspection_flight.h"
#include "missions/inspection/inspection_package.h"
#include "missions/inspection/inspection_site.h"
#include "survey/inspection/flight_evaluation.h"
#include "survey/inspection/inspection_planner.h"

namespace skycap::missions::inspection {

struct InspectionMission {
  survey::inspection::InspectionOptions options;
  survey::inspection::InspectionPlan plan;
  /// Flight with waypoints. Empty: it cannot be flown so, for the reason in `flight_failure`.
  std::optional<InspectionFlight> flight;
  std::string flight_failure;
  std::vector<std::string> warnings;  ///< Warnings for the user, displayed last.
  bool is_edited = false;             ///< Along given corners, without a search.
};

/// Plans the flight of a mission whose document is an inspection. Throws the errors of
/// survey::inspection::plan_inspection(). `report` receives progress messages.
InspectionMission plan_inspection_mission(const config::MissionSetup& setup,
                                          const InspectionSpace& space, const std::stop_token& stop,
                                          const std::function<void(const std::string&)>& report);

/// Planned inspection whose corners have been changed.
struct EditedInspection {
  InspectionMission mission;
  /// Empty: the flight is verified.
  std::vector<survey::inspection::FlightProblem> problems;
  std::size_t slowed_legs = 0;  ///< Legs that are flown more slowly, to keep the motion limits.
  double added_delay = 0.0;     ///< Sum over all legs [s].
};

/// Verifies and evaluates the flight along `corners` with the mission of `package`, and plans its
/// route with waypoints. If the package has a route, its absence is a problem.
EditedInspection plan_edited_inspection(const InspectionPackage& package,
                                        std::vector<survey::inspection::Vertex> corners,
                                        const std::stop_token& stop,
                                        const std::function<void(const std::string&)>& report);

/// Evaluates a flight of any program with the camera, the limits and the structure of a mission.
struct InspectionEvaluation {
  survey::inspection::FlightEvaluation flight;
  double clearance = 0.0;           ///< Distance from all obstacles of the mission [m].
  double required_clearance = 0.0;  ///< [m]
  bool keeps_clearance() const { return clearance >= required_clearance; }
};
InspectionEvaluation evaluate_inspection(const config::MissionSetup& setup,
                                         const InspectionSpace& space,
                                         std::span<const survey::inspection::FlightSample> flight);

}  // namespace skycap::missions::inspection
