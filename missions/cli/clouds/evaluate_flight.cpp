#include "missions/cli/clouds/evaluate_flight.h"

#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "missions/config/mission_document.h"
#include "missions/config/resolve.h"
#include "missions/inspection/flight_file.h"
#include "missions/inspection/inspection_mission.h"
#include "missions/inspection/inspection_results.h"
#include "missions/inspection/inspection_site.h"
#include "missions/support/json_text.h"

namespace skycap::missions::cli {

int evaluate_flight_file(const EvaluateOptions& options, const Console& console) {
  if (options.shards > 0 || options.density || options.distance) {
    throw Error(ErrorKind::bad_usage,
                "--flight conflicts with --pieces, --density and --distance; remove them");
  }
  ProgressLine progress(console, options.is_quiet);
  progress.show("reading " + options.flight.string());
  const std::vector<survey::inspection::FlightSample> flight =
      inspection::read_flight_csv(options.flight);
  config::MissionSetup setup =
      config::read_mission(options.model, {}, progress.progress_callback());
  if (!setup.document->is_inspection()) {
    throw Error(ErrorKind::bad_usage,
                options.model +
                    ": --flight requires an inspection mission as --model; set inspection.range");
  }
  setup.run.threads = options.threads;
  inspection::InspectionEvaluation evaluation;
  try {
    const inspection::InspectionSpace space(setup);
    progress.show("evaluating " + options.flight.string());
    evaluation = inspection::evaluate_inspection(setup, space, flight);
  } catch (const Error& error) {
    throw Error(error.kind(), options.flight.string() + ": " + error.what());
  }
  progress.clear();
  const bool is_kept = evaluation.keeps_clearance() && evaluation.flight.keeps_limits();
  if (options.is_json) {
    nlohmann::ordered_json json{{"flight", options.flight.string()}, {"mission", options.model}};
    json.update(inspection::evaluation_json(evaluation.flight));
    json["clearance_m"] = evaluation.clearance;
    json["required_clearance_m"] = evaluation.required_clearance;
    json["keeps_clearance"] = evaluation.keeps_clearance();
    console.out << support::json_text(json) << std::flush;
  } else {
    console.out << fmt::format("{}: flight of {:.1f} s, {:.1f} m, {} samples\n",
                               options.flight.filename().string(), evaluation.flight.duration,
                               evaluation.flight.length, flight.size())
                << inspection::evaluation_text(evaluation.flight)
                << fmt::format(
                       "  nearest   {:.2f} m from a point, at {:.1f} s\n  clearance {:.2f} m from "
                       "all surfaces (required: {:.2f} m){}\n",
                       evaluation.flight.nearest, evaluation.flight.nearest_time,
                       evaluation.clearance, evaluation.required_clearance,
                       evaluation.keeps_clearance() ? "" : " VIOLATED")
                << std::flush;
  }
  return is_kept ? 0 : 1;
}

}  // namespace skycap::missions::cli
