#include <array>
#include <limits>
#include <string_view>

#include "geometry/byte_values.h"
#include "geometry/io/e57/crc32c.h"
#include "geometry/io/e57/pages.h"
#include "geometry/io/e57/scan_file.h"
#include "missions/scan/cloud_formats.h"

namespace skycap::missions::scan {
namespace {

namespace e57 = geometry::e57;

/// Field indices in a record.
enum Column : std::size_t { x, y, z, intensity, time, return_number, number_of_returns, columns };

std::vector<e57::Field> fields_on(const CoordinateGrid& grid) {
  const auto coordinate = [&](const char* name, int axis) {
    return e57::Field{name,
                      e57::Coding::scaled_integer,
                      std::numeric_limits<std::int32_t>::min(),
                      std::numeric_limits<std::int32_t>::max(),
                      grid.scale,
                      grid.offset[axis]};
  };
  return {coordinate("cartesianX", 0),
          coordinate("cartesianY", 1),
          coordinate("cartesianZ", 2),
          {"intensity", e57::Coding::single_precision},
          {"timeStamp", e57::Coding::double_precision},
          {"returnIndex", e57::Coding::integer, 0, 255},
          {"returnCount", e57::Coding::integer, 0, 255}};
}

class E57Format final : public CloudFormat {
 public:
  E57Format(CoordinateGrid grid, std::string sensor_name)
      : grid_(std::move(grid)), fields_(fields_on(grid_)), sensor_name_(std::move(sensor_name)) {}

  std::vector<std::uint8_t> header(const CloudState& grown) const override {
    e57::WrittenScan scan;
    scan.sensor = sensor_name_;
    scan.reference_system = grid_.crs_wkt;
    scan.fields = fields_;
    scan.records = grown.totals.points;
    scan.bounds = grown.totals.bounds;
    scan.checksum = grown.totals.checksum;
    std::string bytes = e57::make_file_head(scan);
    if (grown.bytes > bytes.size()) {
      const std::uint64_t size = grown.bytes - bytes.size();
      scan.packets_size = size - size / e57::page_size * e57::checksum_size;
      bytes = e57::make_file_head(scan);
    }
    return {bytes.begin(), bytes.end()};
  }

  bool is_paged() const override { return true; }

  void encode(const sim::LidarReturns& returns, ReturnPosition position,
              CloudChunk& chunk) const override {
    chunk.totals = {};
    chunk.bytes.clear();
    if (returns.size() == 0) return;
    std::array<std::string, columns> values;
    for (std::size_t i = 0; i < columns; ++i) {
      values[i].resize(returns.size() * fields_[i].bits() / 8);
    }
    put_positions(returns, position, values, chunk.totals);
    const auto put = [&](Column column, std::size_t i, auto value) {
      geometry::put_value(values[column].data(), i * sizeof value, value);
    };
    for (std::size_t i = 0; i < returns.size(); ++i) {
      put(intensity, i, returns.intensities[i]);
      put(time, i, returns.times[i]);
      put(return_number, i, static_cast<std::uint8_t>(returns.return_numbers[i] - 1));
      put(number_of_returns, i, returns.number_of_returns[i]);
    }
    const std::string packets = e57::make_packets(fields_, values);
    chunk.bytes.assign(packets.begin(), packets.end());
    chunk.totals.points = returns.size();
    chunk.totals.checksum = e57::crc32c(packets);
  }

 private:
  void put_positions(const sim::LidarReturns& returns, ReturnPosition position,
                     std::array<std::string, columns>& values, CloudTotals& totals) const {
    const auto& points = select_positions(returns, position);
    const auto put_all = [&](const auto& units) {
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3d coordinates = units(points[i]);
        for (const Column axis : {x, y, z}) {
          // Stored values are relative to the minimum of the 32-bit range.
          const auto stored = static_cast<std::uint32_t>(nearest(coordinates[axis])) ^ 0x80000000U;
          geometry::put_value(values[axis].data(), 4 * i, stored);
        }
      }
    };
    totals.bounds = encode_on_grid(grid_, returns, points, put_all);
  }

  CoordinateGrid grid_;
  std::vector<e57::Field> fields_;
  std::string sensor_name_;
};

}  // namespace

std::shared_ptr<const CloudFormat> e57_format(const CoordinateGrid& grid,
                                              const std::string& sensor_name) {
  grid.validate();
  return std::make_shared<E57Format>(grid, sensor_name);
}

}  // namespace skycap::missions::scan
