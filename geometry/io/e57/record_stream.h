/// The records of one scan of an E57 file, packet by packet (ASTM E2807-11, 9).
#pragma once

#include <span>
#include <vector>

#include "geometry/io/e57/column.h"
#include "geometry/io/e57/description.h"
#include "geometry/io/e57/pages.h"

namespace skycap::geometry::e57 {

class RecordStream {
 public:
  /// Of those fields, by their number; `pages` and `scan` have to outlive it. Throws
  /// Error{bad_file} if the file has no such records, or tells of more than it has room for; so
  /// does next(). Their sentences lack the file's name.
  RecordStream(Pages& pages, const ScanDescription& scan, std::span<const std::size_t> fields);

  /// Values of the next records, at most so many: values()[i] are those of the i-th field asked
  /// for. Returns how many they are; none at the end of the scan alone.
  std::size_t next(std::size_t most);

  std::span<const std::vector<double>> values() const { return values_; }

 private:
  void read_packet();
  void take_streams(std::string_view packet, std::uint64_t place);

  Pages* pages_;
  const ScanDescription* scan_;
  std::vector<std::size_t> fields_;
  std::vector<Column> columns_;
  std::vector<std::vector<double>> values_;
  std::vector<std::uint64_t> stored_;
  std::uint64_t next_packet_ = 0, end_ = 0;  ///< logical places
  std::uint64_t left_ = 0;                   ///< records
};

}  // namespace skycap::geometry::e57
