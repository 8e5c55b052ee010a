#include "missions/scan/las_format.h"

#include <algorithm>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/io/las/chunk_encoder.h"
#include "geometry/io/las/las_file_writer.h"
#include "geometry/io/las/las_writer.h"

namespace skycap::missions::scan {
namespace {

namespace las = geometry::las;

class LasFormat final : public CloudFormat {
 public:
  explicit LasFormat(const LasConfig& config)
      : config_(config), point_size_(las::point_size(config.point_format)) {}

  std::vector<std::uint8_t> header(const CloudState& grown) const override {
    const CloudTotals& totals = grown.totals;
    const CoordinateGrid& grid = config_.grid;
    las::WrittenFile file;
    file.point_format = config_.point_format;
    file.is_compressed = config_.is_compressed;
    file.records = {las::wkt_record(grid.crs_wkt)};
    file.scale = Eigen::Vector3d::Constant(grid.scale);
    file.offset = grid.offset;
    file.points = totals.points;
    file.points_by_return = totals.points_by_return;
    file.bounds = totals.bounds;
    if (!config_.is_compressed) return las::make_header(file);
    file.records.push_back(las::compression_record(config_.point_format, point_size_));
    std::vector<std::uint8_t> bytes = las::make_header(file);
    // The chunk table follows the points.
    bytes.resize(bytes.size() + sizeof(std::uint64_t));
    geometry::put_value(bytes.data(), bytes.size() - sizeof(std::uint64_t), grown.bytes);
    return bytes;
  }
  std::string trailer(std::istream& file, const CloudState& grown) const override;
  void encode(const sim::LidarReturns& returns, ReturnPosition position,
              CloudChunk& chunk) const override;

 private:
  void compress(CloudChunk& chunk) const;

  /// `units` converts a point to integer steps relative to the offset.
  template <typename Units>
  void encode_points(const sim::LidarReturns& returns, const std::vector<Eigen::Vector3f>& points,
                     const Units& units, CloudChunk& chunk) const;

  LasConfig config_;
  std::uint16_t point_size_;
};

void LasFormat::encode(const sim::LidarReturns& returns, ReturnPosition position,
                       CloudChunk& chunk) const {
  chunk.totals = {};
  chunk.totals.points = returns.size();
  chunk.bytes.resize(returns.size() * point_size_);
  if (returns.size() == 0) return;
  const auto& points = select_positions(returns, position);
  chunk.totals.bounds = encode_on_grid(config_.grid, returns, points, [&](const auto& units) {
    encode_points(returns, points, units, chunk);
  });
  if (config_.is_compressed) compress(chunk);
}

void LasFormat::compress(CloudChunk& chunk) const {
  const auto encoder = las::make_chunk_encoder(config_.point_format, point_size_);
  const auto* const points = reinterpret_cast<const char*>(chunk.bytes.data());
  std::string compressed;
  for (std::size_t begin = 0; begin < chunk.bytes.size(); begin += point_size_) {
    encoder->add(points + begin);
    if (encoder->points() == las::chunk_points) compressed += encoder->finish();
  }
  compressed += encoder->finish();
  chunk.bytes.assign(compressed.begin(), compressed.end());
}

// The table is created from the points, because a scan may be resumed or joined from pieces.
std::string LasFormat::trailer(std::istream& file, const CloudState& grown) const {
  if (!config_.is_compressed) return {};
  const std::uint64_t begin = header({}).size();
  return las::chunk_table(
      las::find_chunks(file, begin, grown.bytes, config_.point_format, point_size_), true);
}

template <typename Units>
void LasFormat::encode_points(const sim::LidarReturns& returns,
                              const std::vector<Eigen::Vector3f>& points, const Units& units,
                              CloudChunk& chunk) const {
  constexpr double scan_angle_unit = las::point::scan_angle_unit_deg * geometry::radians_per_degree;
  std::uint8_t* out = chunk.bytes.data();
  for (std::size_t i = 0; i < returns.size(); ++i, out += point_size_) {
    const Eigen::Vector3d coordinates = units(points[i]);
    const double brightness = 65535.0 * std::clamp(returns.intensities[i], 0.0F, 1.0F);
    const double angle = static_cast<double>(returns.scan_angles[i]) * (1.0 / scan_angle_unit);
    const std::uint8_t number = returns.return_numbers[i];
    las::put_point(
        out, config_.point_format,
        {.position = {nearest(coordinates.x()), nearest(coordinates.y()), nearest(coordinates.z())},
         .intensity = static_cast<std::uint16_t>(nearest(brightness)),
         .return_number = number,
         .returns = returns.number_of_returns[i],
         .user_data = static_cast<std::uint8_t>(returns.channels[i] & 0xFFU),
         .scan_angle = static_cast<std::int16_t>(nearest(angle)),
         .time = returns.times[i]});
    ++chunk.totals.points_by_return[number - 1];
  }
}

}  // namespace

void LasConfig::validate() const {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw Error(ErrorKind::bad_config, what);
  };
  require(point_format == 6 || point_format == 7,
          "las.point_format is " + std::to_string(point_format) + "; it must be 6 or 7");
  grid.validate();
  require(grid.crs_wkt.size() < 65535, "las.crs_wkt is " + std::to_string(grid.crs_wkt.size()) +
                                           " bytes long; the maximum is 65534");
}

std::shared_ptr<const CloudFormat> las_format(const LasConfig& config) {
  config.validate();
  return std::make_shared<LasFormat>(config);
}

}  // namespace skycap::missions::scan
