/// Point clouds in LAS 1.4 (ASPRS specification R15), point format 6, written as they come: a scan
/// may be larger than memory.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "sim/lidar.h"

namespace skycap::missions {

struct LasConfig {
  double scale = 1e-4;                               ///< coordinates are multiples of it [m]
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< near the cloud: coordinates are 32 bits
  /// The coordinate reference system as OGC WKT; local east-north-up by default.
  std::string crs_wkt =
      "LOCAL_CS[\"local east-north-up\",LOCAL_DATUM[\"mission origin\",0],UNIT[\"metre\",1],"
      "AXIS[\"east\",EAST],AXIS[\"north\",NORTH],AXIS[\"up\",UP]]";
};

/// Points in the file's own bytes. Made on any thread, then appended in order.
struct LasChunk {
  std::vector<std::uint8_t> bytes;
  std::array<std::uint64_t, 15> points_by_return = {};
  Eigen::AlignedBox3d bounds;  ///< of the coordinates as written
};

/// A file that takes its final name when it is finished; one that is not finished is removed.
class LasWriter {
 public:
  /// Throws Error{bad_file} if the file cannot be written.
  LasWriter(std::filesystem::path path, LasConfig config);
  LasWriter(const LasWriter&) = delete;
  LasWriter& operator=(const LasWriter&) = delete;
  ~LasWriter();

  /// The returns' reported points. Intensity is scaled so that a white surface faced squarely has
  /// 65535; the channel modulo 256 is the user data. Throws Error{bad_geometry} if a point is too
  /// far from the offset.
  LasChunk encode(const sim::LidarReturns& returns) const;

  /// Throws Error{bad_file} if the disk does not take it.
  void append(const LasChunk& chunk);

  /// Completes the header and renames the file. Also after an interrupted scan: what was appended
  /// is then a valid file.
  void finish();

  std::uint64_t points() const { return points_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  std::vector<std::uint8_t> header() const;
  void put(const std::vector<std::uint8_t>& bytes);

  std::filesystem::path path_, temporary_;
  LasConfig config_;
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t points_ = 0;
  std::array<std::uint64_t, 15> points_by_return_ = {};
  Eigen::AlignedBox3d bounds_;
};

}  // namespace skycap::missions
