/// Whole files in and out.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace skycap::geometry {

/// Throws Error{bad_file} unless it is a regular file: devices and pipes may never end.
void require_regular_file(const std::filesystem::path& path);

/// A stream of the file's bytes, which has failed if the file cannot be opened. Throws
/// std::bad_alloc if memory is what is missing: then nothing is wrong with the file.
std::ifstream open_stream(const std::filesystem::path& path);

/// The name's ending in lower case with its dot, not counting ".gz"; empty if it has none.
std::string ending_of(std::filesystem::path path);

/// What is read whole if nothing else is said; what is larger has to be read piece by piece.
inline constexpr std::size_t largest_whole_file = std::size_t{1} << 30;

/// The bytes of a file; one that gzip has compressed comes back decompressed, whatever its name.
/// Throws Error{bad_file} if it is no regular file, unreadable, damaged, or larger than
/// `most_bytes`, decompressed or not, or decompressed than `most_decompressed`: a few bytes may
/// unpack to as much.
std::string read_file(const std::filesystem::path& path,
                      std::size_t most_bytes = largest_whole_file,
                      std::size_t most_decompressed = largest_whole_file);

/// Replaces the file by one with these bytes: they are written under a temporary name beside it,
/// brought to the disk, and renamed when complete, so that no reader ever finds half a file, not
/// even after a power cut. Makes the folder if need be. What a killed program left under the
/// temporary name is used up. Throws Error{bad_file}.
void write_file(const std::filesystem::path& path, std::string_view bytes);

/// Cuts a file to the length that it once had. Throws Error{bad_file} if that fails, or if the file
/// is shorter.
void cut_file(const std::filesystem::path& path, std::uintmax_t bytes);

/// Brings a file's content, or a folder's names, to the disk. Throws Error{bad_file}.
void sync_to_disk(const std::filesystem::path& path);

}  // namespace skycap::geometry
