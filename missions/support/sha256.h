#pragma once

#include <filesystem>
#include <span>
#include <string>

namespace skycap::missions::support {

/// The SHA-256 of some bytes, as 64 hexadecimal digits (FIPS 180-4).
std::string sha256(std::span<const std::byte> bytes);

/// The same of a file. Throws Error{bad_file} if it cannot be read.
std::string sha256_of_file(const std::filesystem::path& file);

}  // namespace skycap::missions::support
