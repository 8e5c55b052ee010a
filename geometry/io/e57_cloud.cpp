#include <array>
#include <string>

#include "geometry/byte_values.h"
#include "geometry/io/cloud_parsers.h"
#include "geometry/io/e57/crc32c.h"
#include "geometry/io/e57/pages.h"
#include "geometry/io/e57/scan_file.h"
#include "geometry/io/e57_reader.h"

namespace skycap::geometry {
namespace {

/// Adds three fields with the interleaved values `triples` to a scan and its columns.
template <typename Value, typename Triple>
void add_fields(const std::array<const char*, 3>& names, const e57::Field& kind,
                std::span<const Triple> triples, e57::WrittenScan& scan,
                std::vector<std::string>& columns) {
  if (triples.empty()) return;
  for (std::size_t i = 0; i < names.size(); ++i) {
    scan.fields.push_back(kind);
    scan.fields.back().name = names[i];
    std::string& column = columns.emplace_back(triples.size() * sizeof(Value), '\0');
    for (std::size_t point = 0; point < triples.size(); ++point) {
      put_value(column.data(), point * sizeof(Value), Value{triples[point][i]});
    }
  }
}

}  // namespace

AttributedCloud read_e57_cloud(const std::filesystem::path& path) {
  E57Reader reader(path);
  AttributedCloud cloud;
  E57Points points;
  while (reader.next(points)) {
    require_few_points(path, cloud.positions.size() + points.positions.size());
    add_positions(path, cloud.positions.size(), points.positions, cloud.positions);
    cloud.normals.insert(cloud.normals.end(), points.normals.begin(), points.normals.end());
    cloud.colours.insert(cloud.colours.end(), points.colours.begin(), points.colours.end());
    if (reader.scans() > 1) cloud.views.resize(cloud.positions.size(), points.scan);
  }
  cloud.skipped = reader.skipped();
  return cloud;
}

std::string e57_bytes(const CloudColumns& cloud) {
  e57::WrittenScan scan;
  std::vector<std::string> columns;
  const e57::Field real{"", e57::Coding::single_precision}, byte{"", e57::Coding::integer, 0, 255};
  add_fields<float>({"cartesianX", "cartesianY", "cartesianZ"}, real, cloud.positions, scan,
                    columns);
  add_fields<float>({"nor:normalX", "nor:normalY", "nor:normalZ"}, real, cloud.normals, scan,
                    columns);
  add_fields<std::uint8_t>({"colorRed", "colorGreen", "colorBlue"}, byte, cloud.colours, scan,
                           columns);
  for (const Eigen::Vector3f& position : cloud.positions) {
    scan.bounds.extend(position.cast<double>());
  }
  const std::string packets = e57::make_packets(scan.fields, columns);
  scan.records = cloud.positions.size();
  scan.checksum = e57::crc32c(packets);
  scan.packets_size = packets.size();
  return e57::make_file_head(scan) + e57::sealed(packets);
}

std::size_t read_e57_positions(const std::filesystem::path& path,
                               const PositionsCallback& callback) {
  E57Reader reader(path);
  E57Points points;
  std::vector<Eigen::Vector3f> chunk;
  std::size_t count = 0;
  std::uint64_t records_read = 0;
  const auto hand_out = [&] {
    if (!chunk.empty()) {
      callback(chunk, static_cast<double>(records_read) / static_cast<double>(reader.points()));
    }
    chunk.clear();
  };
  while (reader.next(points, points_per_chunk - chunk.size())) {
    records_read += points.records;
    add_positions(path, count, points.positions, chunk);
    count += points.positions.size();
    if (chunk.size() == points_per_chunk) hand_out();
  }
  hand_out();
  if (count == 0) fail_without_points(path, reader.skipped());
  return reader.skipped();
}

}  // namespace skycap::geometry
