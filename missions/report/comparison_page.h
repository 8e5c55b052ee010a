/// Pages of many surveys: planners compared, and the trials of one mission.
#pragma once

#include <cstddef>
#include <string>

#include "missions/report/results.h"

namespace skycap::missions::report {

/// The page of results.json, which `skycap benchmark` leaves. Throws Error{bad_file} naming the
/// file if it is not as that verb writes it; so the other one.
std::string benchmark_page(const ResultFinder& results);

/// The page of trials.json, which `skycap plan --trials` leaves.
std::string trials_page(const ResultFinder& results);

}  // namespace skycap::missions::report
