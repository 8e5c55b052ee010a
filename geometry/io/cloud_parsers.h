/// Readers of single cloud formats, for the source of cloud_io.h. `path` opens every message.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/io/cloud_io.h"

namespace skycap::geometry {

/// Throws Error{bad_file} in one line that begins with the path.
[[noreturn]] void fail_cloud(const std::filesystem::path& path, const std::string& what);

/// Finite coordinates of a file in single precision. Throws Error{bad_file} if one is so large that
/// single precision would move the point by a millimetre.
Eigen::Vector3f cloud_position(const std::filesystem::path& path, std::size_t point, double x,
                               double y, double z);

/// Appends the next points of a file, whose first one is number `first`, as cloud_position() does.
void add_positions(const std::filesystem::path& path, std::size_t first,
                   std::span<const Eigen::Vector3d> positions, std::vector<Eigen::Vector3f>& to);

/// What a cloud may unpack to from fewer bytes, so that it and what is made of it on the way take
/// less than 2 GiB.
inline constexpr std::size_t largest_unpacked_cloud = std::size_t{384} << 20,  // [bytes]
    most_whole_points = std::size_t{1} << 26;

/// Throws Error{bad_file} if so many points are too many.
void require_few_points(const std::filesystem::path& path, std::size_t points);

/// The Point Cloud Library's PCD 0.7, text, binary or compressed: x y z and normal_x normal_y
/// normal_z. PCL marks pixels without a measurement by NaN: they are skipped and counted.
AttributedCloud parse_pcd_cloud(const std::filesystem::path& path, std::string_view bytes);

/// LAS 1.0 to 1.4 and LAZ (las/las_reader.h). Withheld points are passed over.
AttributedCloud read_las_cloud(const std::filesystem::path& path);

/// E57 (e57_reader.h), all scans of it; with several `views` is the scan.
AttributedCloud read_e57_cloud(const std::filesystem::path& path);

/// An E57 file of one scan, as write_cloud() writes it.
std::string e57_bytes(const CloudColumns& cloud);

/// Points of a piece.
inline constexpr std::size_t piece_size = 1'000'000;

/// The positions alone, as read_positions() hands them out.
std::size_t read_las_positions(const std::filesystem::path& path, const TakePositions& take);
std::size_t read_e57_positions(const std::filesystem::path& path, const TakePositions& take);

/// Takes a piece of a text's points, and how many of its bytes are read with them.
using TakeTextPiece = std::function<void(std::span<const Eigen::Vector3f>, std::size_t)>;

/// Points as text, a line each, as read_cloud() describes them. Returns how many were skipped.
std::size_t take_text_cloud(const std::filesystem::path& path, std::string_view text,
                            const TakeTextPiece& take);

/// Throws Error{bad_file}: a file without points, or with skipped ones alone.
[[noreturn]] void fail_without_points(const std::filesystem::path& path, std::size_t skipped);

}  // namespace skycap::geometry
