/// Point clouds from and to files: PLY (any properties in any order, ascii and binary) and E57;
/// from PCD, LAS 1.0 to 1.4 and XYZ text.
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

/// Coordinates in single precision must be at most this far from the origin: beyond, neighbouring
/// numbers are 2 mm apart [m].
inline constexpr double farthest_single_coordinate = 16384.0;

/// Points and what a file says of them. An attribute that is absent is an empty vector, otherwise
/// it has one entry for each position.
struct AttributedCloud {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;              ///< nx ny nz
  std::vector<std::uint32_t> views;                  ///< view: the scan, counted from 0
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< red green blue
  /// Points of the file that were skipped, since a coordinate is NaN or infinite. Pixels without a
  /// return are such points.
  std::size_t skipped = 0;
};

/// A number for each point under a name of its own.
struct NamedMarks {
  std::string_view name;
  std::span<const std::uint8_t> values;
};

/// The same where it stands elsewhere. What is absent is empty.
struct CloudColumns {
  std::span<const Eigen::Vector3f> positions;
  std::span<const Eigen::Vector3f> normals;
  std::span<const std::uint32_t> views;
  std::span<const std::array<std::uint8_t, 3>> colours;
  std::vector<NamedMarks> marks = {};
};

inline CloudColumns columns_of(const AttributedCloud& cloud) {
  return {cloud.positions, cloud.normals, cloud.views, cloud.colours, {}};
}

/// Reads .ply; .pcd (text, binary or compressed); .las (versions 1.0 to 1.4, points of format 0 to
/// 10) and .laz (also COPC; points of format 0 to 3 and 6 to 8); .e57 (all scans where their poses
/// put them, each a view if there are several); or text: .xyz, .txt, .asc, .pts, .csv with a point
/// a line, numbers apart by blanks, commas or semicolons, columns x y z or those that a header
/// names (further columns are passed over, '#' and '//' begin a comment, a number alone is a count
/// of points); also gzip-compressed. Other properties and elements are passed over, and colours in
/// other than bytes, 16 bits or reals from 0 to 1. Points with a coordinate that is NaN or infinite
/// are skipped and counted. Throws Error{bad_file} in one line, also for a file that holds fewer
/// points than it declares, and for points so far from the origin that single precision would move
/// them by a millimetre.
AttributedCloud read_cloud(const std::filesystem::path& path);

/// Takes a piece of a file's points, and the share of the file that is read with it.
using TakePositions = std::function<void(std::span<const Eigen::Vector3f> piece, double share)>;

/// The positions of what read_cloud() reads, in pieces of up to a million and in their order.
/// Returns how many points were skipped, as in AttributedCloud.
std::size_t read_positions(const std::filesystem::path& path, const TakePositions& take);

/// Writes binary little-endian PLY: x y z as float and then, of what is there, nx ny nz as float,
/// view as uint, red green blue as uchar, marks as uchar. To a path that ends in .e57 it writes
/// E57, one scan without views and marks. Complete or not at all. Throws Error{bad_file}.
void write_cloud(const std::filesystem::path& path, const CloudColumns& cloud);

}  // namespace skycap::geometry
