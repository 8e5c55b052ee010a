/// The PLY format, for readers and writers of meshes and clouds: reads any elements and properties,
/// in ascii and both binary byte orders; writes binary little-endian files. Source: Turk, "The PLY
/// Polygon File Format", 1994, with the type names that came later (int8 ... float64).
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
  PlyType type;                       ///< of the value, or of a list's values
  std::optional<PlyType> count_type;  ///< set if it is a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// Adds scalar properties of one type.
  void add(PlyType type, std::initializer_list<std::string_view> names);
};

/// Returns the header of a binary little-endian file. The rows follow it, element by element, each
/// value as append_value() of byte_values.h writes it. An empty comment is omitted.
std::string ply_header(std::span<const PlyElement> elements,
                       std::string_view comment = "written by Skycap");

/// Returns the header of a file of one element that is written while it grows: the length of the
/// header does not depend on the number of rows.
std::string growing_ply_header(const PlyElement& element);

/// What was asked for of an element, row by row in the file's order.
struct PlyTable {
  std::uint64_t rows = 0;
  std::vector<std::vector<double>> columns;  ///< as the names were given; empty if there is none
  std::vector<std::uint64_t> list_begin;     ///< row i's list: [list_begin[i], list_begin[i + 1])
  std::vector<std::int64_t> list_values;
};

/// Most values of a list that is read.
inline constexpr std::size_t longest_ply_list = 1'000'000;

/// Reads a PLY file from memory, element after element.
class PlyReader {
 public:
  /// Reads the header. `name` (a path) opens every message; both must outlive the reader. Throws
  /// Error{bad_file}, here and below, naming the line or the row.
  PlyReader(std::string_view name, std::string_view bytes);

  const std::vector<PlyElement>& elements() const { return elements_; }

  /// The next element: of its properties, the scalars with these names. Never allocates more than a
  /// small multiple of the file's size.
  PlyTable read_element(std::span<const std::string_view> scalars);

  /// The same of its next `most_rows` rows, or those that are left, with the first list with one of
  /// these names: numbers take several times the file's bytes. Ends before with the row that brings
  /// the lists to `longest_ply_list` values. With its last row an element is read.
  PlyTable read_rows(std::span<const std::string_view> scalars,
                     std::span<const std::string_view> lists, std::uint64_t most_rows);

 private:
  struct Wanted;
  struct Rows;
  void read_header();
  Wanted wanted_of(const PlyElement& element, std::span<const std::string_view> scalars,
                   std::span<const std::string_view> lists) const;
  void pass_rows(std::uint64_t count);
  void read_scalars(const Rows& rows, const Wanted& wanted, PlyTable& table);
  void require_short(const Rows& rows, const PlyTable& table, std::uint64_t values) const;
  std::int64_t index_of(const Rows& rows, double value) const;
  void read_binary(const Rows& rows, const Wanted& wanted, PlyTable& table);
  void read_ascii(const Rows& rows, const Wanted& wanted, PlyTable& table);
  [[noreturn]] void fail_within(const PlyElement& element, std::uint64_t row) const;
  [[noreturn]] void fail(const std::string& what) const;

  std::string_view name_;
  std::string_view bytes_;
  std::size_t at_ = 0;    // of the first byte that is not read yet
  std::size_t line_ = 1;  // of that byte, in ascii
  enum class Format { ascii, little_endian, big_endian } format_ = Format::ascii;
  std::vector<PlyElement> elements_;
  std::size_t next_element_ = 0;
  std::uint64_t next_row_ = 0;  // of that element
};

}  // namespace skycap::geometry
