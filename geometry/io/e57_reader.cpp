#include "geometry/io/e57_reader.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "geometry/io/e57/layout.h"

namespace skycap::geometry {
namespace {

using Names = std::array<const char*, 3>;

constexpr Names cartesian{"cartesianX", "cartesianY", "cartesianZ"};
constexpr Names spherical{"sphericalRange", "sphericalAzimuth", "sphericalElevation"};
constexpr Names colours{"colorRed", "colorGreen", "colorBlue"};
constexpr std::array<const char*, 1> intensity{"intensity"}, time_stamp{"timeStamp"};
constexpr std::array<const char*, 2> returns{"returnIndex", "returnCount"};
constexpr Names normals{"nor:normalX", "nor:normalY", "nor:normalZ"};  // extension E57_NOR

bool has(const e57::ScanDescription& scan, std::span<const char* const> names) {
  return std::ranges::all_of(names, [&](const char* name) {
    const auto field = scan.field(name);
    return field && scan.fields[*field].coding != e57::Coding::text;
  });
}

bool all_have(const std::vector<e57::ScanDescription>& scans, std::span<const char* const> names) {
  return std::ranges::all_of(scans, [&](const auto& scan) { return has(scan, names); });
}

Eigen::Vector3d spherical_to_cartesian(const Eigen::Vector3d& range_azimuth_elevation) {
  const double range = range_azimuth_elevation[0], azimuth = range_azimuth_elevation[1],
               elevation = range_azimuth_elevation[2];
  const double level = range * std::cos(elevation);
  return {level * std::cos(azimuth), level * std::sin(azimuth), range * std::sin(elevation)};
}

/// Returns the values of black and white of a channel.
e57::Interval make_limits(const e57::ScanDescription& scan, std::size_t channel,
                          const e57::Field& field) {
  if (scan.colour_limits[channel]) return *scan.colour_limits[channel];
  const bool is_whole = field.coding == e57::Coding::integer;
  if (!is_whole) return {0.0, 1.0};
  return {static_cast<double>(field.minimum), static_cast<double>(field.maximum)};
}

std::uint8_t to_byte(double value, const e57::Interval& limits) {
  const double share = (value - limits.low) / (limits.high - limits.low);
  if (!(share > 0.0)) return 0;
  return static_cast<std::uint8_t>(std::lround(255.0 * std::min(share, 1.0)));
}

e57::Description read_description(e57::Pages& pages, const e57::FileHeader& header) {
  pages.bytes(0, e57::header::size);  // verifies the checksum of the header page
  const std::uint64_t offset = pages.logical(header.description, "its XML");
  if (header.description_size > e57::longest_description ||
      header.description_size > pages.size() - offset) {
    e57::throw_bad_file("has XML of " + std::to_string(header.description_size) +
                        " bytes; it must end inside the file, and its maximum size is " +
                        std::to_string(e57::longest_description));
  }
  return e57::parse_description(pages.bytes(offset, header.description_size));
}

}  // namespace

E57Reader::E57Reader(std::filesystem::path path)
    : file_(std::make_unique<SeekableFile>(std::move(path))) {
  file_->with_name([&] {
    const auto read = [file = file_.get()](std::uint64_t offset, std::uint64_t count) {
      return file->bytes(offset, count);
    };
    const e57::FileHeader header =
        e57::parse_file_header(read(0, e57::header::size), file_->size());
    pages_ = std::make_unique<e57::Pages>(read, header);
    description_ = read_description(*pages_, header);
    has_colours_ = all_have(description_.scans, colours);
    has_normals_ = all_have(description_.scans, normals);
    has_intensities_ = all_have(description_.scans, intensity);
    has_times_ = all_have(description_.scans, time_stamp);
    has_returns_ = all_have(description_.scans, returns);
    for (const e57::ScanDescription& scan : description_.scans) find_field_indices(scan);
  });
}

std::uint64_t E57Reader::points() const {
  std::uint64_t sum = 0;
  for (const e57::ScanDescription& scan : description_.scans) sum += scan.records;
  return sum;
}

E57Reader::FieldIndices E57Reader::find_field_indices(const e57::ScanDescription& scan) const {
  FieldIndices field_indices;
  field_indices.is_spherical = !has(scan, cartesian);
  if (field_indices.is_spherical && !has(scan, spherical)) {
    e57::throw_bad_file(
        "has a scan whose points have neither cartesianX, Y and Z nor sphericalRange, Azimuth and "
        "Elevation");
  }
  const auto add = [&](std::span<const char* const> names) {
    for (const char* name : names) field_indices.fields.push_back(*scan.field(name));
    return field_indices.fields.size() - names.size();
  };
  add(field_indices.is_spherical ? spherical : cartesian);
  if (has_colours_) field_indices.colours = add(colours);
  if (has_normals_) field_indices.normals = add(normals);
  if (has_intensities_) field_indices.intensity = add(intensity);
  if (has_times_) field_indices.time = add(time_stamp);
  if (has_returns_) field_indices.returns = add(returns);
  const auto state =
      scan.field(field_indices.is_spherical ? "sphericalInvalidState" : "cartesianInvalidState");
  if (state) {
    field_indices.state = field_indices.fields.size();
    field_indices.fields.push_back(*state);
  }
  return field_indices;
}

std::vector<std::string> E57Reader::unread_fields() const {
  std::vector<std::string> names;
  for (const e57::ScanDescription& scan : description_.scans) {
    const std::vector<std::size_t> read = find_field_indices(scan).fields;
    for (std::size_t i = 0; i < scan.fields.size(); ++i) {
      const std::string& name = scan.fields[i].name;
      const bool is_new = std::ranges::find(names, name) == names.end();
      if (is_new && std::ranges::find(read, i) == read.end()) names.push_back(name);
    }
  }
  return names;
}

bool E57Reader::next(E57Points& points, std::size_t max) {
  points.positions.clear();
  points.normals.clear();
  points.colours.clear();
  points.intensities.clear();
  points.times.clear();
  points.returns.clear();
  return file_->with_name([&] {
    while (true) {
      const std::size_t count = records_ ? records_->next(max) : 0;
      if (count > 0) {
        points.records = count;
        points.scan = static_cast<std::uint32_t>(next_scan_ - 1);
        add_points(count, points);
        return true;
      }
      if (next_scan_ == description_.scans.size()) return false;
      const e57::ScanDescription& scan = description_.scans[next_scan_++];
      field_indices_ = find_field_indices(scan);
      records_.emplace(*pages_, scan, field_indices_.fields);
    }
  });
}

void E57Reader::add_points(std::size_t count, E57Points& points) {
  const e57::ScanDescription& scan = description_.scans[points.scan];
  const auto values = records_->values();
  const auto three = [&](std::size_t first, std::size_t i) {
    return Eigen::Vector3d(values[first][i], values[first + 1][i], values[first + 2][i]);
  };
  std::array<e57::Interval, 3> limits;
  for (std::size_t channel = 0; has_colours_ && channel < 3; ++channel) {
    limits[channel] = make_limits(
        scan, channel, scan.fields[field_indices_.fields[field_indices_.colours + channel]]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (field_indices_.state != 0 && values[field_indices_.state][i] != 0.0) continue;
    const Eigen::Vector3d stored = three(0, i);
    if (!stored.allFinite()) {
      ++skipped_;
      continue;
    }
    const Eigen::Vector3d position =
        scan.file_from_scan *
        (field_indices_.is_spherical ? spherical_to_cartesian(stored) : stored);
    if (!position.allFinite()) e57::throw_bad_file("has a point with non-finite coordinates");
    points.positions.push_back(position);
    if (has_normals_) {
      points.normals.push_back(
          (scan.file_from_scan.linear() * three(field_indices_.normals, i)).cast<float>());
    }
    if (has_intensities_) {
      points.intensities.push_back(static_cast<float>(values[field_indices_.intensity][i]));
    }
    if (has_times_) points.times.push_back(values[field_indices_.time][i]);
    if (has_returns_) {
      const auto byte = [&](std::size_t field, double shift) {
        const double value = values[field][i] + shift;  // may be NaN in invalid files
        return value > 0.0 ? static_cast<std::uint8_t>(std::min(value, 255.0)) : std::uint8_t{0};
      };
      points.returns.push_back(
          {byte(field_indices_.returns, 1.0), byte(field_indices_.returns + 1, 0.0)});
    }
    if (!has_colours_) continue;
    auto& colour = points.colours.emplace_back();
    for (std::size_t channel = 0; channel < 3; ++channel) {
      colour[channel] = to_byte(values[field_indices_.colours + channel][i], limits[channel]);
    }
  }
}

}  // namespace skycap::geometry
