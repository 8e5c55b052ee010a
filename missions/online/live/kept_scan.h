/// A scan on disk exactly as the planner took it in, so that the same is planned of it again: a
/// binary PLY file of x y z (float, world frame) and, of an organised scan, pixel (uint), which any
/// viewer of clouds opens. The pose, in full precision, stands in the survey's journal.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "geometry/points/scan.h"

namespace skycap::missions::online {

std::string kept_scan(const geometry::Scan& scan);

/// The points and pixels of such a file; `name` opens every message. Throws Error{bad_file}.
geometry::Scan parse_kept_scan(std::string_view name, std::string_view bytes);

/// SHA-256, in hexadecimal digits, as the journal has it of such a file's bytes.
std::string digest_of(std::string_view bytes);

/// The same of a file whose digest is known. Throws Error{bad_file} if it has another.
geometry::Scan read_kept_scan(const std::filesystem::path& file, const std::string& sha256);

}  // namespace skycap::missions::online
