/// LAS files of any size, piece by piece: versions 1.0 to 1.4 (ASPRS specification R15), points of
/// format 0 to 10, and those of format 0 to 3 and 6 to 8 also compressed (LAZ, COPC:
/// point_stream.h). gzip may have compressed the whole file.
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

/// What the beginning of a LAS file says of its points.
struct LasHeader {
  int minor = 0;               ///< of the version 1.minor
  int format = 0;              ///< of points
  bool is_compressed = false;  ///< LAZ, COPC
  std::uint64_t points = 0;
  std::uint64_t header_size = 0, first_point = 0, point_size = 0;  ///< [bytes]
  std::uint32_t records = 0;  ///< of variable length, behind the header
  std::uint64_t first_extended_record = 0;
  std::uint32_t extended_records = 0;  ///< behind the points
  Eigen::Vector3d scale, offset;

  bool has_colours() const;
};

/// Some points of a file. Coordinates are as they are, whatever their unit.
struct LasPoints {
  std::vector<Eigen::Vector3d> positions;
  std::vector<std::uint8_t> classes;                  ///< ASPRS's, of each
  std::vector<std::array<std::uint16_t, 3>> colours;  ///< of each, if the format has them
};

/// The coordinate reference system that a file states: WKT, or EPSG codes of its GeoKeys.
struct LasReferenceSystem {
  std::string wkt;
  int projected = 0, geographic = 0, vertical = 0;  ///< EPSG codes; 0: not stated
  int vertical_unit = 0;                            ///< EPSG code; 0: not stated
  bool is_user_defined = false;                     ///< by parameters that are not read
};

class LasReader {
 public:
  /// Throws Error{bad_file} if the file cannot be read, has no such header, is compressed in
  /// another way, or tells of more points than it has room for.
  explicit LasReader(std::filesystem::path path);

  const LasHeader& header() const { return header_; }

  /// Replaces `points` by the next of the file, from at most `most` of its records: withheld points
  /// are passed over, so that there may be none of them left. False at the end. Throws
  /// Error{bad_file} if the file cannot be read, or what is compressed is damaged.
  bool next(LasPoints& points, std::size_t most = 1 << 16);

  /// Reads the reference system from the records before and behind the points; the first WKT
  /// counts. Throws Error{bad_file} if the file cannot be read.
  LasReferenceSystem reference_system();

 private:
  /// Takes a record's user, number and content; returns whether to go on.
  using TakeRecord = std::function<bool(std::string_view user, int id, std::string_view content)>;

  std::string bytes(std::uint64_t place, std::uint64_t count);
  void visit_records(const TakeRecord& take);
  void visit_extended_records(const TakeRecord& take);
  std::string compression_record();
  void open_compressed();
  void decompress(LasPoints& points, std::uint64_t count);

  std::unique_ptr<SeekableFile> file_;  ///< which stays where it is when its reader is moved
  LasHeader header_;
  std::unique_ptr<las::PointStream> compressed_;
  std::vector<char> record_;  ///< of the point that was decompressed last
  std::uint64_t points_read_ = 0;
};

}  // namespace skycap::geometry
