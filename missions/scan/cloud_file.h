/// Files of points that are written while they are measured: a scan may be larger than memory.
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/io/e57/pages.h"
#include "sim/sensors/lidar.h"

namespace skycap::missions::scan {

/// Beyond this, neighbouring single-precision numbers are 2 mm apart [m].
inline constexpr double farthest_coordinate = 16384.0;

/// What a file's header says of its points.
struct CloudTotals {
  std::uint64_t points = 0;
  std::array<std::uint64_t, 15> points_by_return = {};
  std::uint64_t checksum = 0;  ///< the sum of the chunks', of formats that have one
  Eigen::AlignedBox3d bounds;  ///< of the coordinates as written

  void add(const CloudTotals& more);
};

/// Points in the file's own bytes. Made on any thread, then appended in order.
struct CloudChunk {
  std::vector<std::uint8_t> bytes;
  CloudTotals totals;
};

/// Which of its two positions a return is written with.
enum class ReturnPosition {
  reported,  ///< measured distance along the believed ray
  actual,    ///< of the surface that was met
};

inline const std::vector<Eigen::Vector3f>& positions_of(const sim::LidarReturns& returns,
                                                        ReturnPosition position) {
  return position == ReturnPosition::reported ? returns.points : returns.true_points;
}

/// How far a file has grown.
struct CloudState {
  CloudTotals totals;
  std::uint64_t bytes = 0;  ///< with its beginning; none: it is about to be begun
};

/// How points become bytes. Immutable; encode() is safe on any number of threads.
class CloudFormat {
 public:
  virtual ~CloudFormat() = default;

  /// The beginning of a file that has grown so far; its length does not depend on that.
  virtual std::vector<std::uint8_t> header(const CloudState& grown) const = 0;

  /// Whether what follows the header is put into pages with checksums (geometry/io/e57/pages.h);
  /// the header is whole pages then.
  virtual bool is_paged() const { return false; }

  /// Replaces what is in `chunk`, whose memory is used again. Throws Error{bad_geometry} if the
  /// format cannot hold a point.
  virtual void encode(const sim::LidarReturns& returns, ReturnPosition position,
                      CloudChunk& chunk) const = 0;

 protected:
  CloudFormat() = default;
  CloudFormat(const CloudFormat&) = default;
  CloudFormat& operator=(const CloudFormat&) = default;
};

/// A file that grows chunk by chunk, and is valid once it is finished.
class CloudFile {
 public:
  /// Begins the file, or goes on with one that had once `grown` so far: what it holds beyond that
  /// is cut off. Throws Error{bad_file} if the file cannot be written, or is shorter.
  CloudFile(std::filesystem::path path, std::shared_ptr<const CloudFormat> format,
            ReturnPosition position = ReturnPosition::reported,
            const std::optional<CloudState>& grown = {});

  void encode(const sim::LidarReturns& returns, CloudChunk& chunk) const {
    format_->encode(returns, position_, chunk);
  }

  /// Throws Error{bad_file} if the disk does not take it.
  void append(const CloudChunk& chunk);

  /// Appends all that another file of this format held when it had `grown` so far. Throws
  /// Error{bad_file} if it is shorter, or if the disk does not take it.
  void append_file(const std::filesystem::path& other, const CloudState& grown);

  /// Completes the header and closes the file. Also after an interrupted scan: what was appended is
  /// then a valid file. Throws Error{bad_file} if the disk does not take it.
  void finish();

  /// Brings what was appended to the disk. Throws Error{bad_file}.
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
  geometry::e57::PageWriter pages_;  ///< of a format that is paged
  CloudState state_;
};

}  // namespace skycap::missions::scan
