#include <algorithm>

#include "geometry/byte_values.h"
#include "geometry/io/las_layout.h"
#include "geometry/io/las_reader.h"
#include "missions/site_data/formats/cell_set.h"
#include "missions/site_data/formats/cloud_files.h"

namespace skycap::missions::site_data {
namespace {

namespace las = geometry::las;

std::string text_of(std::string_view bytes) {
  return std::string(bytes.substr(0, bytes.find('\0')));
}

/// What the records of a file say of its reference system.
struct GeoRecords {
  std::string wkt;
  int projected = 0, geographic = 0, vertical = 0;  ///< EPSG numbers
  int vertical_unit = 0;                            ///< EPSG number
  bool is_user_defined = false;
};

/// The directory of GeoKeys (GeoTIFF 1.1, OGC 19-008r4): key, where the value is, count, value.
void read_geo_keys(std::string_view directory, GeoRecords& records) {
  for (std::size_t i = 8; i + 8 <= directory.size(); i += 8) {
    const int key = geometry::value_at<std::uint16_t>(directory.data(), i),
              place = geometry::value_at<std::uint16_t>(directory.data(), i + 2),
              value = geometry::value_at<std::uint16_t>(directory.data(), i + 6);
    if (place != 0) continue;
    constexpr int user_defined = 32767;
    if ((key == 3072 || key == 2048) && value == user_defined) records.is_user_defined = true;
    if (value == user_defined) continue;
    if (key == 3072) records.projected = value;
    if (key == 2048) records.geographic = value;
    if (key == 4096) records.vertical = value;
    if (key == 4099) records.vertical_unit = value;
  }
}

void read_record(std::string_view user, int id, std::string_view content, GeoRecords& records) {
  const bool is_projection = user == "LASF_Projection" || user == "liblas";
  if (is_projection && id == 2112 && records.wkt.empty()) records.wkt = text_of(content);
  if (is_projection && id == 34735) read_geo_keys(content, records);
}

GeoRecords geo_records(geometry::LasReader& input) {
  const geometry::LasHeader& header = input.header();
  GeoRecords records;
  std::uint64_t place = header.header_size;
  for (std::uint32_t i = 0; i < header.records && place < header.first_point; ++i) {
    const std::string head = input.bytes(place, las::record::end);
    if (head.size() < las::record::end) break;
    const auto length = geometry::value_at<std::uint16_t>(head.data(), las::record::length);
    read_record(text_of(std::string_view(head).substr(las::record::user, 16)),
                geometry::value_at<std::uint16_t>(head.data(), las::record::id),
                input.bytes(place + las::record::end, length), records);
    place += las::record::end + length;
  }
  place = header.first_extended_record;
  constexpr std::uint64_t longest = 1 << 20;  // of a WKT
  for (std::uint32_t i = 0; i < header.extended_records && i < 1000; ++i) {
    const std::string head = input.bytes(place, las::record::extended_end);
    if (head.size() < las::record::extended_end) break;
    const auto length = geometry::value_at<std::uint64_t>(head.data(), las::record::length);
    read_record(text_of(std::string_view(head).substr(las::record::user, 16)),
                geometry::value_at<std::uint16_t>(head.data(), las::record::id),
                input.bytes(place + las::record::extended_end, std::min(length, longest)), records);
    if (length > most_bytes) break;
    place += las::record::extended_end + length;
  }
  return records;
}

std::optional<double> metres_of_unit(int epsg) {
  if (epsg == 9001) return 1.0;
  if (epsg == 9002) return 0.3048;
  if (epsg == 9003) return 1200.0 / 3937.0;  // the US survey foot
  return std::nullopt;
}

void name_reference_system(const GeoRecords& records, FileContents& contents) {
  set_wkt(contents, records.wkt);
  const int horizontal = records.projected != 0 ? records.projected : records.geographic;
  if (records.wkt.empty() && horizontal != 0) {
    contents.crs = "EPSG:" + std::to_string(horizontal);
    // 5001 to 5199 are no reference systems, and out of use (GeoTIFF 1.0, 6.3.4.1).
    const bool is_system = records.vertical != 0 && records.vertical / 200 != 25;
    if (is_system) contents.crs += "+" + std::to_string(records.vertical);
  }
  if (records.wkt.empty() && horizontal == 0 && records.is_user_defined) {
    contents.notes.push_back(
        "its reference system is given by GeoTIFF parameters, which are not supported");
  }
  contents.height_unit = metres_of_unit(records.vertical_unit);
}

void read_points(geometry::LasReader& input, const std::vector<int>& classes,
                 const CloudThinning& thinning, FileContents& contents) {
  const auto is_wanted = [&](int point_class) {
    if (classes.empty()) return point_class != 7 && point_class != 18;
    return std::ranges::find(classes, point_class) != classes.end();
  };
  CellSet cells;
  const Eigen::Vector3d cells_per_unit = thinning.metres_per_unit(contents) / thinning.spacing;
  geometry::LasPoints points;
  while (input.next(points)) {
    for (std::size_t i = 0; i < points.positions.size(); ++i) {
      const Eigen::Vector3d& place = points.positions[i];
      if (!is_wanted(points.classes[i])) continue;
      if (!cells.add(place.cwiseProduct(cells_per_unit))) continue;
      contents.points.push_back(place);
    }
  }
}

}  // namespace

FileContents read_las(const std::filesystem::path& file, const std::vector<int>& classes,
                      const CloudThinning& thinning) {
  geometry::LasReader input(file);
  FileContents contents;
  contents.has_classes = true;
  contents.format = "LAS 1." + std::to_string(input.header().minor) + ", points of format " +
                    std::to_string(input.header().format) +
                    (input.header().is_compressed ? ", compressed (LAZ)" : "");
  name_reference_system(geo_records(input), contents);
  read_points(input, classes, thinning, contents);
  return contents;
}

}  // namespace skycap::missions::site_data
