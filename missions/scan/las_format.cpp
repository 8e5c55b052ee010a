#include "missions/scan/las_format.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string_view>

#include "geometry/angle.h"
#include "geometry/byte_values.h"
#include "geometry/error.h"
#include "geometry/io/las_layout.h"

namespace skycap::missions::scan {
namespace {

namespace las = geometry::las;
using geometry::put_value;

constexpr double scan_angle_unit = 0.006 * geometry::radians_per_degree;

class LasFormat final : public CloudFormat {
 public:
  explicit LasFormat(const LasConfig& config)
      : config_(config), point_size_(las::point_size(config.point_format)) {}

  std::vector<std::uint8_t> header(const CloudState& grown) const override;
  void encode(const sim::LidarReturns& returns, ReturnPosition position,
              CloudChunk& chunk) const override;

 private:
  /// `units` gives a point's coordinates in multiples of the scale from the offset.
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
  const auto& points = positions_of(returns, position);
  chunk.totals.bounds = encode_on_grid(config_.grid, returns, points, [&](const auto& units) {
    encode_points(returns, points, units, chunk);
  });
}

template <typename Units>
void LasFormat::encode_points(const sim::LidarReturns& returns,
                              const std::vector<Eigen::Vector3f>& points, const Units& units,
                              CloudChunk& chunk) const {
  std::uint8_t* out = chunk.bytes.data();
  for (std::size_t i = 0; i < returns.size(); ++i, out += point_size_) {
    const Eigen::Vector3d place = units(points[i]);
    for (int axis = 0; axis < 3; ++axis) {
      put_value(out, las::point::position + 4UL * axis, nearest(place[axis]));
    }
    const double brightness = 65535.0 * std::clamp(returns.intensities[i], 0.0F, 1.0F);
    const auto intensity = static_cast<std::uint16_t>(nearest(brightness));
    put_value(out, las::point::intensity, intensity);
    const std::uint8_t number = returns.return_numbers[i];
    out[las::point::returns] =
        static_cast<std::uint8_t>(number | (returns.returns_of_shots[i] << 4));
    out[las::point::flags] = 0;
    out[las::point::classification] = 0;  // never classified
    out[las::point::user_data] = static_cast<std::uint8_t>(returns.channels[i] & 0xFFU);
    const double angle = static_cast<double>(returns.scan_angles[i]) * (1.0 / scan_angle_unit);
    put_value(out, las::point::scan_angle, static_cast<std::int16_t>(nearest(angle)));
    put_value(out, las::point::source, std::uint16_t{1});  // the first and only flight line
    put_value(out, las::point::time, returns.times[i]);
    ++chunk.totals.points_by_return[number - 1];
    if (config_.point_format == 6) continue;
    for (int colour = 0; colour < 3; ++colour) {
      put_value(out, las::point::colour + 2UL * colour, intensity);
    }
  }
}

/// Public header block and the one variable length record, that of the reference system. What is
/// not put is zero: the creation date, so that the same input gives the same bytes; the counts of
/// older versions, as from point format 6 on; waveforms and extended records, of which there are
/// none.
std::vector<std::uint8_t> LasFormat::header(const CloudState& grown) const {
  const CloudTotals& totals = grown.totals;
  const std::string& crs_wkt = config_.grid.crs_wkt;
  const std::size_t wkt_size = crs_wkt.size() + 1;  // ends with zero
  constexpr std::size_t record = las::header::end, wkt = record + las::record::end;
  constexpr std::uint16_t adjusted_time = 1, is_wkt = 1 << 4, wkt_record = 2112;
  std::vector<std::uint8_t> bytes(wkt + wkt_size);
  const auto put = [&](std::size_t place, auto value) { put_value(bytes.data(), place, value); };
  const auto put_text = [&](std::size_t place, std::string_view text) {
    std::ranges::copy(text, bytes.begin() + static_cast<std::ptrdiff_t>(place));
  };
  put_text(las::header::signature, "LASF");
  put(las::header::encoding, static_cast<std::uint16_t>(adjusted_time | is_wkt));
  put(las::header::major, std::uint8_t{1});
  put(las::header::minor, std::uint8_t{4});
  put_text(las::header::system, "simulation");
  put_text(las::header::software, "Skycap");
  put(las::header::size, static_cast<std::uint16_t>(las::header::end));
  put(las::header::first_point, static_cast<std::uint32_t>(bytes.size()));
  put(las::header::records, std::uint32_t{1});
  put(las::header::point_format, static_cast<std::uint8_t>(config_.point_format));
  put(las::header::point_size, point_size_);
  for (int axis = 0; axis < 3; ++axis) {
    put(las::header::scale + 8UL * axis, config_.grid.scale);
    put(las::header::offset + 8UL * axis, config_.grid.offset[axis]);
    if (totals.points == 0) continue;
    put(las::header::bounds + 16UL * axis, totals.bounds.max()[axis]);
    put(las::header::bounds + 16UL * axis + 8, totals.bounds.min()[axis]);
  }
  put(las::header::points, totals.points);
  for (std::size_t i = 0; i < totals.points_by_return.size(); ++i) {
    put(las::header::points_by_return + 8 * i, totals.points_by_return[i]);
  }
  put_text(record + las::record::user, "LASF_Projection");
  put(record + las::record::id, wkt_record);
  put(record + las::record::length, static_cast<std::uint16_t>(wkt_size));
  put_text(record + las::record::description, "OGC coordinate system WKT");
  put_text(wkt, crs_wkt);
  return bytes;
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
                                           " bytes long; a record holds 65534");
}

std::shared_ptr<const CloudFormat> las_format(const LasConfig& config) {
  config.validate();
  return std::make_shared<LasFormat>(config);
}

}  // namespace skycap::missions::scan
