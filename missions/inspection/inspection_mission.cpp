#include "missions/inspection/inspection_mission.h"

#include <algorithm>

#include <fmt/format.h>

#include "missions/config/inspection_rules.h"
#include "missions/config/mission_document.h"

namespace skycap::missions::inspection {
namespace {

using survey::inspection::incidence_rule;
using survey::inspection::InspectionOptions;
using survey::inspection::InspectionPlan;

std::vector<std::string> make_warnings(const config::MissionSetup& setup,
                                       const InspectionOptions& options,
                                       const InspectionPlan& plan) {
  std::vector<std::string> warnings{
      "the airspace around the structure is assumed free. Check it for trees, wires and anything "
      "that the model does not contain.",
      "the flights from the take-off point to the start and from the end back are not planned. "
      "Fly them in free airspace, at a height that you have checked."};
  if (!plan.meets_goal) {
    const double attainable = static_cast<double>(plan.attainable[incidence_rule]);
    warnings.push_back(fmt::format(
        "the flight sees {:.2f}% of the attainable points, and inspection.share requires {:.2f}% "
        "by the conservative count of the search; raise inspection.moves or lower "
        "inspection.share",
        100.0 * static_cast<double>(plan.evaluation.seen[incidence_rule]) /
            std::max(attainable, 1.0),
        100.0 * options.goal.shares[incidence_rule]));
  }
  const flight::Vehicle& vehicle = setup.flight().required_vehicle();
  constexpr double seconds_per_minute = 60.0;
  const double endurance =
      seconds_per_minute * vehicle.endurance_min * (1.0 - setup.flight().reserve);
  if (plan.evaluation.duration > endurance) {
    warnings.push_back(fmt::format(
        "the flight takes {:.1f} min, and one battery of '{}' lasts {:.1f} min with the reserve; "
        "raise inspection.max_speed, or divide the structure into several missions",
        plan.evaluation.duration / seconds_per_minute, vehicle.name,
        endurance / seconds_per_minute));
  }
  return warnings;
}

}  // namespace

InspectionMission plan_inspection_mission(const config::MissionSetup& setup,
                                          const InspectionSpace& space, const std::stop_token& stop,
                                          const std::function<void(const std::string&)>& report) {
  InspectionMission mission;
  mission.options = config::inspection_options(*setup.document);
  mission.plan = survey::inspection::plan_inspection(
      mission.options, space.site(), {setup.run.seed, setup.run.threads, stop, report});
  mission.warnings = make_warnings(setup, mission.options, mission.plan);
  return mission;
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
