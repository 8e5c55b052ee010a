/// Reads and writes point clouds. Formats for reading and writing: PLY (any properties in any
/// order, ASCII and binary) and E57. Formats for reading only: PCD, LAS 1.0 to 1.4 and XYZ text.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

/// Maximum absolute coordinate in single precision [m]. Beyond it, the spacing of single-precision
/// numbers is 2 mm.
inline constexpr double farthest_single_coordinate = 16384.0;

/// Points and their attributes. An absent attribute is an empty vector; otherwise it has one entry
/// per position.
struct AttributedCloud {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;              ///< PLY: nx ny nz; unit vectors
  std::vector<std::uint32_t> views;                  ///< PLY: view; zero-based index of the scan
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< PLY: red green blue
  /// Number of skipped points of the file: those with a NaN or infinite coordinate. No-return
  /// pixels are such points.
  std::size_t skipped = 0;
};

/// Named property with one value per point.
struct NamedMarks {
  std::string_view name;
  std::span<const std::uint8_t> values;
};

/// Non-owning columns of a point cloud. Absent attributes are empty.
struct CloudColumns {
  std::span<const Eigen::Vector3f> positions;
  std::span<const Eigen::Vector3f> normals;
  std::span<const std::uint32_t> views;
  std::span<const std::array<std::uint8_t, 3>> colours;
  std::vector<NamedMarks> marks = {};
};

inline CloudColumns make_columns(const AttributedCloud& cloud) {
  return {cloud.positions, cloud.normals, cloud.views, cloud.colours, {}};
}

/// Reads a point cloud. The format follows from the ending of the file name:
///
/// - .ply
/// - .pcd: text, binary or compressed
/// - .las: versions 1.0 to 1.4, point formats 0 to 10
/// - .laz: also COPC; point formats 0 to 3 and 6 to 8
/// - .e57: all scans, transformed by their poses; each is a view if there are several
/// - .xyz, .txt, .asc, .pts, .csv: text with one point per line
///
/// Numbers in text files are separated by blanks, commas or semicolons. The columns are x y z or
/// those of a header; other columns are ignored. '#' and '//' begin a comment. A line with a single
/// number is a point count. All formats may be gzip-compressed.
///
/// Other properties and elements are ignored, as are colours that are not bytes, 16-bit numbers or
/// reals from 0 to 1. Points with a NaN or infinite coordinate are skipped and counted.
///
/// Throws Error{bad_file} with a one-line message, also if the file has fewer points than declared.
/// The same applies to points so far from the origin that single precision would move them by 1 mm.
AttributedCloud read_cloud(const std::filesystem::path& path);

/// Receives consecutive points of a file. `share` is the fraction of the file that has been read.
using PositionsCallback = std::function<void(std::span<const Eigen::Vector3f> chunk, double share)>;

/// Reads the positions of all formats of read_cloud() and passes them to `callback` in order, in
/// pieces of up to one million points. Returns the number of skipped points, as defined in
/// AttributedCloud.
std::size_t read_positions(const std::filesystem::path& path, const PositionsCallback& callback);

/// Writes a binary little-endian PLY file: x y z (float), then the attributes that are present.
/// These are nx ny nz (float), view (uint), red green blue (uchar) and marks (uchar). If the path
/// ends in .e57, writes an E57 file with one scan, without views and marks. The write is atomic.
/// Throws Error{bad_file}.
void write_cloud(const std::filesystem::path& path, const CloudColumns& cloud);

}  // namespace skycap::geometry
