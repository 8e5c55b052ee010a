/// From a district file to a mission for each target.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "missions/batch/district/prepared.h"

namespace skycap::missions::batch {

/// What is being done, for a progress line.
using Tell = std::function<void(const std::string&)>;

/// Finds the targets and writes into `out` a mission for each, with what stands near it, the
/// mission of the flight of all, and last what prepared.h reads. What is there of the same digest
/// stands as it is. Throws Error{bad_config} or Error{bad_file} in one line.
Prepared prepare(const DistrictFile& district, const std::filesystem::path& out, const Tell& tell);

}  // namespace skycap::missions::batch
