/// PLY format for meshes and clouds. Reads any elements and properties in ASCII and both binary
/// byte orders; writes binary little-endian files. Source: Turk, "The PLY Polygon File Format",
/// 1994, with the later type names (int8 ... float64).
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace skycap::geometry {

enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
  std::string name;
  PlyType type;                       ///< type of the value or of the list values
  std::optional<PlyType> count_type;  ///< set for lists only
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Adds scalar properties of one type.
  void add(PlyType type, std::initializer_list<std::string_view> names);
};

/// Returns the header of a binary little-endian file. It must be followed by the rows of each
/// element, with values written by append_value() of byte_values.h. An empty comment is omitted.
std::string ply_header(std::span<const PlyElement> elements,
                       std::string_view comment = "written by Skycap");

/// Returns the header of a file of one element that is written while it grows: the length of the
/// header does not depend on the number of rows.
std::string growing_ply_header(const PlyElement& element);

/// Requested values of an element in file order.
struct PlyTable {
  std::uint64_t rows = 0;
  std::vector<std::vector<double>>
      columns;  ///< one per requested name; empty if the property is absent
  std::vector<std::uint64_t> list_begin;  ///< list of row i: [list_begin[i], list_begin[i + 1])
  std::vector<std::int64_t> list_values;
};

/// Maximum length of a list.
inline constexpr std::size_t longest_ply_list = 1'000'000;

/// Reads a PLY file from memory, one element after another.
class PlyReader {
 public:
  /// Reads the header. Every message begins with `name`, usually a path. `name` and `bytes` must
  /// outlive the reader. All member functions throw Error{bad_file} that names the line or row.
  PlyReader(std::string_view name, std::string_view bytes);

  const std::vector<PlyElement>& elements() const { return elements_; }

  /// Reads the scalar properties with these names of the next element. Allocates at most a small
  /// multiple of the file size.
  PlyTable read_element(std::span<const std::string_view> scalars);

  /// Reads up to `max_rows` further rows of the current element, because numbers take several
  /// times the memory of the file. Reads the first list property with one of the names `lists`.
  /// Stops early after the row with which the lists reach `longest_ply_list` values. After its last
  /// row, the element is complete.
  PlyTable read_rows(std::span<const std::string_view> scalars,
                     std::span<const std::string_view> lists, std::uint64_t max_rows);

 private:
  struct PropertyIndices;
  struct Rows;
  void read_header();
  PropertyIndices find_property_indices(const PlyElement& element,
                                        std::span<const std::string_view> scalars,
                                        std::span<const std::string_view> lists) const;
  void pass_rows(std::uint64_t count);
  void read_scalars(const Rows& rows, const PropertyIndices& property_indices, PlyTable& table);
  void require_short(const Rows& rows, const PlyTable& table, std::uint64_t values) const;
  std::int64_t parse_index(const Rows& rows, double value) const;
  void read_binary(const Rows& rows, const PropertyIndices& property_indices, PlyTable& table);
  void read_ascii(const Rows& rows, const PropertyIndices& property_indices, PlyTable& table);
  [[noreturn]] void fail_within(const PlyElement& element, std::uint64_t row) const;
  [[noreturn]] void fail(const std::string& what) const;

  std::string_view name_;
  std::string_view bytes_;
  std::size_t at_ = 0;    // offset of the first unread byte
  std::size_t line_ = 1;  // line of that byte in ASCII files
  enum class Format { ascii, little_endian, big_endian } format_ = Format::ascii;
  std::vector<PlyElement> elements_;
  std::size_t next_element_ = 0;
  std::uint64_t next_row_ = 0;  // row of that element
};

}  // namespace skycap::geometry
