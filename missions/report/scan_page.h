/// scan.html of a scan, made of what its folder holds and of nothing else.
#pragma once

#include <cstddef>
#include <string>

#include "missions/report/results.h"

namespace skycap::missions::report {

/// The page of the scan that scan.json tells of, with at most so many points of preview.ply, where
/// there is one. Normals, and with them angles of incidence, are of the planes through the points'
/// neighbours. Throws Error{bad_file} naming the file if one is not as `skycap scan` writes it.
std::string scan_page(const ResultFinder& results, std::size_t most_points);

}  // namespace skycap::missions::report
