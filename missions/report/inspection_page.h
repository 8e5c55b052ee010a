/// HTML report of an inspection flight.
#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "missions/report/results.h"

namespace skycap::missions::report {

/// Returns true if a summary is that of an inspection.
bool is_inspection_summary(const nlohmann::ordered_json& summary);

/// Returns the report of the inspection described in summary.json, with the points of structure.ply
/// and the camera poses of camera.tum. Throws Error{bad_file} with the file name if a file is
/// invalid.
std::string inspection_page(const ResultFinder& results, std::size_t max_points);

}  // namespace skycap::missions::report
