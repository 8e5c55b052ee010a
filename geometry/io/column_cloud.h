/// Point clouds with all attributes that formats have in common, in double precision, for
/// conversions between formats. cloud_io.h reads local coordinates in single precision.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace skycap::geometry {

/// Attributes with a number per point. Colours have the range 0 to 65535, as in LAS files.
enum class CloudColumn : std::size_t {
  normal_x,
  normal_y,
  normal_z,
  red,
  green,
  blue,
  intensity,
  classification,
  return_number,
  returns
};
inline constexpr std::size_t cloud_columns = 10;

/// An absent attribute is an empty vector; otherwise it has one entry per position.
struct ColumnCloud {
  std::vector<Eigen::Vector3d> positions;  ///< [unit of the file]
  std::vector<double> times;               ///< [s]
  std::array<std::vector<float>, cloud_columns> columns;
  std::string crs_wkt;      ///< empty if the file has none
  std::size_t skipped = 0;  ///< number of points with a NaN or infinite coordinate
  /// Sentences about properties of the file that are not read.
  std::vector<std::string> lost;

  const std::vector<float>& column(CloudColumn name) const {
    return columns[static_cast<std::size_t>(name)];
  }
  std::vector<float>& column(CloudColumn name) { return columns[static_cast<std::size_t>(name)]; }
  bool has_normals() const { return !column(CloudColumn::normal_x).empty(); }
  bool has_colours() const { return !column(CloudColumn::red).empty(); }
};

/// Reads all formats of read_cloud(). Throws Error{bad_file}, as read_cloud() does, but coordinates
/// may have any size. A file without points gives an empty cloud if its format permits that.
ColumnCloud read_column_cloud(const std::filesystem::path& path);

/// Writes PLY, PCD, LAS, LAZ, E57 or XYZ files, depending on the extension. The write is not
/// atomic. Returns one sentence per property of the cloud that the format cannot represent. Throws
/// Error{bad_file}.
std::vector<std::string> write_column_cloud(const std::filesystem::path& path,
                                            const ColumnCloud& cloud);

/// Returns whether write_column_cloud() supports the extension of the name.
bool is_written_cloud(const std::filesystem::path& path);

}  // namespace skycap::geometry
