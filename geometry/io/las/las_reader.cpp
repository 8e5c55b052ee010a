#include "geometry/io/las/las_reader.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/byte_values.h"
#include "geometry/io/cloud_parsers.h"
#include "geometry/io/las/layout.h"

namespace skycap::geometry {
namespace {

/// Throws Error{bad_file} unless the file is a supported LAS file with the header size of its
/// version.
void require_readable(const std::filesystem::path& path, std::string_view beginning) {
  if (beginning.size() <= las::header::point_format || !beginning.starts_with("LASF")) {
    fail_cloud(path, "is not a LAS file: it does not begin with a LAS header");
  }
  const int major = value_at<std::uint8_t>(beginning.data(), las::header::major),
            minor = value_at<std::uint8_t>(beginning.data(), las::header::minor);
  const int kind = value_at<std::uint8_t>(beginning.data(), las::header::point_format);
  const bool is_compressed = (kind & las::compressed_bit) != 0;
  const int format = is_compressed ? kind - las::compressed_bit : kind;
  const bool has_waveforms = format == 4 || format == 5 || format == 9 || format == 10;
  if (major != 1 || minor > 4 || format > 10 || (is_compressed && has_waveforms)) {
    fail_cloud(path,
               "is LAS " + std::to_string(major) + "." + std::to_string(minor) +
                   " with points of format " + std::to_string(format) +
                   (is_compressed ? ", compressed (LAZ)" : "") +
                   "; supported: LAS 1.0 to 1.4 with point formats 0 to 10, or 0 to 3 and 6 to 8 "
                   "if compressed. Convert the file, for example with `pdal translate` or laszip");
  }
  const std::size_t size = minor == 4 ? las::header::end : las::header::old_end;
  if (beginning.size() < size) fail_cloud(path, "ends within the header");
}

LasHeader parse_header_fields(std::string_view beginning) {
  const char* const bytes = beginning.data();
  LasHeader header;
  header.minor = value_at<std::uint8_t>(bytes, las::header::minor);
  const int kind = value_at<std::uint8_t>(bytes, las::header::point_format);
  header.is_compressed = (kind & las::compressed_bit) != 0;
  header.format = header.is_compressed ? kind - las::compressed_bit : kind;
  header.has_adjusted_time = (value_at<std::uint16_t>(bytes, las::header::encoding) & 1) != 0;
  header.header_size = value_at<std::uint16_t>(bytes, las::header::size);
  header.first_point = value_at<std::uint32_t>(bytes, las::header::first_point);
  header.records = value_at<std::uint32_t>(bytes, las::header::records);
  header.point_size = value_at<std::uint16_t>(bytes, las::header::point_size);
  header.points = value_at<std::uint32_t>(bytes, las::header::old_points);
  if (header.minor == 4) {
    // Some writers of version 1.4 set only the legacy point count.
    const auto points = value_at<std::uint64_t>(bytes, las::header::points);
    if (points != 0) header.points = points;
    header.first_extended_record =
        value_at<std::uint64_t>(bytes, las::header::first_extended_record);
    header.extended_records = value_at<std::uint32_t>(bytes, las::header::extended_records);
  }
  for (int axis = 0; axis < 3; ++axis) {
    header.scale[axis] = value_at<double>(bytes, las::header::scale + 8UL * axis);
    header.offset[axis] = value_at<double>(bytes, las::header::offset + 8UL * axis);
  }
  return header;
}

/// `beginning` contains the first 375 bytes of the file, or all of a shorter file.
LasHeader parse_header(const std::filesystem::path& path, std::string_view beginning,
                       std::uint64_t file_size) {
  require_readable(path, beginning);
  const LasHeader header = parse_header_fields(beginning);
  const std::uint16_t min_size = las::point_size(header.format);
  if (header.point_size < min_size) {
    fail_cloud(path, "has points of " + std::to_string(header.point_size) +
                         " bytes; those of format " + std::to_string(header.format) + " have " +
                         std::to_string(min_size) + " or more");
  }
  if (!header.scale.allFinite() || !(header.scale.array() > 0.0).all() ||
      !header.offset.allFinite()) {
    fail_cloud(path, "has a coordinate scale or offset that is not a valid number");
  }
  const std::size_t header_end = header.minor == 4 ? las::header::end : las::header::old_end;
  if (header.first_point < header_end) {
    fail_cloud(path, "has a point offset inside its header");
  }
  const std::uint64_t available_bytes =
      file_size < header.first_point ? 0 : file_size - header.first_point;
  if (!header.is_compressed && available_bytes / header.point_size < header.points) {
    fail_cloud(path, "ends after " + std::to_string(available_bytes / header.point_size) +
                         " of its " + std::to_string(header.points) + " points");
  }
  return header;
}

int read_class(const LasHeader& header, const char* point) {
  if (header.format >= 6) return value_at<std::uint8_t>(point, las::point::classification);
  return value_at<std::uint8_t>(point, las::old_point::classification) & las::old_point::classes;
}

bool is_withheld(const LasHeader& header, const char* point) {
  const int flags = value_at<std::uint8_t>(
      point, header.format >= 6 ? las::point::flags : las::old_point::classification);
  return (flags & (header.format >= 6 ? las::point::withheld : las::old_point::withheld)) != 0;
}

std::size_t colour_offset(const LasHeader& header) {
  return las::colour_offsets[static_cast<std::size_t>(header.format)];
}

void add_point(const LasHeader& header, const char* point, LasPoints& points) {
  Eigen::Vector3d& position = points.positions.emplace_back();
  for (int axis = 0; axis < 3; ++axis) {
    position[axis] =
        value_at<std::int32_t>(point, las::point::position + 4UL * axis) * header.scale[axis] +
        header.offset[axis];
  }
  points.classes.push_back(static_cast<std::uint8_t>(read_class(header, point)));
  if (!header.has_colours()) return;
  auto& colour = points.colours.emplace_back();
  for (std::size_t channel = 0; channel < 3; ++channel) {
    colour[channel] = value_at<std::uint16_t>(point, colour_offset(header) + 2 * channel);
  }
}

std::string_view trim_at_null(std::string_view bytes) { return bytes.substr(0, bytes.find('\0')); }

std::string_view read_user_id(std::string_view record) {
  return trim_at_null(record.substr(las::record::user, las::record::user_size));
}

int read_record_id(std::string_view record) {
  return value_at<std::uint16_t>(record.data(), las::record::id);
}

/// Reads the GeoKey directory (GeoTIFF 1.1, OGC 19-008r4): key, value location, count, value.
void read_geo_keys(std::string_view directory, LasReferenceSystem& system) {
  constexpr int geographic = 2048, projected = 3072, vertical = 4096, vertical_unit = 4099;
  constexpr int user_defined = 32767;
  for (std::size_t i = 8; i + 8 <= directory.size(); i += 8) {
    const int key = value_at<std::uint16_t>(directory.data(), i),
              offset = value_at<std::uint16_t>(directory.data(), i + 2),
              value = value_at<std::uint16_t>(directory.data(), i + 6);
    if (offset != 0) continue;
    if (value == user_defined) {
      if (key == projected || key == geographic) system.is_user_defined = true;
      continue;
    }
    if (key == projected) system.projected = value;
    if (key == geographic) system.geographic = value;
    if (key == vertical) system.vertical = value;
    if (key == vertical_unit) system.vertical_unit = value;
  }
}

}  // namespace

bool LasHeader::has_colours() const { return colour_offset(*this) != 0; }

LasReader::LasReader(std::filesystem::path path, LasFields fields)
    : file_(std::make_unique<SeekableFile>(std::move(path))),
      header_(parse_header(file_->path(), bytes(0, las::header::end), file_->size())) {
  if (header_.is_compressed) open_compressed(fields);
}

std::string LasReader::bytes(std::uint64_t offset, std::uint64_t count) {
  return file_->with_name([&] { return file_->bytes(offset, count); });
}

void LasReader::visit_records(const RecordCallback& callback) {
  std::uint64_t offset = header_.header_size;
  for (std::uint32_t i = 0; i < header_.records && offset < header_.first_point; ++i) {
    const std::string head = bytes(offset, las::record::end);
    if (head.size() < las::record::end) return;
    const auto length = value_at<std::uint16_t>(head.data(), las::record::length);
    const std::string content = bytes(offset + las::record::end, length);
    if (!callback(read_user_id(head), read_record_id(head), content)) return;
    offset += las::record::end + length;
  }
}

void LasReader::visit_extended_records(const RecordCallback& callback) {
  constexpr std::uint64_t longest = 1 << 20;  // maximum bytes read per record
  constexpr std::uint32_t max_records = 1000;
  std::uint64_t offset = header_.first_extended_record;
  for (std::uint32_t i = 0; i < std::min(header_.extended_records, max_records); ++i) {
    const std::string head = bytes(offset, las::record::extended_end);
    if (head.size() < las::record::extended_end) return;
    const auto length = value_at<std::uint64_t>(head.data(), las::record::length);
    const std::string content =
        bytes(offset + las::record::extended_end, std::min(length, longest));
    if (!callback(read_user_id(head), read_record_id(head), content) || length > file_->size())
      return;
    offset += las::record::extended_end + length;
  }
}

std::vector<LasRecord> LasReader::kept_records() {
  std::vector<LasRecord> records;
  const auto callback = [&](std::string_view user, int id, std::string_view content) {
    const bool is_projection = user == las::record::projection || user == "liblas";
    const bool is_extra_bytes =
        user == las::record::specification && id == las::record::extra_bytes;
    if (is_projection || is_extra_bytes) {
      records.push_back({is_projection, static_cast<std::uint16_t>(id), std::string(content)});
    }
    return true;
  };
  visit_records(callback);
  visit_extended_records(callback);
  return records;
}

LasReferenceSystem LasReader::reference_system() {
  LasReferenceSystem system;
  for (const LasRecord& record : kept_records()) {
    if (!record.is_projection) continue;
    if (record.id == las::record::wkt && system.wkt.empty()) {
      system.wkt = trim_at_null(record.content);
    }
    if (record.id == las::record::geo_keys) read_geo_keys(record.content, system);
  }
  return system;
}

std::string LasReader::compression_record() {
  std::optional<std::string> record;
  visit_records([&](std::string_view user, int id, std::string_view content) {
    if (id == las::compression_id && user.starts_with(las::compression_user)) record = content;
    return !record;
  });
  if (!record) fail_cloud(file_->path(), "is compressed (LAZ), but the LAZ record is missing");
  return *record;
}

void LasReader::open_compressed(LasFields fields) {
  const std::string record = compression_record();
  const las::StoredPoints points{header_.format, header_.point_size, header_.first_point,
                                 fields == LasFields::all};
  const auto read = [file = file_.get()](std::uint64_t offset, std::uint64_t count) {
    return file->bytes(offset, count);
  };
  compressed_ = file_->with_name(
      [&] { return std::make_unique<las::PointStream>(read, file_->size(), points, record); });
  record_.resize(header_.point_size);
}

bool LasReader::next(LasPoints& points, std::size_t max) {
  points.positions.clear();
  points.classes.clear();
  points.colours.clear();
  const std::uint64_t count = std::min<std::uint64_t>(max, header_.points - points_read_);
  if (compressed_ != nullptr) {
    decompress(points, count);
  } else {
    const std::string some =
        bytes(header_.first_point + points_read_ * header_.point_size, count * header_.point_size);
    for (std::uint64_t i = 0; i < count; ++i) {
      const char* const point = some.data() + i * header_.point_size;
      if (!is_withheld(header_, point)) add_point(header_, point, points);
    }
  }
  points_read_ += count;
  return count > 0;
}

bool LasReader::next_sample(LasPoints& points, double fraction) {
  constexpr std::uint64_t block = 4096;
  const std::uint64_t left = header_.points - points_read_;
  const auto part_of = [&](std::uint64_t count) {
    return std::min(count, static_cast<std::uint64_t>(fraction * static_cast<double>(count)));
  };
  if (compressed_ == nullptr) {
    const std::uint64_t count = std::min(block, left), end = points_read_ + count;
    const bool has_points = next(points, std::max<std::uint64_t>(1, part_of(count)));
    points_read_ = end;
    return has_points;
  }
  if (!next(points, 1)) return false;
  const std::uint64_t rest = std::min(compressed_->left_in_chunk(), left - 1);
  decompress(points, part_of(rest));
  compressed_->skip_chunk();
  points_read_ += rest;
  return true;
}

bool LasReader::next_records(std::string& records, std::size_t max) {
  const std::uint64_t count = std::min<std::uint64_t>(max, header_.points - points_read_);
  if (compressed_ == nullptr) {
    records =
        bytes(header_.first_point + points_read_ * header_.point_size, count * header_.point_size);
  } else {
    records.resize(count * header_.point_size);
    file_->with_name([&] {
      for (std::uint64_t i = 0; i < count; ++i) {
        compressed_->next(records.data() + i * header_.point_size);
      }
    });
  }
  points_read_ += count;
  return count > 0;
}

void LasReader::decompress(LasPoints& points, std::uint64_t count) {
  file_->with_name([&] {
    for (std::uint64_t i = 0; i < count; ++i) {
      compressed_->next(record_.data());
      if (!is_withheld(header_, record_.data())) add_point(header_, record_.data(), points);
    }
  });
}

}  // namespace skycap::geometry
