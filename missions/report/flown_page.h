/// HTML report of a flight that was compared with its plan.
#pragma once

#include <cstddef>
#include <string>

#include "missions/report/results.h"

namespace skycap::missions::report {

/// Returns the report of compare.json, written by `skycap compare`, with up to `max_points` points
/// of surface.ply. Throws Error{bad_file} with the file name if the contents are invalid.
std::string flown_page(const ResultFinder& results, std::size_t max_points);

}  // namespace skycap::missions::report
