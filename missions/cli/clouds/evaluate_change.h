/// Evaluation of a cloud against an earlier cloud of the same building.
#pragma once

#include "missions/cli/commands.h"

namespace skycap::missions::cli {

/// Prints the M3C2 distances between options.cloud and options.reference and the completeness of
/// both. Writes a report, a picture and the distances to options.out. Returns the exit code.
int evaluate_change(const EvaluateOptions& options, const Console& console);

}  // namespace skycap::missions::cli
