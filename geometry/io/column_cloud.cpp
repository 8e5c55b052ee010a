#include "geometry/io/column_cloud.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "geometry/io/cloud_parsers.h"
#include "geometry/io/column_formats.h"
#include "geometry/io/e57_reader.h"
#include "geometry/io/file.h"
#include "geometry/io/text/plain_text.h"
#include "geometry/io/text/ply.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;

constexpr double max_word = 65535.0;

/// Collects points whose attributes are listed as column::x etc.
class ColumnCollector {
 public:
  ColumnCollector(const fs::path& path, std::span<const std::size_t> names, ColumnCloud& cloud)
      : path_(path), names_(names.begin(), names.end()), cloud_(cloud) {
    for (const std::size_t axis : {column::x, column::y, column::z}) {
      if (std::ranges::find(names_, axis) == names_.end()) {
        fail_cloud(path, "does not have the coordinates x, y and z");
      }
    }
  }

  /// `values` are in the order of the names.
  void add(std::span<const double> values) {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i] <= column::z) position[static_cast<Eigen::Index>(names_[i])] = values[i];
    }
    if (!position.allFinite()) {
      ++cloud_.skipped;
      return;
    }
    cloud_.positions.push_back(position);
    require_few_points(path_, cloud_.positions.size());
    for (std::size_t i = 0; i < names_.size(); ++i) {
      if (names_[i] == column::time) cloud_.times.push_back(values[i]);
      if (names_[i] == column::packed_colour) add_packed(values[i]);
      if (names_[i] < column::first) continue;
      cloud_.columns[names_[i] - column::first].push_back(static_cast<float>(values[i]));
    }
  }

 private:
  /// Signed and unsigned integers of 32 bits are colours, other numbers are black.
  void add_packed(double value) {
    constexpr double min = -2147483648.0, end = 4294967296.0;
    const auto packed = static_cast<std::uint32_t>(
        value >= min && value < end ? static_cast<std::int64_t>(value) : 0);
    for (const auto& [name, shift] :
         {std::pair(CloudColumn::red, 16), {CloudColumn::green, 8}, {CloudColumn::blue, 0}}) {
      cloud_.column(name).push_back(static_cast<float>(packed >> shift & 0xFF));
    }
  }

  const fs::path& path_;
  std::vector<std::size_t> names_;
  ColumnCloud& cloud_;
};

/// Removes colours and normals of which a component is missing, and converts colours to 16 bits. A
/// file may contain bytes, words or fractions.
void complete_columns(ColumnCloud& cloud) {
  const auto require_three = [&](CloudColumn first) {
    const std::size_t begin = index_of(first);
    const bool has_all =
        std::all_of(cloud.columns.begin() + static_cast<std::ptrdiff_t>(begin),
                    cloud.columns.begin() + static_cast<std::ptrdiff_t>(begin + 3),
                    [&](const auto& values) { return values.size() == cloud.positions.size(); });
    if (has_all) return;
    for (std::size_t i = begin; i < begin + 3; ++i) cloud.columns[i].clear();
  };
  require_three(CloudColumn::normal_x);
  require_three(CloudColumn::red);
  if (!cloud.has_colours()) return;
  double max = 0.0;
  bool is_whole = true;
  const std::span<std::vector<float>, 3> colours(&cloud.column(CloudColumn::red), 3);
  for (const auto& values : colours) {
    for (const float value : values) {
      if (!(value >= 0.0F && value <= 65535.0F)) {
        for (auto& cleared : colours) cleared.clear();
        cloud.lost.emplace_back("colours outside 0 to 65535 are not read");
        return;
      }
      max = std::max(max, double{value});
      is_whole = is_whole && value == std::floor(value);
    }
  }
  const double factor = max <= 1.0 && !is_whole ? max_word : max <= 255.0 ? 257.0 : 1.0;
  for (auto& values : colours) {
    for (float& value : values) value = static_cast<float>(std::round(factor * double{value}));
  }
}

void add_unread(const std::vector<std::string>& names, ColumnCloud& cloud) {
  if (names.empty()) return;
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  cloud.lost.push_back("not read: " + list);
}

/// Returns the attributes with known names, and their indices in `names`. States the other names in
/// `cloud`, except those of padding and of coordinates with other names than x, y and z.
std::vector<std::size_t> find_columns(std::span<const std::string> names,
                                      std::vector<std::size_t>& indices, ColumnCloud& cloud) {
  constexpr std::array<std::string_view, 8> silent = {"_",        "east",   "easting",   "north",
                                                      "northing", "height", "elevation", ""};
  std::vector<std::size_t> found;
  std::vector<std::string> unread;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const std::string lower = lower_case(names[i]);
    const auto name = find_column(lower);
    if (name && std::ranges::find(found, *name) == found.end()) {
      found.push_back(*name);
      indices.push_back(i);
    } else if (std::ranges::find(silent, lower) == silent.end()) {
      unread.push_back(names[i]);
    }
  }
  add_unread(unread, cloud);
  return found;
}

void read_ply_columns(const fs::path& path, std::string_view bytes, ColumnCloud& cloud) {
  const std::string name = path.string();
  PlyReader reader(name, bytes);
  for (const PlyElement& element : reader.elements()) {
    if (element.name != "vertex") {
      reader.read_element({});
      continue;
    }
    std::vector<std::string> names;
    for (const PlyProperty& property : element.properties) {
      if (!property.count_type) names.push_back(property.name);
    }
    std::vector<std::size_t> indices;
    ColumnCollector collector(path, find_columns(names, indices, cloud), cloud);
    std::vector<std::string_view> wanted;
    for (const std::size_t i : indices) wanted.push_back(names[i]);
    std::vector<double> values(wanted.size());
    for (std::uint64_t first = 0; first < element.count; first += points_per_chunk) {
      const PlyTable table = reader.read_rows(wanted, {}, points_per_chunk);
      for (std::uint64_t row = 0; row < table.rows; ++row) {
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = table.columns[i][row];
        collector.add(values);
      }
    }
    return;
  }
  fail_cloud(path, "missing element 'vertex'");
}

void read_pcd_columns(const fs::path& path, std::string_view bytes, ColumnCloud& cloud) {
  std::optional<ColumnCollector> collector;
  read_pcd_fields(
      path, bytes,
      [&](std::span<const std::string> names) {
        std::vector<std::size_t> indices;
        collector.emplace(path, find_columns(names, indices, cloud), cloud);
        return indices;
      },
      [&](std::span<const double> values) { collector->add(values); });
}

void read_text_columns(const fs::path& path, std::string_view bytes, ColumnCloud& cloud) {
  std::optional<ColumnCollector> collector;
  const TextColumns columns = read_text_fields(
      path, bytes,
      [&](std::span<const std::string> names) {
        std::vector<std::size_t> indices, found = find_columns(names, indices, cloud);
        // Coordinates may have other names; the reader adds them in front.
        std::vector<std::size_t> kept, kept_names = {column::x, column::y, column::z};
        for (std::size_t i = 0; i < found.size(); ++i) {
          if (found[i] <= column::z) continue;
          kept.push_back(indices[i]);
          kept_names.push_back(found[i]);
        }
        collector.emplace(path, kept_names, cloud);
        return kept;
      },
      [&](std::span<const double> values) { collector->add(values); });
  if (columns.unnamed > 0) {
    cloud.lost.push_back(std::to_string(columns.unnamed) +
                         " columns without names are not read; add a first line with names");
  }
}

void read_e57_columns(const fs::path& path, ColumnCloud& cloud) {
  E57Reader reader(path);
  E57Points points;
  while (reader.next(points)) {
    require_few_points(path, cloud.positions.size() + points.positions.size());
    const auto append = [](auto& all, const auto& more) {
      all.insert(all.end(), more.begin(), more.end());
    };
    append(cloud.positions, points.positions);
    append(cloud.times, points.times);
    append(cloud.column(CloudColumn::intensity), points.intensities);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      auto& normals = cloud.columns[index_of(CloudColumn::normal_x) + axis];
      for (const auto& normal : points.normals) {
        normals.push_back(normal[static_cast<Eigen::Index>(axis)]);
      }
      auto& colours = cloud.columns[index_of(CloudColumn::red) + axis];
      for (const auto& colour : points.colours) {
        colours.push_back(257.0F * static_cast<float>(colour[axis]));
      }
    }
    for (const auto& returns : points.returns) {
      cloud.column(CloudColumn::return_number).push_back(static_cast<float>(returns[0]));
      cloud.column(CloudColumn::returns).push_back(static_cast<float>(returns[1]));
    }
  }
  cloud.crs_wkt = reader.reference_system();
  cloud.skipped = reader.skipped();
  add_unread(reader.unread_fields(), cloud);
  if (reader.scans() > 1) cloud.lost.emplace_back("scans are joined; their poses are not kept");
}

}  // namespace

std::optional<std::size_t> find_column(std::string_view name) {
  constexpr std::string_view scalar = "scalar_";
  if (name.starts_with(scalar)) name.remove_prefix(scalar.size());
  struct Alias {
    std::string_view name;
    std::size_t column;
  };
  const auto of = [](CloudColumn column) { return column::first + index_of(column); };
  static const std::vector<Alias> aliases = {{"x", column::x},
                                             {"y", column::y},
                                             {"z", column::z},
                                             {"time", column::time},
                                             {"gps_time", column::time},
                                             {"gpstime", column::time},
                                             {"timestamp", column::time},
                                             {"rgb", column::packed_colour},
                                             {"rgba", column::packed_colour},
                                             {"nx", of(CloudColumn::normal_x)},
                                             {"ny", of(CloudColumn::normal_y)},
                                             {"nz", of(CloudColumn::normal_z)},
                                             {"normal_x", of(CloudColumn::normal_x)},
                                             {"normal_y", of(CloudColumn::normal_y)},
                                             {"normal_z", of(CloudColumn::normal_z)},
                                             {"normalx", of(CloudColumn::normal_x)},
                                             {"normaly", of(CloudColumn::normal_y)},
                                             {"normalz", of(CloudColumn::normal_z)},
                                             {"red", of(CloudColumn::red)},
                                             {"green", of(CloudColumn::green)},
                                             {"blue", of(CloudColumn::blue)},
                                             {"r", of(CloudColumn::red)},
                                             {"g", of(CloudColumn::green)},
                                             {"b", of(CloudColumn::blue)},
                                             {"intensity", of(CloudColumn::intensity)},
                                             {"classification", of(CloudColumn::classification)},
                                             {"class", of(CloudColumn::classification)},
                                             {"return_number", of(CloudColumn::return_number)},
                                             {"returnnumber", of(CloudColumn::return_number)},
                                             {"returns", of(CloudColumn::returns)},
                                             {"number_of_returns", of(CloudColumn::returns)},
                                             {"numberofreturns", of(CloudColumn::returns)}};
  const auto found = std::ranges::find(aliases, name, &Alias::name);
  if (found == aliases.end()) return std::nullopt;
  return found->column;
}

ColumnCloud read_column_cloud(const fs::path& path) {
  const std::string extension = lower_extension(path);
  ColumnCloud cloud;
  if (extension == ".las" || extension == ".laz") {
    read_las_columns(path, cloud);
  } else if (extension == ".e57") {
    read_e57_columns(path, cloud);
  } else {
    const auto read = extension == ".ply"   ? read_ply_columns
                      : extension == ".pcd" ? read_pcd_columns
                                            : read_text_columns;
    require_cloud_name(path);
    read(path, whole_cloud_file(path), cloud);
  }
  const bool is_las = extension == ".las" || extension == ".laz";
  if (extension != ".e57" && !(is_las && !cloud.has_colours())) complete_columns(cloud);
  return cloud;
}

}  // namespace skycap::geometry
