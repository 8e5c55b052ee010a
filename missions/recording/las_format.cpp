#include "missions/recording/las_format.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "missions/recording/little_endian.h"

namespace skycap::missions::recording {
namespace {

constexpr std::uint16_t header_size = 375;
constexpr std::uint16_t record_header_size = 54;
constexpr double scan_angle_unit = 0.006 * geometry::radians_per_degree;

/// The nearest whole number of one that fits into 32 bits. Adding 1.5 * 2^52 leaves no place for
/// fractions in a double, and the whole number in its lowest bits: no call, no branch.
std::int32_t nearest(double number) {
  return static_cast<std::int32_t>(std::bit_cast<std::uint64_t>(number + 6755399441055744.0));
}

class LasFormat final : public CloudFormat {
 public:
  explicit LasFormat(const LasConfig& config)
      : config_(config), point_size_(config.point_format == 7 ? 36 : 30) {}

  std::vector<std::uint8_t> header(const CloudTotals& totals) const override;
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

/// Smallest and largest coordinates of some points, of which there is at least one.
Eigen::AlignedBox3f box_of(const std::vector<Eigen::Vector3f>& points) {
  using FourPoints = Eigen::Array<float, 12, 1>;  // whole registers
  FourPoints lowest = points[0].replicate<4, 1>(), highest = lowest;
  const std::size_t whole = points.size() / 4 * 4;
  for (std::size_t i = 0; i < whole; i += 4) {
    const FourPoints some = Eigen::Map<const FourPoints>(points[i].data());
    lowest = lowest.min(some);
    highest = highest.max(some);
  }
  Eigen::AlignedBox3f box;
  for (int i = 0; i < 4; ++i) {
    box.extend(lowest.segment<3>(3 * i).matrix()).extend(highest.segment<3>(3 * i).matrix());
  }
  for (std::size_t i = whole; i < points.size(); ++i) box.extend(points[i]);
  return box;
}

void LasFormat::encode(const sim::LidarReturns& returns, ReturnPosition position,
                       CloudChunk& chunk) const {
  chunk.totals = {};
  chunk.totals.points = returns.size();
  chunk.bytes.resize(returns.size() * point_size_);
  if (returns.size() == 0) return;
  const auto& points = position == ReturnPosition::reported ? returns.points : returns.true_points;
  const Eigen::Vector3d shift = returns.origin - config_.offset;
  const double per_unit = 1.0 / config_.scale;
  Eigen::AlignedBox3d box;  // in units
  if (config_.projection == nullptr) {
    const auto units = [&](const Eigen::Vector3f& point) -> Eigen::Vector3d {
      return (point.cast<double>() + shift) * per_unit;
    };
    encode_points(returns, points, units, chunk);
    const Eigen::AlignedBox3f relative = box_of(points);
    box = {units(relative.min()), units(relative.max())};
  } else {
    const auto units = [&](const Eigen::Vector3f& point) -> Eigen::Vector3d {
      const Eigen::Vector3d local = returns.origin + point.cast<double>();
      const Eigen::Vector3d place = (config_.projection->to_map(local) - config_.offset) * per_unit;
      box.extend(place);
      return place;
    };
    encode_points(returns, points, units, chunk);
  }
  constexpr double most = std::numeric_limits<std::int32_t>::max();
  if (!(box.min().array() >= -most).all() || !(box.max().array() <= most).all()) {
    throw Error(ErrorKind::bad_geometry,
                "a point is farther than " + std::to_string(most * config_.scale) +
                    " m from the LAS file's offset; choose an offset near the scene");
  }
  for (const Eigen::Vector3d& corner : {box.min(), box.max()}) {
    const Eigen::Vector3d whole(nearest(corner.x()), nearest(corner.y()), nearest(corner.z()));
    chunk.totals.bounds.extend(whole * config_.scale + config_.offset);
  }
}

template <typename Units>
void LasFormat::encode_points(const sim::LidarReturns& returns,
                              const std::vector<Eigen::Vector3f>& points, const Units& units,
                              CloudChunk& chunk) const {
  std::uint8_t* out = chunk.bytes.data();
  for (std::size_t i = 0; i < returns.size(); ++i, out += point_size_) {
    const Eigen::Vector3d place = units(points[i]);
    for (int axis = 0; axis < 3; ++axis) store(out + 4UL * axis, nearest(place[axis]));
    const double brightness = 65535.0 * std::clamp(returns.intensities[i], 0.0F, 1.0F);
    const auto intensity = static_cast<std::uint16_t>(nearest(brightness));
    store(out + 12, intensity);
    const std::uint8_t number = returns.return_numbers[i];
    out[14] = static_cast<std::uint8_t>(number | (returns.returns_of_shots[i] << 4));
    out[15] = 0;  // no flags
    out[16] = 0;  // never classified
    out[17] = static_cast<std::uint8_t>(returns.channels[i] & 0xFFU);
    const double angle = static_cast<double>(returns.scan_angles[i]) * (1.0 / scan_angle_unit);
    store(out + 18, static_cast<std::int16_t>(nearest(angle)));
    store(out + 20, std::uint16_t{1});  // the first and only flight line
    store(out + 22, returns.times[i]);
    ++chunk.totals.points_by_return[number - 1];
    if (point_size_ == 30) continue;
    for (int colour = 0; colour < 3; ++colour) store(out + 30 + 2UL * colour, intensity);
  }
}

// Public header block and the one variable length record, that of the reference system.
std::vector<std::uint8_t> LasFormat::header(const CloudTotals& totals) const {
  const auto wkt_size = static_cast<std::uint16_t>(config_.crs_wkt.size() + 1);  // ends with zero
  const std::uint32_t first_point = header_size + record_header_size + wkt_size;
  constexpr std::uint16_t adjusted_time = 1, wkt = 1 << 4;
  Bytes bytes;
  bytes.add_text("LASF", 4)
      .add(std::uint16_t{0})
      .add(static_cast<std::uint16_t>(adjusted_time | wkt));
  bytes.add_text("", 16);  // project identifier
  bytes.add(std::uint8_t{1}).add(std::uint8_t{4});
  bytes.add_text("simulation", 32).add_text("Skycap", 32);
  bytes.add(std::uint16_t{0}).add(std::uint16_t{0});  // no creation date: same input, same bytes
  bytes.add(header_size).add(first_point).add(std::uint32_t{1});
  bytes.add(static_cast<std::uint8_t>(config_.point_format)).add(point_size_);
  for (int i = 0; i < 6; ++i)
    bytes.add(std::uint32_t{0});  // counts of older versions, zero from point format 6 on
  for (int axis = 0; axis < 3; ++axis) bytes.add(config_.scale);
  for (int axis = 0; axis < 3; ++axis) bytes.add(config_.offset[axis]);
  for (int axis = 0; axis < 3; ++axis) {
    bytes.add(totals.points > 0 ? totals.bounds.max()[axis] : 0.0)
        .add(totals.points > 0 ? totals.bounds.min()[axis] : 0.0);
  }
  bytes.add(std::uint64_t{0});                        // no waveforms
  bytes.add(std::uint64_t{0}).add(std::uint32_t{0});  // no extended records
  bytes.add(totals.points);
  for (const std::uint64_t count : totals.points_by_return) bytes.add(count);

  bytes.add(std::uint16_t{0}).add_text("LASF_Projection", 16).add(std::uint16_t{2112});
  bytes.add(wkt_size).add_text("OGC coordinate system WKT", 32);
  bytes.add_text(config_.crs_wkt, wkt_size);
  return bytes.take();
}

}  // namespace

void LasConfig::validate() const {
  const auto require = [](bool holds, const std::string& what) {
    if (!holds) throw Error(ErrorKind::bad_config, what);
  };
  require(point_format == 6 || point_format == 7,
          "las.point_format is " + std::to_string(point_format) + "; it must be 6 or 7");
  require(scale > 0.0 && std::isfinite(scale),
          "las.scale is " + std::to_string(scale) + "; it must be above zero");
  require(offset.allFinite(), "las.offset is not finite");
  require(crs_wkt.size() < 65535,
          "las.crs_wkt is " + std::to_string(crs_wkt.size()) + " bytes long; a record holds 65534");
}

std::shared_ptr<const CloudFormat> las_format(const LasConfig& config) {
  config.validate();
  return std::make_shared<LasFormat>(config);
}

}  // namespace skycap::missions::recording
