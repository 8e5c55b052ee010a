#include "geometry/io/cloud_io.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "geometry/error.h"
#include "geometry/io/cloud_parsers.h"
#include "geometry/io/file.h"
#include "geometry/io/ply.h"
#include "geometry/io/text_scanner.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;

// Beyond this, neighbouring single-precision numbers are 2 mm apart.
constexpr double farthest_coordinate = 16384.0;

AttributedCloud parse_ply_cloud(const fs::path& path, std::string_view bytes) {
  constexpr std::array<std::string_view, 10> names{"x",  "y",    "z",   "nx",    "ny",
                                                   "nz", "view", "red", "green", "blue"};
  const std::string name = path.string();
  PlyReader reader(name, bytes);
  for (const PlyElement& element : reader.elements()) {
    const PlyTable table = reader.read_element(names, {});
    if (element.name != "vertex") continue;
    const auto& columns = table.columns;
    const auto has = [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i <= last; ++i) {
        if (columns[i].size() != element.count) return false;
      }
      return true;
    };
    if (!has(0, 2)) fail_cloud(path, "the element 'vertex' must have the properties x, y and z");
    const bool has_normals = has(3, 5), has_views = has(6, 6), has_colours = has(7, 9);
    const auto integer = [&](std::size_t column, std::size_t row, double largest) {
      const double value = columns[column][row];
      if (!(value >= 0.0 && value <= largest && value == std::floor(value))) {
        fail_cloud(path, "point " + std::to_string(row) + " has the " + std::string(names[column]) +
                             " " + std::to_string(value) +
                             "; it must be a whole number from 0 to " +
                             std::to_string(static_cast<std::uint64_t>(largest)));
      }
      return value;
    };
    AttributedCloud cloud;
    cloud.positions.reserve(element.count);
    cloud.normals.reserve(has_normals ? element.count : 0);
    cloud.views.reserve(has_views ? element.count : 0);
    cloud.colours.reserve(has_colours ? element.count : 0);
    for (std::size_t i = 0; i < element.count; ++i) {
      cloud.positions.push_back(
          cloud_position(path, i, columns[0][i], columns[1][i], columns[2][i]));
      if (has_normals) {
        cloud.normals.push_back(
            Eigen::Vector3d(columns[3][i], columns[4][i], columns[5][i]).cast<float>());
      }
      if (has_views) {
        constexpr double largest = std::numeric_limits<std::uint32_t>::max();
        cloud.views.push_back(static_cast<std::uint32_t>(integer(6, i, largest)));
      }
      if (!has_colours) continue;
      auto& colour = cloud.colours.emplace_back();
      for (std::size_t channel = 0; channel < 3; ++channel) {
        colour[channel] = static_cast<std::uint8_t>(integer(7 + channel, i, 255.0));
      }
    }
    return cloud;
  }
  fail_cloud(path, "there is no element 'vertex'; a cloud must have one");
}

AttributedCloud parse_xyz_cloud(const fs::path& path, std::string_view text) {
  const std::string name = path.string();
  TextScanner scanner(name, text);
  AttributedCloud cloud;
  do {
    const auto x = scanner.word_in_line();
    if (!x || x->starts_with('#')) continue;
    std::array<double, 3> position{};
    position[0] = scanner.number<double>(x, "a coordinate");
    position[1] = scanner.number<double>(scanner.word_in_line(), "a coordinate");
    position[2] = scanner.number<double>(scanner.word_in_line(), "a coordinate");
    cloud.positions.push_back(
        cloud_position(path, cloud.positions.size(), position[0], position[1], position[2]));
  } while (scanner.next_line());
  return cloud;
}

template <typename Value>
void append_bytes(std::string& bytes, const Value& value) {
  static_assert(std::endian::native == std::endian::little, "binary files are little-endian");
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// Readers of formats that are not read whole before they are parsed.
struct PiecewiseReader {
  AttributedCloud (*cloud)(const fs::path& path);
  void (*positions)(const fs::path& path, const TakePositions& take);
};

std::optional<PiecewiseReader> piecewise_reader(std::string_view ending) {
  if (ending == ".las" || ending == ".laz") return {{read_las_cloud, read_las_positions}};
  if (ending == ".e57") return {{read_e57_cloud, read_e57_positions}};
  return std::nullopt;
}

}  // namespace

void fail_cloud(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::bad_file, path.string() + ": " + what);
}

Eigen::Vector3f cloud_position(const fs::path& path, std::size_t point, double x, double y,
                               double z) {
  const Eigen::Vector3d position(x, y, z);
  if (!position.allFinite()) {
    fail_cloud(path,
               "point " + std::to_string(point) + " has a coordinate that is not a finite number");
  }
  if (position.cwiseAbs().maxCoeff() > farthest_coordinate) {
    fail_cloud(path, "point " + std::to_string(point) + " is " +
                         std::to_string(position.cwiseAbs().maxCoeff()) +
                         " m from the origin; coordinates must be local, within 16384 m: subtract "
                         "an offset");
  }
  return position.cast<float>();
}

void add_positions(const fs::path& path, std::size_t first,
                   std::span<const Eigen::Vector3d> positions, std::vector<Eigen::Vector3f>& to) {
  for (const Eigen::Vector3d& position : positions) {
    to.push_back(cloud_position(path, first++, position.x(), position.y(), position.z()));
  }
}

void require_few_points(const fs::path& path, std::size_t points) {
  if (points <= most_whole_points) return;
  fail_cloud(path, "holds more than " + std::to_string(most_whole_points) +
                       " points; thin it, or evaluate it as LAS or E57, which is read piece by "
                       "piece");
}

AttributedCloud read_cloud(const fs::path& path) {
  const std::string ending = ending_of(path);
  using Parse = AttributedCloud (*)(const fs::path&, std::string_view);
  const std::map<std::string, Parse> formats = {{".ply", parse_ply_cloud},
                                                {".pcd", parse_pcd_cloud},
                                                {".xyz", parse_xyz_cloud},
                                                {".txt", parse_xyz_cloud},
                                                {".asc", parse_xyz_cloud}};
  const auto format = formats.find(ending);
  const auto piecewise = piecewise_reader(ending);
  if (format == formats.end() && !piecewise) {
    fail_cloud(path,
               "a cloud file must end in .ply, .pcd, .las, .laz, .e57, .xyz, .txt or .asc (or with "
               ".gz after it)");
  }
  AttributedCloud cloud =
      piecewise ? piecewise->cloud(path)
                : format->second(path, read_file(path, largest_whole_file, largest_unpacked_cloud));
  if (cloud.positions.empty()) fail_cloud(path, "holds no points");
  return cloud;
}

void read_positions(const fs::path& path, const TakePositions& take) {
  if (const auto piecewise = piecewise_reader(ending_of(path))) {
    return piecewise->positions(path, take);
  }
  const std::vector<Eigen::Vector3f> positions = read_cloud(path).positions;
  for (std::size_t begin = 0; begin < positions.size(); begin += piece_size) {
    const std::size_t count = std::min(piece_size, positions.size() - begin);
    take(std::span(positions).subspan(begin, count),
         static_cast<double>(begin + count) / static_cast<double>(positions.size()));
  }
}

void write_cloud(const fs::path& path, const CloudColumns& cloud) {
  const std::size_t count = cloud.positions.size();
  assert(cloud.normals.empty() || cloud.normals.size() == count);
  assert(cloud.views.empty() || cloud.views.size() == count);
  assert(cloud.colours.empty() || cloud.colours.size() == count);
  if (path.extension() == ".e57") return write_file(path, e57_bytes(cloud));
  std::string bytes = "ply\nformat binary_little_endian 1.0\ncomment written by Skycap\n";
  bytes += "element vertex " + std::to_string(count) + "\n";
  bytes += "property float x\nproperty float y\nproperty float z\n";
  if (!cloud.normals.empty()) bytes += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!cloud.views.empty()) bytes += "property uint view\n";
  if (!cloud.colours.empty()) {
    bytes += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  }
  for (const NamedMarks& marks : cloud.marks) {
    assert(marks.values.empty() || marks.values.size() == count);
    if (!marks.values.empty()) bytes.append("property uchar ").append(marks.name).append("\n");
  }
  bytes += "end_header\n";
  constexpr std::size_t largest_point = 31;  // [bytes]
  bytes.reserve(bytes.size() + count * (largest_point + cloud.marks.size()));
  for (std::size_t i = 0; i < count; ++i) {
    append_bytes(bytes, cloud.positions[i]);
    if (!cloud.normals.empty()) append_bytes(bytes, cloud.normals[i]);
    if (!cloud.views.empty()) append_bytes(bytes, cloud.views[i]);
    if (!cloud.colours.empty()) append_bytes(bytes, cloud.colours[i]);
    for (const NamedMarks& marks : cloud.marks) {
      if (!marks.values.empty()) append_bytes(bytes, marks.values[i]);
    }
  }
  write_file(path, bytes);
}

}  // namespace skycap::geometry
