/// XML section of an E57 file (ASTM E2807-11, section 8): pose, record fields and record offset of
/// each scan. Prefixed names belong to extensions.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace skycap::geometry::e57 {

/// Storage type of a field.
enum class Coding { integer, scaled_integer, single_precision, double_precision, text };

/// Field of a record.
struct Field {
  std::string name;  ///< name in the file, such as "cartesianX" or "nor:normalX"
  Coding coding = Coding::double_precision;
  std::int64_t minimum = std::numeric_limits<std::int64_t>::min();  ///< limits of integers
  std::int64_t maximum = std::numeric_limits<std::int64_t>::max();
  double scale = 1.0, offset = 0.0;  ///< scaled integers only

  /// Returns the number of bits per value. For integers, this is the size needed for their
  /// interval, which may be zero. Text has a variable length and returns 0.
  unsigned bits() const;
  double value(std::uint64_t stored) const;
};

struct Interval {
  double low = 0.0, high = 0.0;
};

/// Data3D element of a file that has records.
struct ScanDescription {
  Eigen::Isometry3d file_from_scan = Eigen::Isometry3d::Identity();
  std::vector<Field> fields;
  std::uint64_t section = 0;  ///< physical offset of the records in the file
  std::uint64_t records = 0;
  /// Limits of red, green and blue, if the file states them.
  std::array<std::optional<Interval>, 3> colour_limits;

  std::optional<std::size_t> field(const std::string& name) const;
};

struct Description {
  std::string reference_system;  ///< coordinateMetadata, usually WKT; empty if the file has none
  std::vector<ScanDescription> scans;
  std::size_t zero_rotations =
      0;  ///< number of scans whose quaternion is four zeros, read as no rotation
};

/// Maximum size of the XML section [bytes]. A file with 8000 images has about as many.
inline constexpr std::uint64_t longest_description = 16 << 20;

/// Parses the XML section. Does not expand entities or open external resources. Throws
/// Error{bad_file} without the file name in the message.
Description parse_description(std::string xml);

}  // namespace skycap::geometry::e57
