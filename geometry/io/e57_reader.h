/// Reader of E57 files (ASTM E2807-11) of any size, in pieces. All scans are read and transformed
/// by their poses. The whole file may be gzip-compressed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "geometry/io/e57/description.h"
#include "geometry/io/e57/pages.h"
#include "geometry/io/e57/record_stream.h"
#include "geometry/io/seekable_file.h"

namespace skycap::geometry {

/// Consecutive points of a scan, in the coordinates of the file.
struct E57Points {
  std::uint32_t scan = 0;   ///< zero-based index among the scans that have points
  std::size_t records = 0;  ///< number of records read, including invalid ones
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3f> normals;  ///< one per point if all scans have them, otherwise empty
  std::vector<std::array<std::uint8_t, 3>>
      colours;                     ///< one per point if all scans have them, otherwise empty
  std::vector<float> intensities;  ///< as colours
  std::vector<double> times;       ///< as colours [s]
  std::vector<std::array<std::uint8_t, 2>> returns;  ///< as colours: number, from 1, and count
};

/// Reads cartesianX, Y, Z, or sphericalRange, Azimuth, Elevation if there are no Cartesian
/// coordinates. Points with an invalid state are ignored. Points with a NaN or infinite coordinate
/// are skipped and counted.
class E57Reader {
 public:
  /// Throws Error{bad_file} if the file cannot be read or its header or description is invalid.
  explicit E57Reader(std::filesystem::path path);

  /// Returns the coordinate metadata of the file, usually WKT. May be empty.
  const std::string& reference_system() const { return description_.reference_system; }
  std::size_t scans() const { return description_.scans.size(); }
  std::uint64_t points() const;
  /// Returns the number of points skipped so far because of a NaN or infinite coordinate.
  std::size_t skipped() const { return skipped_; }
  /// Returns the number of scans whose quaternion is four zeros. They are read as not rotated.
  std::size_t zero_rotations() const { return description_.zero_rotations; }

  /// Returns the names of all fields that next() does not read.
  std::vector<std::string> unread_fields() const;

  /// Replaces `points` with the next points, from at most `max` records of one scan. The result
  /// may be empty if all records are invalid. Returns false at the end of the file. Throws
  /// Error{bad_file} if the file is damaged.
  bool next(E57Points& points, std::size_t max = 1 << 16);

 private:
  /// Fields of a scan that are read.
  struct FieldIndices {
    bool is_spherical = false;
    std::vector<std::size_t> fields;  ///< three of the position, then optional fields
    std::size_t state = 0, colours = 0, normals = 0, intensity = 0, time = 0,
                returns = 0;  ///< indices in `fields`; 0 if absent
  };
  FieldIndices find_field_indices(const e57::ScanDescription& scan) const;
  void add_points(std::size_t count, E57Points& points);

  std::unique_ptr<SeekableFile>
      file_;  ///< on the heap, so that its address stays the same when the reader is moved
  std::unique_ptr<e57::Pages> pages_;
  e57::Description description_;
  bool has_colours_ = false, has_normals_ = false, has_intensities_ = false, has_times_ = false,
       has_returns_ = false;
  std::size_t next_scan_ = 0, skipped_ = 0;
  FieldIndices field_indices_;
  std::optional<e57::RecordStream> records_;
};

}  // namespace skycap::geometry
