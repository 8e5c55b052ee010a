/// Reads and writes whole files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace skycap::geometry {

/// Throws Error{bad_file} unless `path` is a regular file, because devices and pipes may never end.
void require_regular_file(const std::filesystem::path& path);

/// Opens a file for reading. The stream is in a failed state if the file cannot be opened. Throws
/// std::bad_alloc if memory is exhausted, to distinguish it from a file error.
std::ifstream open_stream(const std::filesystem::path& path);

/// Returns the file extension in lower case with its dot, ignoring ".gz". Empty if the name has no
/// extension.
std::string lower_extension(std::filesystem::path path);

/// Default limit of read_file() [bytes]. Larger files must be read in pieces.
inline constexpr std::size_t largest_whole_file = std::size_t{1} << 30;

/// Returns the content of a file. Decompresses gzip files independent of their name. Throws
/// Error{bad_file} if the file is not a regular file, unreadable, damaged, larger than
/// `max_bytes`, or decompresses to more than `max_decompressed` bytes. The second limit exists
/// because a few bytes can decompress to a very large size.
std::string read_file(const std::filesystem::path& path, std::size_t max_bytes = largest_whole_file,
                      std::size_t max_decompressed = largest_whole_file);

/// Replaces a file atomically: writes a temporary file in the same folder, syncs it to disk, and
/// renames it. Readers never find an incomplete file, not even after a power failure. Creates the
/// folder if it does not exist. Overwrites a temporary file left by a killed program. Throws
/// Error{bad_file}.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// Truncates a file to a previous length. Throws Error{bad_file} if that fails or the file is
/// shorter.
void cut_file(const std::filesystem::path& path, std::uintmax_t bytes);

/// Syncs the content of a file, or the entries of a folder, to disk. Throws Error{bad_file}.
void sync_to_disk(const std::filesystem::path& path);

}  // namespace skycap::geometry
