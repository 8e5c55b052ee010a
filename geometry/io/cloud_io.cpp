#include "geometry/io/cloud_io.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "geometry/byte_values.h"
#include "geometry/error.h"
#include "geometry/io/cloud_parsers.h"
#include "geometry/io/file.h"
#include "geometry/io/text/plain_text.h"
#include "geometry/io/text/ply.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;

/// Receives a piece of a cloud, the number of points of the file read so far, and the total number.
using ChunkCallback =
    std::function<void(const AttributedCloud& chunk, std::size_t read, std::size_t all)>;

constexpr std::array<std::string_view, 10> ply_names{"x",  "y",    "z",   "nx",    "ny",
                                                     "nz", "view", "red", "green", "blue"};

/// Number format of the colours of a PLY file.
enum class ColourScale { none, bytes, words, reals };

ColourScale find_colour_scale(const PlyElement& element) {
  ColourScale scale = ColourScale::none;
  for (const std::string_view name : {"red", "green", "blue"}) {
    const auto property = std::ranges::find(element.properties, name, &PlyProperty::name);
    if (property == element.properties.end()) return ColourScale::none;
    const bool is_real = property->type == PlyType::float32 || property->type == PlyType::float64;
    scale = is_real                             ? ColourScale::reals
            : property->type == PlyType::uint16 ? ColourScale::words
                                                : ColourScale::bytes;
  }
  return scale;
}

/// Converts a colour to bytes. Returns nullopt if a number is outside the scale.
std::optional<std::array<std::uint8_t, 3>> make_colour(const std::array<double, 3>& numbers,
                                                       ColourScale scale) {
  const double max = scale == ColourScale::bytes   ? 255.0
                     : scale == ColourScale::words ? 65535.0
                                                   : 1.0;
  std::array<std::uint8_t, 3> colour{};
  for (std::size_t channel = 0; channel < 3; ++channel) {
    const double value = numbers[channel];
    if (!(value >= 0.0 && value <= max)) return std::nullopt;
    const double byte = scale == ColourScale::words   ? std::floor(value / 256.0)
                        : scale == ColourScale::reals ? std::round(255.0 * value)
                                                      : value;
    if (byte != std::floor(byte)) return std::nullopt;
    colour[channel] = static_cast<std::uint8_t>(byte);
  }
  return colour;
}

std::uint32_t parse_view_index(const fs::path& path, std::size_t point, double value) {
  constexpr double max = std::numeric_limits<std::uint32_t>::max();
  if (value >= 0.0 && value <= max && value == std::floor(value)) {
    return static_cast<std::uint32_t>(value);
  }
  fail_cloud(path, "point " + std::to_string(point) + " has the view " + std::to_string(value) +
                       "; it must be an integer from 0 to 4294967295");
}

/// Returns no colours if any of them is outside the scale, because the scale is then unknown.
AttributedCloud ply_chunk(const fs::path& path, const PlyTable& table, ColourScale scale,
                          std::size_t first, std::size_t count) {
  const auto& columns = table.columns;
  const auto has = [&](std::size_t begin, std::size_t last) {
    for (std::size_t i = begin; i <= last; ++i) {
      if (columns[i].size() != count) return false;
    }
    return true;
  };
  if (!has(0, 2)) fail_cloud(path, "the element 'vertex' must have the properties x, y and z");
  const bool has_normals = has(3, 5), has_views = has(6, 6);
  bool has_colours = has(7, 9) && scale != ColourScale::none;
  AttributedCloud cloud;
  cloud.positions.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d point(columns[0][i], columns[1][i], columns[2][i]);
    if (!point.allFinite()) {
      ++cloud.skipped;
      continue;
    }
    cloud.positions.push_back(cloud_position(path, first + i, point.x(), point.y(), point.z()));
    if (has_normals) {
      cloud.normals.push_back(
          Eigen::Vector3d(columns[3][i], columns[4][i], columns[5][i]).cast<float>());
    }
    if (has_views) cloud.views.push_back(parse_view_index(path, first + i, columns[6][i]));
    if (!has_colours) continue;
    const auto colour = make_colour({columns[7][i], columns[8][i], columns[9][i]}, scale);
    has_colours = colour.has_value();
    if (colour) cloud.colours.push_back(*colour);
  }
  if (!has_colours) cloud.colours.clear();
  return cloud;
}

void read_ply_chunks(const fs::path& path, std::string_view bytes, const ChunkCallback& callback) {
  const std::string name = path.string();
  PlyReader reader(name, bytes);
  for (const PlyElement& element : reader.elements()) {
    if (element.name != "vertex") {
      reader.read_element({});
      continue;
    }
    const ColourScale scale = find_colour_scale(element);
    std::size_t first = 0;
    do {
      const PlyTable table = reader.read_rows(ply_names, {}, points_per_chunk);
      const std::size_t count = std::min<std::size_t>(points_per_chunk, element.count - first);
      callback(ply_chunk(path, table, scale, first, count), first + count, element.count);
      first += count;
    } while (first < element.count);
    return;
  }
  fail_cloud(path, "missing element 'vertex'");
}

AttributedCloud parse_ply_cloud(const fs::path& path, std::string_view bytes) {
  AttributedCloud cloud;
  const auto append = [](auto& all, const auto& more, std::size_t count) {
    if (all.empty() && !more.empty()) all.reserve(count);
    all.insert(all.end(), more.begin(), more.end());
  };
  read_ply_chunks(path, bytes, [&](const AttributedCloud& chunk, std::size_t, std::size_t count) {
    require_few_points(path, count);
    append(cloud.positions, chunk.positions, count);
    append(cloud.normals, chunk.normals, count);
    append(cloud.views, chunk.views, count);
    append(cloud.colours, chunk.colours, count);
    cloud.skipped += chunk.skipped;
  });
  if (cloud.colours.size() != cloud.positions.size()) cloud.colours.clear();
  return cloud;
}

AttributedCloud parse_text_cloud(const fs::path& path, std::string_view text) {
  AttributedCloud cloud;
  cloud.skipped =
      read_text_cloud(path, text, [&](std::span<const Eigen::Vector3f> chunk, std::size_t) {
        cloud.positions.insert(cloud.positions.end(), chunk.begin(), chunk.end());
        require_few_points(path, cloud.positions.size());
      });
  return cloud;
}

bool is_text_cloud(const fs::path& path) {
  constexpr std::array<std::string_view, 5> extensions{".xyz", ".txt", ".asc", ".pts", ".csv"};
  return std::ranges::find(extensions, lower_extension(path)) != extensions.end();
}

/// Returns all bytes of a file; 16-bit text is converted to UTF-8.
std::string whole_file(const fs::path& path) {
  std::string bytes = read_file(path, largest_whole_file, largest_unpacked_cloud);
  return is_text_cloud(path) ? as_utf8(std::move(bytes)) : bytes;
}

/// Reader of a format that is parsed in pieces.
struct PiecewiseReader {
  AttributedCloud (*cloud)(const fs::path& path);
  std::size_t (*positions)(const fs::path& path, const PositionsCallback& callback);
};

std::optional<PiecewiseReader> piecewise_reader(std::string_view extension) {
  if (extension == ".las" || extension == ".laz") return {{read_las_cloud, read_las_positions}};
  if (extension == ".e57") return {{read_e57_cloud, read_e57_positions}};
  return std::nullopt;
}

}  // namespace

void fail_cloud(const fs::path& path, const std::string& what) {
  throw Error(ErrorKind::bad_file, path.string() + ": " + what);
}

Eigen::Vector3f cloud_position(const fs::path& path, std::size_t point, double x, double y,
                               double z) {
  const Eigen::Vector3d position(x, y, z);
  if (position.cwiseAbs().maxCoeff() > farthest_single_coordinate) {
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
  if (points <= max_whole_points) return;
  fail_cloud(path, "contains more than " + std::to_string(max_whole_points) +
                       " points; downsample it, or use LAS or E57, which are read in parts");
}

void fail_without_points(const fs::path& path, std::size_t skipped) {
  fail_cloud(path, skipped == 0 ? std::string("contains no points")
                                : "contains no valid points; " + std::to_string(skipped) +
                                      " points are NaN or infinite");
}

void require_cloud_name(const fs::path& path) {
  const std::string extension = lower_extension(path);
  if (extension == ".ply" || extension == ".pcd" || piecewise_reader(extension) ||
      is_text_cloud(path)) {
    return;
  }
  fail_cloud(path,
             "the name of a cloud file must end in .ply, .pcd, .las, .laz, .e57, .xyz, .txt, "
             ".asc, .pts or .csv, optionally followed by .gz");
}

std::string whole_cloud_file(const fs::path& path) { return whole_file(path); }

AttributedCloud read_cloud(const fs::path& path) {
  const std::string extension = lower_extension(path);
  const auto piecewise = piecewise_reader(extension);
  const auto parser = extension == ".ply"   ? parse_ply_cloud
                      : extension == ".pcd" ? parse_pcd_cloud
                      : is_text_cloud(path) ? parse_text_cloud
                                            : nullptr;
  if (parser == nullptr && !piecewise) require_cloud_name(path);
  AttributedCloud cloud = piecewise ? piecewise->cloud(path) : parser(path, whole_file(path));
  if (cloud.positions.empty()) fail_without_points(path, cloud.skipped);
  return cloud;
}

namespace {

/// Reads files that are loaded whole, but whose points are parsed in pieces.
std::size_t read_file_positions(const fs::path& path, const PositionsCallback& callback) {
  const std::string bytes = whole_file(path);
  bool has_points = false;
  std::size_t skipped = 0;
  const auto hand_on = [&](std::span<const Eigen::Vector3f> chunk, double read, double all) {
    if (chunk.empty()) return;
    has_points = true;
    callback(chunk, read / all);
  };
  if (is_text_cloud(path)) {
    const auto all = static_cast<double>(bytes.size());
    skipped =
        read_text_cloud(path, bytes, [&](std::span<const Eigen::Vector3f> chunk, std::size_t read) {
          hand_on(chunk, static_cast<double>(read), all);
        });
  } else {
    read_ply_chunks(path, bytes,
                    [&](const AttributedCloud& chunk, std::size_t read, std::size_t all) {
                      skipped += chunk.skipped;
                      hand_on(chunk.positions, static_cast<double>(read), static_cast<double>(all));
                    });
  }
  if (!has_points) fail_without_points(path, skipped);
  return skipped;
}

}  // namespace

std::size_t read_positions(const fs::path& path, const PositionsCallback& callback) {
  if (const auto piecewise = piecewise_reader(lower_extension(path))) {
    return piecewise->positions(path, callback);
  }
  if (is_text_cloud(path) || lower_extension(path) == ".ply")
    return read_file_positions(path, callback);
  const AttributedCloud cloud = read_cloud(path);
  const std::vector<Eigen::Vector3f>& positions = cloud.positions;
  for (std::size_t begin = 0; begin < positions.size(); begin += points_per_chunk) {
    const std::size_t count = std::min(points_per_chunk, positions.size() - begin);
    callback(std::span(positions).subspan(begin, count),
             static_cast<double>(begin + count) / static_cast<double>(positions.size()));
  }
  return cloud.skipped;
}

void write_cloud(const fs::path& path, const CloudColumns& cloud) {
  const std::size_t count = cloud.positions.size();
  assert(cloud.normals.empty() || cloud.normals.size() == count);
  assert(cloud.views.empty() || cloud.views.size() == count);
  assert(cloud.colours.empty() || cloud.colours.size() == count);
  if (path.extension() == ".e57") return write_file(path, e57_bytes(cloud));
  PlyElement vertex{"vertex", count, {}};
  vertex.add(PlyType::float32, {"x", "y", "z"});
  if (!cloud.normals.empty()) vertex.add(PlyType::float32, {"nx", "ny", "nz"});
  if (!cloud.views.empty()) vertex.add(PlyType::uint32, {"view"});
  if (!cloud.colours.empty()) vertex.add(PlyType::uint8, {"red", "green", "blue"});
  for (const NamedMarks& marks : cloud.marks) {
    assert(marks.values.empty() || marks.values.size() == count);
    if (!marks.values.empty()) vertex.add(PlyType::uint8, {marks.name});
  }
  std::string bytes = ply_header({&vertex, 1});
  constexpr std::size_t largest_point = 31;  // [bytes]
  bytes.reserve(bytes.size() + count * (largest_point + cloud.marks.size()));
  for (std::size_t i = 0; i < count; ++i) {
    append_value(bytes, cloud.positions[i]);
    if (!cloud.normals.empty()) append_value(bytes, cloud.normals[i]);
    if (!cloud.views.empty()) append_value(bytes, cloud.views[i]);
    if (!cloud.colours.empty()) append_value(bytes, cloud.colours[i]);
    for (const NamedMarks& marks : cloud.marks) {
      if (!marks.values.empty()) append_value(bytes, marks.values[i]);
    }
  }
  write_file(path, bytes);
}

}  // namespace skycap::geometry
