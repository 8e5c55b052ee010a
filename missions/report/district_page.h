/// The page of a district: a map of its targets, their table, and the flight of all.
#pragma once

#include <string>

#include "missions/report/results.h"

namespace skycap::missions::report {

/// From district.json; each target's row leads to the page of its own survey. Throws
/// Error{bad_file} naming the file.
std::string district_page(const ResultFinder& results);

}  // namespace skycap::missions::report
