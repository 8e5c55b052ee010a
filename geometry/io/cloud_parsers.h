/// Readers of individual cloud formats, for the source of cloud_io.h. Every message begins with
/// `path`.
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

/// Throws Error{bad_file} with a one-line message that begins with `path`.
[[noreturn]] void fail_cloud(const std::filesystem::path& path, const std::string& what);

/// Converts finite coordinates of a file to single precision. Throws Error{bad_file} if the
/// conversion would move the point by 1 mm.
Eigen::Vector3f cloud_position(const std::filesystem::path& path, std::size_t point, double x,
                               double y, double z);

/// Converts `positions` with cloud_position() and appends them to `to`. `first` is the index of the
/// first point in the file.
void add_positions(const std::filesystem::path& path, std::size_t first,
                   std::span<const Eigen::Vector3d> positions, std::vector<Eigen::Vector3f>& to);

/// Maximum decompressed size of a cloud. It limits the memory of the cloud and its intermediate
/// results to less than 2 GiB.
inline constexpr std::size_t largest_unpacked_cloud = std::size_t{384} << 20,  // [bytes]
    max_whole_points = std::size_t{1} << 26;

/// Throws Error{bad_file} if `points` exceeds the limit.
void require_few_points(const std::filesystem::path& path, std::size_t points);

/// Parses PCD 0.7 of the Point Cloud Library: text, binary or compressed. Reads x y z and normal_x
/// normal_y normal_z. PCL marks no-return pixels by NaN; these points are skipped and counted.
AttributedCloud parse_pcd_cloud(const std::filesystem::path& path, std::string_view bytes);

/// Reads LAS 1.0 to 1.4 and LAZ (las/las_reader.h). Withheld points are ignored.
AttributedCloud read_las_cloud(const std::filesystem::path& path);

/// Reads all scans of an E57 file (e57_reader.h). If there are several scans, `views` contains
/// their indices.
AttributedCloud read_e57_cloud(const std::filesystem::path& path);

/// Returns the bytes of an E57 file with one scan, as written by write_cloud().
std::string e57_bytes(const CloudColumns& cloud);

/// Maximum number of points per piece.
inline constexpr std::size_t points_per_chunk = 1'000'000;

/// Reads only the positions, as specified by read_positions().
std::size_t read_las_positions(const std::filesystem::path& path,
                               const PositionsCallback& callback);
std::size_t read_e57_positions(const std::filesystem::path& path,
                               const PositionsCallback& callback);

/// Receives consecutive points of text and the number of bytes that have been read with them.
using TextChunkCallback = std::function<void(std::span<const Eigen::Vector3f>, std::size_t)>;

/// Parses text with one point per line, as specified by read_cloud(). Returns the number of skipped
/// points.
std::size_t read_text_cloud(const std::filesystem::path& path, std::string_view text,
                            const TextChunkCallback& callback);

/// Receives the names of the fields of a file and returns the indices of those to be read.
using SelectFields = std::function<std::vector<std::size_t>(std::span<const std::string> names)>;

/// Receives the selected fields of a point.
using FieldValues = std::function<void(std::span<const double> values)>;

/// Reads fields of a PCD file. Packed colours ("rgb", "rgba") are passed as an integer.
void read_pcd_fields(const std::filesystem::path& path, std::string_view bytes,
                     const SelectFields& select, const FieldValues& callback);

struct TextColumns {
  std::size_t unnamed = 0;  ///< number of columns after the coordinates without names
};

/// Reads x, y and z and the selected columns of lines with one point each.
TextColumns read_text_fields(const std::filesystem::path& path, std::string_view text,
                             const SelectFields& select, const FieldValues& callback);

/// Returns the decompressed bytes of a file that is not read in pieces; text in UTF-8.
std::string whole_cloud_file(const std::filesystem::path& path);

/// Throws Error{bad_file} unless the extension is that of a cloud.
void require_cloud_name(const std::filesystem::path& path);

/// Throws Error{bad_file} for a file without points, or in which all points were skipped.
[[noreturn]] void fail_without_points(const std::filesystem::path& path, std::size_t skipped);

}  // namespace skycap::geometry
