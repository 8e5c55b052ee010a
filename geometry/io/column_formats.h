/// Names of attributes in PLY, PCD and text files, and functions of individual formats, for the
/// sources of column_cloud.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/io/column_cloud.h"

namespace skycap::geometry {

/// Attribute of a file by its index: position, time, packed colour (PCD), then CloudColumn.
namespace column {
inline constexpr std::size_t x = 0, y = 1, z = 2, time = 3, packed_colour = 4, first = 5,
                             count = first + cloud_columns;
}  // namespace column

/// Returns the attribute with this name in lower case, including those of CloudCompare and PDAL.
std::optional<std::size_t> find_column(std::string_view name);

inline std::size_t index_of(CloudColumn name) { return static_cast<std::size_t>(name); }

/// Returns the nearest integer from 0 to `max`, and 0 for NaN.
inline std::uint8_t rounded_byte(float value, float max) {
  return value > 0.0F ? static_cast<std::uint8_t>(std::lround(std::min(value, max))) : 0;
}

/// Reads a LAS or LAZ file without withheld points.
void read_las_columns(const std::filesystem::path& path, ColumnCloud& cloud);

/// Writes a LAS or LAZ file with point format 6, or 7 with colours. Appends sentences about
/// properties that are not kept to `lost`.
void write_las_columns(const std::filesystem::path& path, const ColumnCloud& cloud,
                       std::vector<std::string>& lost);

}  // namespace skycap::geometry
