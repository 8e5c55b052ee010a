/// What the XML of an E57 file says of its scans (ASTM E2807-11, 8): where each stands, which
/// fields its records have, where they begin. Names with a prefix belong to extensions.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

namespace skycap::geometry::e57 {

/// How the values of a field are stored.
enum class Coding { integer, scaled_integer, single_precision, double_precision, text };

/// One of the values that a record has.
struct Field {
  std::string name;  ///< as in the file, such as "cartesianX" or "nor:normalX"
  Coding coding = Coding::double_precision;
  std::int64_t minimum = std::numeric_limits<std::int64_t>::min();  ///< of integers
  std::int64_t maximum = std::numeric_limits<std::int64_t>::max();
  double scale = 1.0, offset = 0.0;  ///< of scaled integers

  /// Of a value; integers have as many as their interval takes, from none on. 0 of text, whose
  /// length differs.
  unsigned bits() const;
  double value(std::uint64_t stored) const;
};

struct Interval {
  double low = 0.0, high = 0.0;
};

/// One Data3D of a file, with records.
struct ScanDescription {
  Eigen::Isometry3d file_from_scan = Eigen::Isometry3d::Identity();
  std::vector<Field> fields;
  std::uint64_t section = 0;  ///< physical place of its records
  std::uint64_t records = 0;
  /// Of red, green, blue, where the file says them.
  std::array<std::optional<Interval>, 3> colour_limits;

  std::optional<std::size_t> field(const std::string& name) const;
};

struct Description {
  std::string reference_system;  ///< coordinateMetadata, WKT as a rule; empty: the file has none
  std::vector<ScanDescription> scans;
  std::size_t zero_rotations = 0;  ///< scans whose quaternion is four zeros: not rotated
};

/// More bytes of XML are refused: a file of 8000 pictures has about as many.
inline constexpr std::uint64_t longest_description = 16 << 20;

/// Throws Error{bad_file}, whose sentence lacks the file's name. No entities are expanded, nothing
/// else is opened.
Description parse_description(std::string xml);

}  // namespace skycap::geometry::e57
