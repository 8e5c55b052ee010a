/// HTML report of a photo mission.
#pragma once

#include <cstddef>
#include <string>

#include "missions/report/results.h"

namespace skycap::missions::report {

/// Returns the report of the photo mission described in summary.json, with the surface map of
/// photo_surface.csv, which is optional. Throws Error{bad_file} with the file name if a file is
/// invalid.
std::string photo_page(const ResultFinder& results, std::size_t max_points);

}  // namespace skycap::missions::report
