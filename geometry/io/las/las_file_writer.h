/// Writer of LAS 1.4 files of point formats 6 to 8, also compressed (LAZ), in pieces. Equal points
/// give equal bytes.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "geometry/io/las/chunk_encoder.h"
#include "geometry/io/las/las_writer.h"

namespace skycap::geometry::las {

/// Points per chunk of a compressed file, as in files of LASzip.
inline constexpr std::uint32_t chunk_points = 50000;

/// The file is incomplete before finish(). The caller renames it then, or removes it.
class LasFileWriter {
 public:
  /// `file` contains the point format, the records without that of the compression, the scale and
  /// the offset. Throws Error{bad_file} if the file cannot be written.
  LasFileWriter(std::filesystem::path path, WrittenFile file);

  /// Adds points in the uncompressed format. Throws Error{bad_file} if writing fails.
  void add(std::string_view records);

  /// Writes the last chunk and the header. Throws Error{bad_file} if writing fails.
  void finish();

  std::uint64_t points() const { return file_.points; }

 private:
  void put(std::string_view bytes);
  void count(const char* point);
  void end_chunk();

  std::filesystem::path path_;
  WrittenFile file_;
  std::size_t point_size_;
  std::ofstream stream_;
  std::unique_ptr<ChunkEncoder> encoder_;  ///< null if the file is not compressed
  std::vector<WrittenChunk> chunks_;
  std::uint64_t first_point_ = 0, size_ = 0;
  std::array<std::array<std::int32_t, 3>, 2> extremes_{};  ///< least and greatest coordinates
};

}  // namespace skycap::geometry::las
