/// E57 files of one scan as they are written: a beginning of constant length with the description,
/// then the records in packets that are made on any thread, and put into pages in order.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/io/e57/description.h"

namespace skycap::geometry::e57 {

/// What is said of the scan. The same input gives the same bytes: the identifiers that E57 wants
/// follow from the rest, and no date is given.
struct WrittenScan {
  std::string sensor;            ///< its model; empty: nothing is said of it
  std::string reference_system;  ///< WKT; empty: nothing is said of it
  std::vector<Field> fields;     ///< numbers of whole bytes
  std::uint64_t records = 0;
  Eigen::AlignedBox3d bounds;         ///< of the coordinates; empty: nothing is said of them
  std::uint64_t checksum = 0;         ///< of the records: any number that changes with them
  std::uint64_t size_of_packets = 0;  ///< without the pages' checksums [bytes]
};

/// Header, description and header of the records, in whole pages whose number depends on `sensor`,
/// `reference_system` and `fields` alone.
std::string beginning_of(const WrittenScan& scan);

/// These records: of each field its values one after another, as stored. No packet is without
/// records: there are readers that know no others.
std::string packets_of(std::span<const Field> fields, std::span<const std::string> values);

}  // namespace skycap::geometry::e57
