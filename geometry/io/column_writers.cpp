// Writers of column_cloud.h.
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <functional>
#include <utility>

#include "geometry/byte_values.h"
#include "geometry/error.h"
#include "geometry/io/cloud_parsers.h"
#include "geometry/io/column_cloud.h"
#include "geometry/io/column_formats.h"
#include "geometry/io/e57/crc32c.h"
#include "geometry/io/e57/pages.h"
#include "geometry/io/e57/scan_file.h"
#include "geometry/io/file.h"
#include "geometry/io/text/ply.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;

/// Returns the upper 8 of 16 bits.
std::uint8_t upper_byte(float word) {
  return static_cast<std::uint8_t>(static_cast<unsigned>(word) >> 8U);
}

bool has_single_precision(const ColumnCloud& cloud) {
  return std::ranges::all_of(cloud.positions, [](const Eigen::Vector3d& position) {
    return position == position.cast<float>().cast<double>();
  });
}

bool has_byte_colours(const ColumnCloud& cloud) {
  for (const CloudColumn name : {CloudColumn::red, CloudColumn::green, CloudColumn::blue}) {
    const auto is_byte = [](float word) { return word == 257.0F * upper_byte(word); };
    if (!std::ranges::all_of(cloud.column(name), is_byte)) return false;
  }
  return true;
}

/// Property of a point in a file.
struct OutputField {
  std::string ply_name, pcd_name;
  PlyType type;
  std::function<double(std::size_t point)> value;
};

constexpr std::array<std::pair<CloudColumn, const char*>, 3> byte_columns = {
    {{CloudColumn::classification, "classification"},
     {CloudColumn::return_number, "return_number"},
     {CloudColumn::returns, "returns"}}};

/// Returns the fields of a cloud in the order of the file, without colours.
std::vector<OutputField> output_fields(const ColumnCloud& cloud) {
  std::vector<OutputField> fields;
  const PlyType real = has_single_precision(cloud) ? PlyType::float32 : PlyType::float64;
  constexpr std::array<const char*, 3> axes = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    fields.push_back({axes[axis], axes[axis], real, [&cloud, axis](std::size_t i) {
                        return cloud.positions[i][static_cast<Eigen::Index>(axis)];
                      }});
  }
  const auto add = [&](CloudColumn name, const std::string& ply, const std::string& pcd,
                       PlyType type) {
    const std::vector<float>& values = cloud.column(name);
    if (values.empty()) return;
    fields.push_back({ply, pcd, type, [&values, type](std::size_t i) {
                        return type == PlyType::uint8 ? rounded_byte(values[i], 255.0F) : values[i];
                      }});
  };
  add(CloudColumn::normal_x, "nx", "normal_x", PlyType::float32);
  add(CloudColumn::normal_y, "ny", "normal_y", PlyType::float32);
  add(CloudColumn::normal_z, "nz", "normal_z", PlyType::float32);
  add(CloudColumn::intensity, "intensity", "intensity", PlyType::float32);
  if (!cloud.times.empty()) {
    fields.push_back(
        {"time", "time", PlyType::float64, [&cloud](std::size_t i) { return cloud.times[i]; }});
  }
  for (const auto& [name, text] : byte_columns) add(name, text, text, PlyType::uint8);
  return fields;
}

std::uint32_t pack_colour(const ColumnCloud& cloud, std::size_t i) {
  std::uint32_t packed = 0;
  for (const CloudColumn name : {CloudColumn::red, CloudColumn::green, CloudColumn::blue}) {
    packed = packed << 8 | upper_byte(cloud.column(name)[i]);
  }
  return packed;
}

std::size_t size_of(PlyType type) {
  return type == PlyType::uint8 ? 1 : type == PlyType::float64 ? 8 : 4;
}

void append_number(std::string& bytes, PlyType type, double value) {
  if (type == PlyType::uint8) append_value(bytes, static_cast<std::uint8_t>(value));
  if (type == PlyType::uint32) append_value(bytes, static_cast<std::uint32_t>(value));
  if (type == PlyType::float32) append_value(bytes, static_cast<float>(value));
  if (type == PlyType::float64) append_value(bytes, value);
}

/// File that is written in pieces.
class Output {
 public:
  explicit Output(const fs::path& path)
      : path_(path), stream_(path, std::ios::binary | std::ios::trunc) {}

  std::string bytes;

  void write_if_large() {
    constexpr std::size_t large = 1 << 20;
    if (bytes.size() >= large) write();
  }

  void finish() {
    write();
    stream_.close();
    require_success();
  }

 private:
  void write() {
    stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.clear();
    require_success();
  }

  void require_success() const {
    if (!stream_) throw Error(ErrorKind::bad_file, path_.string() + ": cannot be written");
  }

  const fs::path& path_;
  std::ofstream stream_;
};

void write_rows(Output& output, const ColumnCloud& cloud, const std::vector<OutputField>& fields) {
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    for (const OutputField& field : fields) append_number(output.bytes, field.type, field.value(i));
    output.write_if_large();
  }
  output.finish();
}

void write_ply(const fs::path& path, const ColumnCloud& cloud) {
  std::vector<OutputField> fields = output_fields(cloud);
  constexpr std::array<const char*, 3> names = {"red", "green", "blue"};
  for (std::size_t channel = 0; cloud.has_colours() && channel < 3; ++channel) {
    const std::vector<float>& values =
        cloud.columns[static_cast<std::size_t>(CloudColumn::red) + channel];
    fields.push_back({names[channel], "", PlyType::uint8,
                      [&values](std::size_t i) { return upper_byte(values[i]); }});
  }
  PlyElement vertex{"vertex", cloud.positions.size(), {}};
  for (const OutputField& field : fields) vertex.add(field.type, {field.ply_name});
  Output output(path);
  output.bytes = ply_header({&vertex, 1});
  write_rows(output, cloud, fields);
}

void write_pcd(const fs::path& path, const ColumnCloud& cloud) {
  std::vector<OutputField> fields = output_fields(cloud);
  if (cloud.has_colours()) {
    fields.push_back({"", "rgb", PlyType::uint32, [&cloud](std::size_t i) {
                        return static_cast<double>(pack_colour(cloud, i));
                      }});
  }
  std::string names, sizes, types, counts;
  for (const OutputField& field : fields) {
    names += " " + field.pcd_name;
    sizes += " " + std::to_string(size_of(field.type));
    const bool is_whole = field.type == PlyType::uint8 || field.type == PlyType::uint32;
    types += is_whole ? " U" : " F";
    counts += " 1";
  }
  const std::string count = std::to_string(cloud.positions.size());
  Output output(path);
  output.bytes =
      "# .PCD v0.7 - Point Cloud Data file format, written by Skycap\nVERSION 0.7\n"
      "FIELDS" +
      names + "\nSIZE" + sizes + "\nTYPE" + types + "\nCOUNT" + counts + "\nWIDTH " + count +
      "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
  write_rows(output, cloud, fields);
}

template <typename Number>
void append_number_text(std::string& text, Number number, char end) {
  std::array<char, 40> digits{};
  text.append(digits.data(),
              std::to_chars(digits.data(), digits.data() + digits.size(), number).ptr);
  text += end;
}

void write_xyz(const fs::path& path, const ColumnCloud& cloud) {
  std::vector<OutputField> fields = output_fields(cloud);
  constexpr std::array<const char*, 3> names = {"red", "green", "blue"};
  for (std::size_t channel = 0; cloud.has_colours() && channel < 3; ++channel) {
    const std::vector<float>& values =
        cloud.columns[static_cast<std::size_t>(CloudColumn::red) + channel];
    fields.push_back({names[channel], "", PlyType::uint32,
                      [&values](std::size_t i) { return double{values[i]}; }});
  }
  Output output(path);
  for (const OutputField& field : fields) {
    output.bytes += (output.bytes.empty() ? "# " : " ") + field.ply_name;
  }
  output.bytes += '\n';
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    for (const OutputField& field : fields) {
      const char end = &field == &fields.back() ? '\n' : ' ';
      const double value = field.value(i);
      if (field.type == PlyType::float32) {
        append_number_text(output.bytes, static_cast<float>(value), end);
      } else {
        append_number_text(output.bytes, value, end);
      }
    }
    output.write_if_large();
  }
  output.finish();
}

void write_e57(const fs::path& path, const ColumnCloud& cloud) {
  e57::WrittenScan scan;
  scan.reference_system = cloud.crs_wkt;
  std::vector<std::string> columns;
  const std::size_t count = cloud.positions.size();
  const auto add = [&](const char* name, e57::Coding coding, const auto& value) {
    e57::Field field{name, coding};
    if (coding == e57::Coding::integer) {
      field.minimum = 0;
      field.maximum = 255;
    }
    scan.fields.push_back(field);
    std::string& column = columns.emplace_back();
    column.reserve(count * sizeof(value(0)));
    for (std::size_t i = 0; i < count; ++i) append_value(column, value(i));
  };
  constexpr std::array<const char*, 3> axes = {"cartesianX", "cartesianY", "cartesianZ"};
  const bool is_single = has_single_precision(cloud);
  for (int axis = 0; axis < 3; ++axis) {
    const char* const name = axes[static_cast<std::size_t>(axis)];
    if (is_single) {
      add(name, e57::Coding::single_precision,
          [&](std::size_t i) { return static_cast<float>(cloud.positions[i][axis]); });
    } else {
      add(name, e57::Coding::double_precision,
          [&](std::size_t i) { return cloud.positions[i][axis]; });
    }
  }
  const auto add_real = [&](const char* name, CloudColumn column) {
    const std::vector<float>& values = cloud.column(column);
    if (values.empty()) return;
    add(name, e57::Coding::single_precision, [&](std::size_t i) { return values[i]; });
  };
  const auto add_byte = [&](const char* name, CloudColumn column, const auto& byte) {
    const std::vector<float>& values = cloud.column(column);
    if (values.empty()) return;
    add(name, e57::Coding::integer, [&](std::size_t i) { return byte(values[i]); });
  };
  add_real("nor:normalX", CloudColumn::normal_x);
  add_real("nor:normalY", CloudColumn::normal_y);
  add_real("nor:normalZ", CloudColumn::normal_z);
  add_byte("colorRed", CloudColumn::red, upper_byte);
  add_byte("colorGreen", CloudColumn::green, upper_byte);
  add_byte("colorBlue", CloudColumn::blue, upper_byte);
  add_real("intensity", CloudColumn::intensity);
  if (!cloud.times.empty()) {
    add("timeStamp", e57::Coding::double_precision, [&](std::size_t i) { return cloud.times[i]; });
  }
  add_byte("returnIndex", CloudColumn::return_number,
           [](float value) { return rounded_byte(value - 1.0F, 255.0F); });
  add_byte("returnCount", CloudColumn::returns,
           [](float value) { return rounded_byte(value, 255.0F); });
  for (const Eigen::Vector3d& position : cloud.positions) scan.bounds.extend(position);
  const std::string packets = count == 0 ? "" : e57::make_packets(scan.fields, columns);
  scan.records = count;
  scan.checksum = e57::crc32c(packets);
  scan.packets_size = packets.size();
  Output output(path);
  output.bytes = e57::make_file_head(scan) + e57::sealed(packets);
  output.finish();
}

}  // namespace

bool is_written_cloud(const fs::path& path) {
  constexpr std::array<std::string_view, 9> extensions = {".ply", ".pcd", ".las", ".laz", ".e57",
                                                          ".xyz", ".txt", ".asc", ".csv"};
  return path.extension() != ".gz" &&
         std::ranges::find(extensions, lower_extension(path)) != extensions.end();
}

std::vector<std::string> write_column_cloud(const fs::path& path, const ColumnCloud& cloud) {
  const std::string extension = lower_extension(path);
  std::vector<std::string> lost;
  const bool is_las = extension == ".las" || extension == ".laz", is_e57 = extension == ".e57";
  if (is_las) {
    write_las_columns(path, cloud, lost);
  } else if (is_e57) {
    write_e57(path, cloud);
  } else if (extension == ".ply") {
    write_ply(path, cloud);
  } else if (extension == ".pcd") {
    write_pcd(path, cloud);
  } else {
    write_xyz(path, cloud);
  }
  if (!is_las && !is_e57 && !cloud.crs_wkt.empty()) {
    lost.emplace_back("the reference system is not kept");
  }
  if (is_e57 && !cloud.column(CloudColumn::classification).empty()) {
    lost.emplace_back("classes are not kept");
  }
  const bool has_words = is_las || (extension != ".ply" && extension != ".pcd" && !is_e57);
  if (!has_words && !has_byte_colours(cloud)) {
    lost.emplace_back("colours are reduced to 8 bits per channel");
  }
  return lost;
}

}  // namespace skycap::geometry
