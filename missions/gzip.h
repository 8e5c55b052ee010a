#pragma once

#include <filesystem>

namespace skycap::missions {

/// Decompresses FILE.gz to FILE beside it; returns that. Throws Error{bad_file} if it is broken.
std::filesystem::path decompress_gzip(const std::filesystem::path& file);

}  // namespace skycap::missions
