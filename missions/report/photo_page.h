/// HTML report of a photo mission.
#pragma once

#include <cstddef>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "missions/report/results.h"

namespace skycap::missions::report {

/// Returns true if a summary is that of a photo mission.
bool is_photo_summary(const nlohmann::ordered_json& summary);

/// Returns the report of the photo mission described in summary.json, with the surface map of
/// photo_surface.csv, which is optional. Throws Error{bad_file} with the file name if a file is
/// invalid.
std::string photo_page(const ResultFinder& results, std::size_t max_points);

}  // namespace skycap::missions::report
