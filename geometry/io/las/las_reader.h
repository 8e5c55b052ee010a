/// Reader of LAS files of any size, in pieces: versions 1.0 to 1.4 (ASPRS specification R15), point
/// formats 0 to 10. Point formats 0 to 3 and 6 to 8 may be compressed (LAZ, COPC; see
/// point_stream.h). The whole file may be gzip-compressed.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "geometry/io/las/point_stream.h"
#include "geometry/io/seekable_file.h"

namespace skycap::geometry {

/// Header fields of a LAS file.
struct LasHeader {
  int minor = 0;                   ///< minor version: 1.minor
  int format = 0;                  ///< point format
  bool is_compressed = false;      ///< LAZ or COPC
  bool has_adjusted_time = false;  ///< times are GPS times minus 1e9 s, not seconds of the week
  std::uint64_t points = 0;
  std::uint64_t header_size = 0, first_point = 0, point_size = 0;  ///< [bytes]
  std::uint32_t records = 0;  ///< number of variable length records after the header
  std::uint64_t first_extended_record = 0;
  std::uint32_t extended_records = 0;  ///< number of records after the points
  Eigen::Vector3d scale, offset;

  bool has_colours() const;
};

/// Consecutive points of a file, in the unit of the file.
struct LasPoints {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::uint8_t> classes;  ///< ASPRS class of each point
  std::vector<std::array<std::uint16_t, 3>>
      colours;  ///< colour of each point, or empty if the format has none
};

/// Coordinate reference system of a file: WKT, or EPSG codes of its GeoKeys.
struct LasReferenceSystem {
  std::string wkt;
  int projected = 0, geographic = 0, vertical = 0;  ///< EPSG codes; 0 if unspecified
  int vertical_unit = 0;                            ///< EPSG code; 0 if unspecified
  bool is_user_defined = false;                     ///< defined by parameters, which are not read
};

/// Record of the reference system or of the specification (additional bytes).
struct LasRecord {
  bool is_projection = true;  ///< otherwise it belongs to the specification
  std::uint16_t id = 0;
  std::string content;
};

/// Compressed fields of a point that a reader decodes.
enum class LasFields {
  needed,  ///< fields of LasPoints
  all,
};

class LasReader {
 public:
  /// Throws Error{bad_file} if the file cannot be read, if its header is invalid or its compression
  /// unsupported. The same applies if it declares more points than fit into the file.
  explicit LasReader(std::filesystem::path path, LasFields fields = LasFields::needed);

  const LasHeader& header() const { return header_; }

  /// Replaces `points` with the next points, from at most `max` records. Withheld points are
  /// ignored, so that the result may be empty. Returns false at the end of the file. Throws
  /// Error{bad_file} if the file cannot be read or its compressed data is damaged.
  bool next(LasPoints& points, std::size_t max = 1 << 16);

  /// Replaces `points` with a fraction of the next points, and skips the others without decoding
  /// them: of a chunk of a compressed file, otherwise of 4096 points. The fraction is in (0, 1],
  /// and rounded up to one point. Returns false at the end of the file. Throws as next().
  bool next_sample(LasPoints& points, double fraction);

  /// Replaces `records` with the next points in the uncompressed format of the file, including
  /// withheld points. Returns false at the end of the file. Requires LasFields::all. Throws as
  /// next().
  bool next_records(std::string& records, std::size_t max = 1 << 16);

  /// Returns the records of the reference system and of additional bytes, before and after the
  /// points. Throws Error{bad_file} if the file cannot be read.
  std::vector<LasRecord> kept_records();

  /// Reads the reference system from the records before and after the points. The first WKT takes
  /// precedence. Throws Error{bad_file} if the file cannot be read.
  LasReferenceSystem reference_system();

 private:
  /// Receives the user ID, record ID and content of a record. Returns whether to continue.
  using RecordCallback =
      std::function<bool(std::string_view user, int id, std::string_view content)>;

  std::string bytes(std::uint64_t offset, std::uint64_t count);
  void visit_records(const RecordCallback& callback);
  void visit_extended_records(const RecordCallback& callback);
  std::string compression_record();
  void open_compressed(LasFields fields);
  void decompress(LasPoints& points, std::uint64_t count);

  std::unique_ptr<SeekableFile>
      file_;  ///< on the heap, so that its address stays the same when the reader is moved
  LasHeader header_;
  std::unique_ptr<las::PointStream> compressed_;
  std::vector<char> record_;  ///< most recently decompressed point
  std::uint64_t points_read_ = 0;
};

}  // namespace skycap::geometry
