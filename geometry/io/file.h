/// Whole files in and out.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace skycap::geometry {

/// The bytes of a file; one that gzip has compressed comes back decompressed, whatever its name.
/// Throws Error{bad_file} if it is missing, not a regular file, unreadable, damaged, or larger than
/// 4 GiB when decompressed.
std::string read_file(const std::filesystem::path& path);

/// Replaces the file by one with these bytes: they are written under a temporary name beside it,
/// and renamed when complete, so that no reader ever finds half a file. Makes the folder if need
/// be. Throws Error{bad_file}.
void write_file(const std::filesystem::path& path, std::string_view bytes);

}  // namespace skycap::geometry
