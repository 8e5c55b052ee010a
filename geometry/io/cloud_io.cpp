#include "geometry/io/cloud_io.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <functional>
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

/// Takes a piece of a cloud whose first point has that number, of so many.
using TakePiece =
    std::function<void(const AttributedCloud& piece, std::size_t first, std::size_t count)>;

constexpr std::array<std::string_view, 10> ply_names{"x",  "y",    "z",   "nx",    "ny",
                                                     "nz", "view", "red", "green", "blue"};

AttributedCloud ply_piece(const fs::path& path, const PlyTable& table, std::size_t first,
                          std::size_t count) {
  const auto& columns = table.columns;
  const auto has = [&](std::size_t begin, std::size_t last) {
    for (std::size_t i = begin; i <= last; ++i) {
      if (columns[i].size() != count) return false;
    }
    return true;
  };
  if (!has(0, 2)) fail_cloud(path, "the element 'vertex' must have the properties x, y and z");
  const bool has_normals = has(3, 5), has_views = has(6, 6), has_colours = has(7, 9);
  const auto integer = [&](std::size_t column, std::size_t row, double largest) {
    const double value = columns[column][row];
    if (!(value >= 0.0 && value <= largest && value == std::floor(value))) {
      fail_cloud(path, "point " + std::to_string(first + row) + " has the " +
                           std::string(ply_names[column]) + " " + std::to_string(value) +
                           "; it must be a whole number from 0 to " +
                           std::to_string(static_cast<std::uint64_t>(largest)));
    }
    return value;
  };
  AttributedCloud cloud;
  cloud.positions.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    cloud.positions.push_back(
        cloud_position(path, first + i, columns[0][i], columns[1][i], columns[2][i]));
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

void take_ply(const fs::path& path, std::string_view bytes, const TakePiece& take) {
  const std::string name = path.string();
  PlyReader reader(name, bytes);
  for (const PlyElement& element : reader.elements()) {
    if (element.name != "vertex") {
      reader.read_element({});
      continue;
    }
    std::size_t first = 0;
    do {
      const PlyTable table = reader.read_rows(ply_names, {}, piece_size);
      const std::size_t count = std::min<std::size_t>(piece_size, element.count - first);
      take(ply_piece(path, table, first, count), first, element.count);
      first += count;
    } while (first < element.count);
    return;
  }
  fail_cloud(path, "there is no element 'vertex'; a cloud must have one");
}

AttributedCloud parse_ply_cloud(const fs::path& path, std::string_view bytes) {
  AttributedCloud cloud;
  const auto append = [](auto& all, const auto& more, std::size_t count) {
    if (all.empty() && !more.empty()) all.reserve(count);
    all.insert(all.end(), more.begin(), more.end());
  };
  take_ply(path, bytes, [&](const AttributedCloud& piece, std::size_t, std::size_t count) {
    require_few_points(path, count);
    append(cloud.positions, piece.positions, count);
    append(cloud.normals, piece.normals, count);
    append(cloud.views, piece.views, count);
    append(cloud.colours, piece.colours, count);
  });
  return cloud;
}

/// Hands on pieces, and how many bytes are read with them.
void take_xyz(const fs::path& path, std::string_view text,
              const std::function<void(std::span<const Eigen::Vector3f>, std::size_t)>& take) {
  const std::string name = path.string();
  TextScanner scanner(name, text);
  std::vector<Eigen::Vector3f> piece;
  std::size_t count = 0;
  const auto hand_on = [&] {
    if (!piece.empty()) take(piece, text.size() - scanner.remaining());
    piece.clear();
  };
  do {
    const auto x = scanner.word_in_line();
    if (!x || x->starts_with('#')) continue;
    std::array<double, 3> position{};
    position[0] = scanner.number<double>(x, "a coordinate");
    position[1] = scanner.number<double>(scanner.word_in_line(), "a coordinate");
    position[2] = scanner.number<double>(scanner.word_in_line(), "a coordinate");
    piece.push_back(cloud_position(path, count++, position[0], position[1], position[2]));
    if (piece.size() == piece_size) hand_on();
  } while (scanner.next_line());
  hand_on();
}

AttributedCloud parse_xyz_cloud(const fs::path& path, std::string_view text) {
  AttributedCloud cloud;
  take_xyz(path, text, [&](std::span<const Eigen::Vector3f> piece, std::size_t) {
    cloud.positions.insert(cloud.positions.end(), piece.begin(), piece.end());
    require_few_points(path, cloud.positions.size());
  });
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

namespace {

bool is_text_cloud(const fs::path& path) {
  const std::string ending = ending_of(path);
  return ending == ".xyz" || ending == ".txt" || ending == ".asc";
}

/// Of files that are read whole, but whose points are not held at once.
void read_file_positions(const fs::path& path, const TakePositions& take) {
  const std::string bytes = read_file(path, largest_whole_file, largest_unpacked_cloud);
  bool has_points = false;
  const auto hand_on = [&](std::span<const Eigen::Vector3f> piece, double read, double all) {
    if (piece.empty()) return;
    has_points = true;
    take(piece, read / all);
  };
  if (is_text_cloud(path)) {
    const auto all = static_cast<double>(bytes.size());
    take_xyz(path, bytes, [&](std::span<const Eigen::Vector3f> piece, std::size_t read) {
      hand_on(piece, static_cast<double>(read), all);
    });
  } else {
    take_ply(path, bytes, [&](const AttributedCloud& piece, std::size_t first, std::size_t all) {
      hand_on(piece.positions, static_cast<double>(first + piece.positions.size()),
              static_cast<double>(all));
    });
  }
  if (!has_points) fail_cloud(path, "holds no points");
}

}  // namespace

void read_positions(const fs::path& path, const TakePositions& take) {
  if (const auto piecewise = piecewise_reader(ending_of(path))) {
    return piecewise->positions(path, take);
  }
  if (is_text_cloud(path) || ending_of(path) == ".ply") return read_file_positions(path, take);
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
