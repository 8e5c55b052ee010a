/// Point cloud files that are written during a scan, which may be larger than memory.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <istream>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/io/e57/pages.h"
#include "sim/sensors/lidar.h"

namespace skycap::missions::scan {

/// Coordinate above which adjacent single-precision numbers differ by 2 mm [m].
inline constexpr double farthest_coordinate = 16384.0;

/// Data about the points in a file's header.
struct CloudTotals {
  std::uint64_t points = 0;
  std::array<std::uint64_t, 15> points_by_return = {};
  std::uint64_t checksum = 0;  ///< Sum of the checksums of the chunks, for formats with a checksum.
  Eigen::AlignedBox3d bounds;  ///< Bounds of the coordinates as written.

  void add(const CloudTotals& more);
};

/// Encoded points. Chunks are encoded on any thread and appended in order.
struct CloudChunk {
  std::vector<std::uint8_t> bytes;
  CloudTotals totals;
};

/// Position of a return in the file.
enum class ReturnPosition {
  reported,  ///< Measured distance along the estimated ray.
  actual,    ///< Position on the surface that the pulse hit.
};

inline const std::vector<Eigen::Vector3f>& select_positions(const sim::LidarReturns& returns,
                                                            ReturnPosition position) {
  return position == ReturnPosition::reported ? returns.points : returns.true_points;
}

/// Current extent of a growing file.
struct CloudState {
  CloudTotals totals;
  /// File size including the header; zero before the header is written [bytes].
  std::uint64_t bytes = 0;
};

/// Encoder of points. Immutable; encode() may be called concurrently.
class CloudFormat {
 public:
  virtual ~CloudFormat() = default;

  /// Returns the header of a file with the extent `grown`. Its length does not depend on `grown`.
  virtual std::vector<std::uint8_t> header(const CloudState& grown) const = 0;

  /// Returns the data after the points of a file with the extent `grown`, which the header may
  /// describe. `file` contains the points.
  virtual std::string trailer(std::istream& /*file*/, const CloudState& /*grown*/) const {
    return {};
  }

  /// Returns true if data after the header is written in pages with checksums
  /// (geometry/io/e57/pages.h). The header then consists of complete pages.
  virtual bool is_paged() const { return false; }

  /// Encodes the returns into `chunk`, replacing its contents but reusing its memory. Throws
  /// Error{bad_geometry} if the format cannot represent a point.
  virtual void encode(const sim::LidarReturns& returns, ReturnPosition position,
                      CloudChunk& chunk) const = 0;

 protected:
  CloudFormat() = default;
  CloudFormat(const CloudFormat&) = default;
  CloudFormat& operator=(const CloudFormat&) = default;
};

/// File that grows in chunks and is valid after finish().
class CloudFile {
 public:
  /// Creates the file, or continues one that had the extent `grown` and discards all data after it.
  /// Throws Error{bad_file} if the file cannot be written or is too short.
  CloudFile(std::filesystem::path path, std::shared_ptr<const CloudFormat> format,
            ReturnPosition position = ReturnPosition::reported,
            const std::optional<CloudState>& grown = {});

  void encode(const sim::LidarReturns& returns, CloudChunk& chunk) const {
    format_->encode(returns, position_, chunk);
  }

  /// Appends a chunk. Throws Error{bad_file} if writing fails.
  void append(const CloudChunk& chunk);

  /// Appends the contents of another file of the same format up to its extent `grown`. Throws
  /// Error{bad_file} if the other file is too short or if writing fails.
  void append_file(const std::filesystem::path& other, const CloudState& grown);

  /// Completes the header and closes the file. After an interrupted scan, the file is valid with
  /// the points appended so far. Throws Error{bad_file} if writing fails.
  void finish();

  /// Flushes the appended data to disk. Throws Error{bad_file}.
  void sync() const;

  std::uint64_t points() const { return state_.totals.points; }
  std::uint64_t bytes() const { return state_.bytes; }
  const CloudState& state() const { return state_; }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };

  void go_on(const CloudState& grown);
  void put_content(std::span<const std::uint8_t> bytes);
  void put(std::span<const std::uint8_t> bytes);
  void put(const std::string& bytes);
  [[noreturn]] void fail() const;

  std::filesystem::path path_;
  std::shared_ptr<const CloudFormat> format_;
  ReturnPosition position_;
  std::unique_ptr<std::FILE, Close> file_;
  geometry::e57::PageWriter pages_;  ///< Page writer, used only for paged formats.
  CloudState state_;
};

}  // namespace skycap::missions::scan
