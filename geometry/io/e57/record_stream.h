/// Reads the records of one scan of an E57 file, packet by packet (ASTM E2807-11, section 9).
#pragma once

#include <span>
#include <vector>

#include "geometry/io/e57/column.h"
#include "geometry/io/e57/description.h"
#include "geometry/io/e57/pages.h"

namespace skycap::geometry::e57 {

class RecordStream {
 public:
  /// Opens a stream of the fields with the given indices. `pages` and `scan` must outlive the
  /// stream. Both the constructor and next() throw Error{bad_file} if the records are invalid or
  /// exceed the file size. The messages do not contain the file name.
  RecordStream(Pages& pages, const ScanDescription& scan, std::span<const std::size_t> fields);

  /// Reads up to `max` records. values()[i] contains the values of the i-th requested field.
  /// Returns the number of records read, which is zero only at the end of the scan.
  std::size_t next(std::size_t max);

  std::span<const std::vector<double>> values() const { return values_; }

 private:
  void read_packet();
  void read_streams(std::string_view packet, std::uint64_t offset);

  Pages* pages_;
  const ScanDescription* scan_;
  std::vector<std::size_t> fields_;
  std::vector<Column> columns_;
  std::vector<std::vector<double>> values_;
  std::vector<std::uint64_t> stored_;
  std::uint64_t next_packet_ = 0, end_ = 0;  ///< logical offsets
  std::uint64_t left_ = 0;                   ///< remaining records
};

}  // namespace skycap::geometry::e57
