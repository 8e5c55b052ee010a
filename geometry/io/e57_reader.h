/// E57 files of any size (ASTM E2807-11), piece by piece: all their scans, each put where its pose
/// says. gzip may have compressed the whole file.
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

/// Some points of a scan. Coordinates are the file's.
struct E57Points {
  std::uint32_t scan = 0;   ///< counted from 0, without scans that have no points
  std::size_t records = 0;  ///< of the file that these are of, valid or not
  std::vector<Eigen::Vector3d> positions;
  std::vector<Eigen::Vector3f> normals;              ///< of each, if all scans have them
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< of each, if all scans have them
};

/// Points are given by cartesianX, Y, Z or else by sphericalRange, Azimuth, Elevation. Those that
/// their invalid state marks are passed over, and those that are NaN or infinite are skipped and
/// counted.
class E57Reader {
 public:
  /// Throws Error{bad_file} if the file cannot be read, has no such header, or does not say where
  /// its points are.
  explicit E57Reader(std::filesystem::path path);

  /// What the file says of its coordinates, WKT as a rule; may be empty.
  const std::string& reference_system() const { return description_.reference_system; }
  std::size_t scans() const { return description_.scans.size(); }
  std::uint64_t points() const;
  /// Points so far that were skipped, since a coordinate is NaN or infinite.
  std::size_t skipped() const { return skipped_; }
  /// Scans whose rotation is a quaternion of four zeros, which is taken for none.
  std::size_t zero_rotations() const { return description_.zero_rotations; }

  /// Replaces `points` by the next of the file, from at most `most` of a scan's records: there may
  /// be none that is valid. False at the end. Throws Error{bad_file} if the file is damaged.
  bool next(E57Points& points, std::size_t most = 1 << 16);

 private:
  /// The fields of a scan that are read.
  struct Places {
    bool is_spherical = false;
    std::vector<std::size_t> fields;  ///< three of the position, then what is there:
    std::size_t state = 0, colours = 0, normals = 0;  ///< places among them; 0: not there
  };
  Places places_of(const e57::ScanDescription& scan) const;
  void add_points(std::size_t count, E57Points& points);

  std::unique_ptr<SeekableFile> file_;  ///< which stays where it is when its reader is moved
  std::unique_ptr<e57::Pages> pages_;
  e57::Description description_;
  bool has_colours_ = false, has_normals_ = false;
  std::size_t next_scan_ = 0, skipped_ = 0;
  Places places_;
  std::optional<e57::RecordStream> records_;
};

}  // namespace skycap::geometry
