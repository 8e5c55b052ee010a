/// Stores evaluated parts of a cloud until all parts are complete.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>

#include "geometry/io/output_folder.h"
#include "missions/evaluation/cloud_evaluator.h"

namespace skycap::missions::evaluation {

/// Stages a tally as two files. piece.json contains `identity`; distances.bin contains the
/// distances in single precision, little-endian.
void stage_tally(const std::string& identity, const CloudTally& tally,
                 geometry::OutputFolder& folder);

/// Returns whether the folder contains a tally with this identity.
bool has_tally(const std::filesystem::path& folder, const std::string& identity);

/// Reads the tally of a folder that has one, for a surface with `samples` samples. Throws
/// Error{bad_file} if its files are damaged.
CloudTally read_tally(const std::filesystem::path& folder, std::size_t samples);

}  // namespace skycap::missions::evaluation
