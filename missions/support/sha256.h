#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace skycap::missions::support {

/// Returns the SHA-256 of `bytes` as 64 hexadecimal digits (FIPS 180-4).
std::string sha256(std::span<const std::byte> bytes);

/// Returns the SHA-256 of a file. Throws Error{bad_file} if it cannot be read.
std::string compute_file_sha256(const std::filesystem::path& file);

}  // namespace skycap::missions::support
