/// Returns the scan as a binary PLY file that reproduces the planner's input exactly, so that
/// replays give the same plan. The vertices have x y z (float, world frame) and, for organised
/// scans, pixel (uint). The pose is stored in the survey's journal in full precision.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "geometry/points/scan.h"

namespace skycap::missions::online {

std::string kept_scan(const geometry::Scan& scan);

/// Reads points and pixels of a file written by kept_scan(). `name` is the prefix of error
/// messages. Throws Error{bad_file}.
geometry::Scan parse_kept_scan(std::string_view name, std::string_view bytes);

/// Returns the SHA-256 checksum of a file's bytes in hexadecimal digits, as stored in the journal.
std::string compute_checksum(std::string_view bytes);

/// Reads a file written by kept_scan(). Throws Error{bad_file} if its checksum differs from
/// `sha256`.
geometry::Scan read_kept_scan(const std::filesystem::path& file, const std::string& sha256);

}  // namespace skycap::missions::online
