/// Evaluation of a flight around a known structure, for the command `evaluate`.
#pragma once

#include "missions/cli/commands.h"
#include "missions/cli/console.h"

namespace skycap::missions::cli {

/// Prints the evaluation of the flight `options.flight` with the inspection mission
/// `options.model`. Returns exit code 1 if the flight exceeds a limit or violates the clearance.
int evaluate_flight_file(const EvaluateOptions& options, const Console& console);

}  // namespace skycap::missions::cli
