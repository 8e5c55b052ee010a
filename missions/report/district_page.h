/// HTML report of a district: a map and table of its targets, and the joint flight.
#pragma once

#include <string>

#include "missions/report/results.h"

namespace skycap::missions::report {

/// Returns the report of district.json. Each target's row links to the report of its survey. Throws
/// Error{bad_file} with the file name if the contents are invalid.
std::string district_page(const ResultFinder& results);

}  // namespace skycap::missions::report
