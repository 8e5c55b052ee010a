/// Names of attributes in PLY, PCD and text files.
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "geometry/io/column_cloud.h"

namespace skycap::geometry {

/// Attribute of a file by its index: position, time, packed colour (PCD), then CloudColumn.
namespace column {
inline constexpr std::size_t x = 0, y = 1, z = 2, time = 3, packed_colour = 4, first = 5,
                             count = first + cloud_columns;
}  // namespace column

/// Returns the attribute with this name in lower case, including those of CloudCompare and PDAL.
std::optional<std::size_t> find_column(std::string_view name);

}  // namespace skycap::geometry
