#include "missions/inspection/inspection_mission.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "geometry/error.h"
#include "missions/config/inspection_rules.h"
#include "missions/config/mission_document.h"

namespace skycap::missions::inspection {
namespace {

using survey::inspection::incidence_rule;
using survey::inspection::InspectionOptions;
using survey::inspection::InspectionPlan;

/// Plans the flight with waypoints, or records the reason if no such flight is possible.
void plan_flight(const config::MissionSetup& setup, const InspectionSpace& space,
                 const std::optional<Eigen::Vector3d>& pad, const std::stop_token& stop,
                 InspectionMission& mission) {
  try {
    InspectionFlight flight =
        plan_inspection_flight(setup, space,
                               {mission.plan.samples, mission.plan.cloud, mission.options.camera,
                                mission.options.limits.acceleration, pad},
                               stop);
    check_deviation(flight, mission.options.flown_deviation);
    mission.flight = std::move(flight);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::bad_config && error.kind() != ErrorKind::bad_geometry) throw;
    mission.flight_failure = error.what();
  }
}

std::vector<std::string> make_warnings(const config::MissionSetup& setup,
                                       const InspectionMission& mission) {
  const InspectionPlan& plan = mission.plan;
  std::vector<std::string> warnings{
      "the airspace around the structure is assumed free. Check it for trees, wires and anything "
      "that the model does not contain"};
  if (!plan.meets_goal) {
    const double attainable = static_cast<double>(plan.attainable[incidence_rule]);
    const double seen = 100.0 * static_cast<double>(plan.evaluation.seen[incidence_rule]) /
                        std::max(attainable, 1.0);
    const double required = 100.0 * mission.options.goal.shares[incidence_rule];
    warnings.push_back(
        mission.is_edited
            ? fmt::format("the flight sees {:.2f}% of the attainable points, and inspection.share "
                          "requires {:.2f}%; add corners or lower inspection.share",
                          seen, required)
            : fmt::format("the flight sees {:.2f}% of the attainable points, but the planner's "
                          "conservative count is below the {:.2f}% that inspection.share requires; "
                          "raise inspection.moves or lower inspection.share",
                          seen, required));
  }
  if (!mission.flight) {
    warnings.push_back(
        "no mission with waypoints is written: " + mission.flight_failure +
        ". Fly the setpoints with an offboard controller. Plan the legs from the take-off point to "
        "the start of the route, and from its end to the take-off point, separately");
    return warnings;
  }
  const flight::Route& route = mission.flight->mission.route;
  if (!setup.flight().takeoff) {
    const Eigen::Vector3d& pad = mission.flight->pad;
    warnings.push_back(fmt::format(
        "flight.takeoff is not set: the plan uses the take-off point ({:g}, {:g}, {:g}). Inspect "
        "it and set flight.takeoff",
        pad.x(), pad.y(), pad.z()));
  }
  if (!route.unreached.empty()) {
    warnings.push_back(fmt::format(
        "{} of {} waypoints are not part of the route files; reason for the first: {}",
        route.unreached.size(), mission.flight->waypoints, route.unreached.front().reason));
  }
  return warnings;
}

}  // namespace

InspectionMission plan_inspection_mission(const config::MissionSetup& setup,
                                          const InspectionSpace& space, const std::stop_token& stop,
                                          const std::function<void(const std::string&)>& report) {
  InspectionMission mission;
  mission.options = config::inspection_options(*setup.document);
  mission.options.flown_deviation = flown_deviation;
  mission.plan = survey::inspection::plan_inspection(
      mission.options, space.site(), {setup.run.seed, setup.run.threads, stop, report});
  report("planning the flight with waypoints");
  plan_flight(setup, space, std::nullopt, stop, mission);
  mission.warnings = make_warnings(setup, mission);
  return mission;
}

EditedInspection plan_edited_inspection(const InspectionPackage& package,
                                        std::vector<survey::inspection::Vertex> corners,
                                        const std::stop_token& stop,
                                        const std::function<void(const std::string&)>& report) {
  const config::MissionSetup& setup = package.setup;
  EditedInspection edited;
  InspectionMission& mission = edited.mission;
  mission.is_edited = true;
  mission.options = config::inspection_options(*setup.document);
  mission.options.flown_deviation = flown_deviation;
  survey::inspection::GivenPlan given =
      follow_vertices(mission.options, package.space->site(), std::move(corners),
                      {setup.run.seed, setup.run.threads, stop, report});
  mission.plan = std::move(given.plan);
  edited.problems = std::move(given.problems);
  edited.slowed_legs = given.slowed_legs;
  edited.added_delay = given.added_delay;
  if (!edited.problems.empty()) return edited;
  mission.plan.attainable[incidence_rule] = package.attainable;
  mission.plan.meets_goal =
      static_cast<double>(mission.plan.evaluation.seen[incidence_rule]) >=
      mission.options.goal.shares[incidence_rule] * static_cast<double>(package.attainable);
  report("planning the flight with waypoints");
  plan_flight(setup, *package.space, package.pad, stop, mission);
  if (!mission.flight && package.pad) {
    edited.problems.push_back({std::nullopt, "no route with waypoints: " + mission.flight_failure});
    return edited;
  }
  mission.warnings = make_warnings(setup, mission);
  return edited;
}

InspectionEvaluation evaluate_inspection(const config::MissionSetup& setup,
                                         const InspectionSpace& space,
                                         std::span<const survey::inspection::FlightSample> flight) {
  const InspectionOptions options = config::inspection_options(*setup.document);
  const survey::inspection::InspectionSite site = space.site();
  survey::inspection::EvaluationOptions evaluation;
  evaluation.camera = options.camera;
  evaluation.limits = options.limits;
  evaluation.min_pitch = options.pitch.min;
  evaluation.max_pitch = options.pitch.max;
  evaluation.threads = setup.run.threads;
  InspectionEvaluation result;
  result.flight = evaluate_flight(
      flight, survey::inspection::make_structure_cloud(site.points, site.normals), evaluation);
  result.required_clearance = options.clearance;
  result.clearance = options.clearance + options.camera.range;
  for (std::size_t i = 1; i < flight.size(); ++i) {
    result.clearance = std::min(
        result.clearance,
        site.segment_distance(flight[i - 1].position, flight[i].position, result.clearance));
  }
  return result;
}

}  // namespace skycap::missions::inspection
