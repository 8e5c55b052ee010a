/// Comparison of inspections with flights of other programs, for the command `benchmark`.
#pragma once

#include "missions/cli/commands.h"
#include "missions/cli/console.h"

namespace skycap::missions::cli {

/// Plans the inspection of each mission with `options.trials` seeds and evaluates it beside the
/// flights `options.also`, each in the form MISSION=FILE. Structures and flights whose files are
/// missing are skipped with the reason. Returns exit code 1 if no flight is evaluated.
int benchmark_inspections(const BenchmarkOptions& options, const Console& console);

}  // namespace skycap::missions::cli
