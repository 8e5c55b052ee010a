/// Data of the route profile for reports.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "missions/report/results.h"

namespace skycap::missions::report {

/// Returns the columns of profile.csv as arrays. Null if the file does not exist. Throws
/// Error{bad_file} with the file name if it is invalid.
nlohmann::ordered_json profile_data(const ResultFinder& results);

}  // namespace skycap::missions::report
