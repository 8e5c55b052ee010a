#include "geometry/io/las/las_conversion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "geometry/byte_values.h"
#include "geometry/io/las/las_file_writer.h"
#include "geometry/io/las/layout.h"

namespace skycap::geometry::las {
namespace {

// Offsets in a point of format 0 to 5.
constexpr std::size_t old_returns = 14, old_scan_angle = 16, old_user_data = 17, old_source = 18,
                      old_time = 20;
constexpr std::uint8_t overlap_class = 12;

bool has_old_time(int format) { return format == 1 || format >= 3; }

}  // namespace

std::vector<WrittenRecord> kept_records(LasReader& reader, std::vector<std::string>& lost) {
  constexpr std::size_t longest = 65535;
  std::vector<WrittenRecord> records;
  for (const LasRecord& kept : reader.kept_records()) {
    if (kept.content.size() > longest) {
      lost.emplace_back("a record of more than 65535 bytes is not kept");
      continue;
    }
    records.push_back({kept.is_projection ? record::projection : record::specification,
                       kept.id,
                       {},
                       kept.content});
  }
  return records;
}

PointUpgrade::PointUpgrade(const LasHeader& header)
    : old_format_(header.format), old_size_(header.point_size) {
  constexpr std::array<int, 11> formats = {6, 6, 7, 7, 6, 7, 6, 7, 8, 6, 8};
  format_ = formats[static_cast<std::size_t>(old_format_)];
  extra_ = old_size_ - point_size(old_format_);
  size_ = point_size(format_) + extra_;
  if (old_format_ == 4 || old_format_ == 5 || old_format_ >= 9) {
    waveform_ = point_sizes[0] + 9UL;
  }
}

void PointUpgrade::convert(std::string_view records, std::string& upgraded) const {
  const std::size_t count = records.size() / old_size_;
  upgraded.assign(count * size_, '\0');
  for (std::size_t i = 0; i < count; ++i) {
    const char* const from = records.data() + i * old_size_;
    char* const to = upgraded.data() + i * size_;
    if (old_format_ >= 6) {
      std::memcpy(to, from, point_size(format_));
    } else {
      convert_old(from, to);
    }
    std::memcpy(to + size_ - extra_, from + old_size_ - extra_, extra_);
  }
}

void PointUpgrade::convert_old(const char* from, char* to) const {
  std::memcpy(to, from, point::returns);  // position and intensity
  const auto returns = value_at<std::uint8_t>(from, old_returns);
  const auto classification = value_at<std::uint8_t>(from, old_point::classification);
  put_value(to, point::returns, static_cast<std::uint8_t>((returns & 7) | (returns >> 3 & 7) << 4));
  // Synthetic, key point and withheld; the class "overlap" has become a flag.
  const bool is_overlap = (classification & old_point::classes) == overlap_class;
  const int flag_bits =
      classification >> 5 | (is_overlap ? 8 : 0) | (returns >> 6 & 1) << 6 | (returns >> 7) << 7;
  put_value(to, point::flags, static_cast<std::uint8_t>(flag_bits));
  put_value(to, point::classification,
            static_cast<std::uint8_t>(is_overlap ? 1 : classification & old_point::classes));
  put_value(to, point::user_data, value_at<std::uint8_t>(from, old_user_data));
  const double angle = value_at<std::int8_t>(from, old_scan_angle);
  put_value(to, point::scan_angle,
            static_cast<std::int16_t>(std::lround(angle / point::scan_angle_unit_deg)));
  put_value(to, point::source, value_at<std::uint16_t>(from, old_source));
  if (has_old_time(old_format_)) put_value(to, point::time, value_at<double>(from, old_time));
  const std::size_t colour = colour_offsets[static_cast<std::size_t>(old_format_)];
  if (colour != 0) std::memcpy(to + point::colour, from + colour, 6);
}

std::vector<std::string> convert_las(const std::filesystem::path& from,
                                     const std::filesystem::path& to, bool is_compressed,
                                     const Eigen::Vector3d& shift, const std::string& crs_wkt,
                                     const ConversionProgress& progress) {
  LasReader reader(from, LasFields::all);
  const LasHeader& header = reader.header();
  const PointUpgrade upgrade(header);
  std::vector<std::string> lost;
  if (upgrade.drops_waveforms()) lost.emplace_back("waveforms are not kept");
  WrittenFile file;
  file.point_format = upgrade.format();
  file.extra_bytes = upgrade.extra_bytes();
  file.is_compressed = is_compressed;
  file.has_week_time = !header.has_adjusted_time;
  file.system = "conversion";
  file.records = kept_records(reader, lost);
  if (!crs_wkt.empty()) {
    std::erase_if(file.records,
                  [](const WrittenRecord& kept) { return kept.user == record::projection; });
    file.records.push_back(wkt_record(crs_wkt));
  }
  file.scale = header.scale;
  file.offset = header.offset + shift;
  LasFileWriter writer(to, std::move(file));
  std::string records, upgraded;
  while (reader.next_records(records)) {
    upgrade.convert(records, upgraded);
    writer.add(upgraded);
    progress(static_cast<double>(writer.points()) / static_cast<double>(header.points));
  }
  writer.finish();
  return lost;
}

}  // namespace skycap::geometry::las
