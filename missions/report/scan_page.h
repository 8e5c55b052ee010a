/// HTML report (scan.html) of a scan, generated from its results folder only.
#pragma once

#include <cstddef>
#include <string>

#include "missions/report/results.h"

namespace skycap::missions::report {

/// Returns the report of the scan described in scan.json, with up to `max_points` points of
/// preview.ply, if present. Normals are estimated from planes through neighbouring points and
/// determine the incidence angles. Throws Error{bad_file} with the file name if a file is invalid.
std::string scan_page(const ResultFinder& results, std::size_t max_points);

}  // namespace skycap::missions::report
