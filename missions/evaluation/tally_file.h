/// Parts of a judged cloud on the disk, until all of them are there.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "geometry/io/output_folder.h"
#include "missions/evaluation/cloud_judge.h"

namespace skycap::missions::evaluation {

/// Stages a tally: piece.json, which says what it is of, and distances.bin, the distances as single
/// precision, lowest byte first.
void stage_tally(const std::string& identity, const CloudTally& tally,
                 geometry::OutputFolder& folder);

/// Whether a tally is there and of that.
bool has_tally(const std::filesystem::path& folder, const std::string& identity);

/// The tally of a folder that has one. Throws Error{bad_file} if its files are damaged.
CloudTally read_tally(const std::filesystem::path& folder);

}  // namespace skycap::missions::evaluation
