#include "missions/inspection/flight_table.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "missions/inspection/inspection_results.h"

namespace skycap::missions::inspection {
namespace {

using Json = nlohmann::ordered_json;
using survey::inspection::FlightEvaluation;

std::string row(const ComparedFlight& flight, const FlightEvaluation& evaluation) {
  const std::string planning =
      flight.planning_time ? fmt::format("{:.0f}", *flight.planning_time) : "–";
  return fmt::format(
      "| {} | {} | {:.1f} | {:.1f} | {:.2f}% ({}) | {:.2f}% | {:.2f}% | {:.2f} | {:.0f}, {:.0f} | "
      "{} | {} |\n",
      flight.structure, flight.flight, evaluation.duration, evaluation.length,
      100.0 * evaluation.share(survey::inspection::pixel_rule),
      evaluation.seen[survey::inspection::pixel_rule],
      100.0 * evaluation.share(survey::inspection::solid_rule),
      100.0 * evaluation.share(survey::inspection::incidence_rule), evaluation.nearest,
      evaluation.views.median, evaluation.views.percentile_10,
      evaluation.keeps_limits() ? "kept" : "exceeded", planning);
}

}  // namespace

std::string comparison_table(std::span<const ComparedFlight> flights) {
  std::string text =
      "| Structure | Flight | Seconds | Metres | Pixel | Solid | Incidence | Nearest, m | Views "
      "(median, 10%) | Limits | Processor, s |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
  std::string skipped;
  for (const ComparedFlight& flight : flights) {
    if (flight.evaluation) {
      text += row(flight, *flight.evaluation);
    } else {
      skipped +=
          fmt::format("- {}, {}: skipped: {}\n", flight.structure, flight.flight, flight.skipped);
    }
  }
  return skipped.empty() ? text : text + "\n" + skipped;
}

Json comparison_json(std::span<const ComparedFlight> flights) {
  Json list = Json::array();
  for (const ComparedFlight& flight : flights) {
    Json json{{"structure", flight.structure}, {"flight", flight.flight}};
    if (flight.evaluation) {
      json["processor_s"] = flight.planning_time ? Json(*flight.planning_time) : Json();
      json.update(evaluation_json(*flight.evaluation));
    } else {
      json["skipped"] = flight.skipped;
    }
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace skycap::missions::inspection
