#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/byte_values.h"
#include "geometry/io/cloud_parsers.h"
#include "geometry/io/column_formats.h"
#include "geometry/io/file.h"
#include "geometry/io/las/las_conversion.h"
#include "geometry/io/las/las_file_writer.h"
#include "geometry/io/las/layout.h"

namespace skycap::geometry {
namespace {

namespace fs = std::filesystem;

/// Linear conversion of intensities to 16 bits.
struct IntensityScale {
  double low = 0.0, factor = 1.0;

  std::uint16_t word(float value) const {
    const double word = (double{value} - low) * factor;
    return word > 0.0 ? static_cast<std::uint16_t>(std::lround(std::min(word, 65535.0))) : 0;
  }
};

IntensityScale intensity_scale(const std::vector<float>& values, std::vector<std::string>& lost) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  bool is_whole = true;
  for (const float value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, double{value});
    high = std::max(high, double{value});
    is_whole = is_whole && value == std::floor(value);
  }
  if (!(low <= high) || (is_whole && low >= 0.0 && high <= 65535.0)) return {};
  if (low >= 0.0 && high <= 1.0) return {0.0, 65535.0};
  lost.push_back("intensities from " + std::to_string(low) + " to " + std::to_string(high) +
                 " are scaled to 0 to 65535");
  return {low, high > low ? 65535.0 / (high - low) : 0.0};
}

/// Returns an offset in whole kilometres and the finest scale that represents all coordinates.
void choose_grid(const fs::path& path, const ColumnCloud& cloud, las::WrittenFile& file) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& position : cloud.positions) box.extend(position);
  const bool is_geographic = cloud.crs_wkt.starts_with("GEOG");
  file.scale = Eigen::Vector3d::Constant(1e-4);
  if (is_geographic) file.scale.head<2>().setConstant(1e-9);
  if (cloud.positions.empty()) return;
  file.offset = is_geographic ? Eigen::Vector3d(box.center().array().round())
                              : Eigen::Vector3d(1000.0 * (box.center() / 1000.0).array().round());
  for (int axis = 0; axis < 3; ++axis) {
    const double reach = std::max(std::abs(box.max()[axis] - file.offset[axis]),
                                  std::abs(box.min()[axis] - file.offset[axis]));
    constexpr double max_steps = 2147483647.0, coarsest = 1.0;
    while (reach / file.scale[axis] > max_steps && file.scale[axis] < coarsest) {
      file.scale[axis] *= 10.0;
    }
    if (reach / file.scale[axis] <= max_steps) continue;
    std::array<char, 32> text{};
    const auto end = std::to_chars(text.data(), text.data() + text.size(), 2.0 * reach,
                                   std::chars_format::general, 4)
                         .ptr;
    fail_cloud(path, "coordinates extend over " + std::string(text.data(), end) +
                         " m, which LAS files cannot represent; remove outliers");
  }
}

}  // namespace

void read_las_columns(const fs::path& path, ColumnCloud& cloud) {
  LasReader reader(path, LasFields::all);
  const LasHeader& header = reader.header();
  const las::PointUpgrade upgrade(header);
  const bool has_time = header.format == 1 || header.format >= 3;
  const std::size_t size = las::point_size(upgrade.format()) + std::size_t{upgrade.extra_bytes()};
  std::string records, points;
  std::size_t withheld = 0;
  while (reader.next_records(records)) {
    upgrade.convert(records, points);
    require_few_points(path, cloud.positions.size() + points.size() / size);
    for (std::size_t begin = 0; begin < points.size(); begin += size) {
      const char* const point = points.data() + begin;
      const auto byte = [&](std::size_t offset) { return value_at<std::uint8_t>(point, offset); };
      if ((byte(las::point::flags) & las::point::withheld) != 0) {
        ++withheld;
        continue;
      }
      Eigen::Vector3d& position = cloud.positions.emplace_back();
      for (int axis = 0; axis < 3; ++axis) {
        position[axis] =
            value_at<std::int32_t>(point, 4UL * axis) * header.scale[axis] + header.offset[axis];
      }
      if (!position.allFinite()) fail_cloud(path, "has a point with non-finite coordinates");
      const auto add = [&](CloudColumn name, unsigned value) {
        cloud.column(name).push_back(static_cast<float>(value));
      };
      add(CloudColumn::intensity, value_at<std::uint16_t>(point, las::point::intensity));
      add(CloudColumn::classification, byte(las::point::classification));
      add(CloudColumn::return_number, byte(las::point::returns) & 15U);
      add(CloudColumn::returns, byte(las::point::returns) >> 4U);
      if (has_time) cloud.times.push_back(value_at<double>(point, las::point::time));
      if (!header.has_colours()) continue;
      for (std::size_t i = 0; i < 3; ++i) {
        cloud.columns[index_of(CloudColumn::red) + i].push_back(
            value_at<std::uint16_t>(point, las::point::colour + 2 * i));
      }
    }
  }
  const LasReferenceSystem system = reader.reference_system();
  cloud.crs_wkt = system.wkt;
  if (system.wkt.empty() && (system.projected != 0 || system.geographic != 0)) {
    cloud.lost.push_back(
        "the reference system EPSG:" +
        std::to_string(system.projected != 0 ? system.projected : system.geographic) +
        " is not kept, because it is not WKT; use --crs");
  }
  if (withheld > 0)
    cloud.lost.push_back(std::to_string(withheld) + " withheld points are not kept");
  if (upgrade.extra_bytes() > 0) cloud.lost.emplace_back("additional bytes are not kept");
  if (header.format == 8 || header.format == 10) cloud.lost.emplace_back("infrared is not kept");
  cloud.lost.emplace_back("scan angle, user data, source and flags are not kept");
}

void write_las_columns(const fs::path& path, const ColumnCloud& cloud,
                       std::vector<std::string>& lost) {
  las::WrittenFile file;
  file.point_format = cloud.has_colours() ? 7 : 6;
  file.is_compressed = lower_extension(path) == ".laz";
  file.system = "conversion";
  constexpr std::size_t longest_wkt = 65534;
  if (cloud.crs_wkt.size() > longest_wkt) {
    lost.emplace_back("the reference system is too long for LAS and not kept");
  } else if (!cloud.crs_wkt.empty()) {
    file.records.push_back(las::wkt_record(cloud.crs_wkt));
  }
  choose_grid(path, cloud, file);
  const IntensityScale intensity = intensity_scale(cloud.column(CloudColumn::intensity), lost);
  const std::size_t size = las::point_size(file.point_format);
  const auto column = [&](CloudColumn name, std::size_t i, float missing) {
    const std::vector<float>& values = cloud.column(name);
    return values.empty() ? missing : values[i];
  };
  const Eigen::Vector3d offset = file.offset, scale = file.scale;
  double rounding = 0.0;
  las::LasFileWriter writer(path, std::move(file));
  std::string record(size, '\0');
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const auto put = [&](std::size_t at, auto value) { put_value(record.data(), at, value); };
    for (int axis = 0; axis < 3; ++axis) {
      const double exact = (cloud.positions[i][axis] - offset[axis]) / scale[axis];
      const double whole = std::nearbyint(exact);
      rounding = std::max(rounding, std::abs(exact - whole) * scale[axis]);
      put(4UL * axis, static_cast<std::int32_t>(whole));
    }
    put(las::point::intensity, intensity.word(column(CloudColumn::intensity, i, 0.0F)));
    const std::uint8_t number = rounded_byte(column(CloudColumn::return_number, i, 1.0F), 15.0F),
                       returns = rounded_byte(column(CloudColumn::returns, i, 1.0F), 15.0F);
    put(las::point::returns, static_cast<std::uint8_t>(number | returns << 4));
    put(las::point::classification,
        rounded_byte(column(CloudColumn::classification, i, 0.0F), 255.0F));
    put(las::point::time, cloud.times.empty() ? 0.0 : cloud.times[i]);
    for (std::size_t channel = 0; cloud.has_colours() && channel < 3; ++channel) {
      const float word = cloud.columns[static_cast<std::size_t>(CloudColumn::red) + channel][i];
      put(las::point::colour + 2 * channel, static_cast<std::uint16_t>(word));
    }
    writer.add(record);
  }
  writer.finish();
  constexpr double negligible = 1e-6;
  if (rounding > negligible) {
    std::array<char, 32> text{};
    const auto end =
        std::to_chars(text.data(), text.data() + text.size(), scale.x(), std::chars_format::fixed)
            .ptr;
    lost.push_back("coordinates are rounded to " + std::string(text.data(), end));
  }
  if (cloud.has_normals()) lost.emplace_back("normals are not kept");
}

}  // namespace skycap::geometry
