/// Writer of E57 files with one scan. The file begins with a header and description of constant
/// length. The record packets can be created on any thread and are then written to pages in order.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/io/e57/description.h"

namespace skycap::geometry::e57 {

/// Metadata of a written scan. Equal input gives equal bytes: the required GUIDs are derived from
/// the other fields, and no date is written.
struct WrittenScan {
  std::string sensor;            ///< sensor model; omitted if empty
  std::string reference_system;  ///< WKT; omitted if empty
  std::vector<Field> fields;     ///< numbers with a size of whole bytes
  std::uint64_t records = 0;
  Eigen::AlignedBox3d bounds;      ///< bounding box of the coordinates; omitted if empty
  std::uint64_t checksum = 0;      ///< any value that depends on all records
  std::uint64_t packets_size = 0;  ///< without page checksums [bytes]
};

/// Returns the file header, the description and the header of the records as whole pages. Their
/// number depends only on `sensor`, `reference_system` and `fields`.
std::string make_file_head(const WrittenScan& scan);

/// Returns the packets of records. `values` contains the stored values of each field. Empty packets
/// are never written, because some readers do not support them.
std::string make_packets(std::span<const Field> fields, std::span<const std::string> values);

}  // namespace skycap::geometry::e57
