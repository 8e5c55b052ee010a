/// HTML report of an inspection flight.
#pragma once

#include <cstddef>
#include <string>

#include "missions/report/results.h"

namespace skycap::missions::report {

/// Returns the report of the inspection described in summary.json, with the points of structure.ply
/// and the camera poses of camera.tum. Throws Error{bad_file} with the file name if a file is
/// invalid.
std::string inspection_page(const ResultFinder& results, std::size_t max_points);

}  // namespace skycap::missions::report
