#include "missions/las_writer.h"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>

#include "geometry/error.h"

namespace skycap::missions {
namespace {

constexpr std::uint16_t header_size = 375;
constexpr std::uint16_t record_header_size = 54;
constexpr std::uint8_t point_format = 6;
constexpr std::uint16_t point_size = 30;
constexpr double scan_angle_unit = 0.006 * std::numbers::pi / 180.0;

/// Little-endian values into bytes, whatever the processor.
template <typename Value>
void store(std::uint8_t* bytes, Value value) {
  static_assert(std::is_arithmetic_v<Value>);
  std::memcpy(bytes, &value, sizeof value);
  if constexpr (std::endian::native == std::endian::big) std::reverse(bytes, bytes + sizeof value);
}

class Bytes {
 public:
  template <typename Value>
  Bytes& add(Value value) {
    bytes_.resize(bytes_.size() + sizeof value);
    store(bytes_.data() + bytes_.size() - sizeof value, value);
    return *this;
  }
  Bytes& add_text(std::string_view text, std::size_t size) {
    const std::size_t kept = std::min(text.size(), size);
    bytes_.insert(bytes_.end(), text.begin(), text.begin() + static_cast<std::ptrdiff_t>(kept));
    bytes_.resize(bytes_.size() + size - kept, 0);
    return *this;
  }
  std::vector<std::uint8_t> take() { return std::move(bytes_); }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace

LasWriter::LasWriter(std::filesystem::path path, LasConfig config)
    : path_(std::move(path)), temporary_(path_.string() + ".part"), config_(std::move(config)) {
  file_.reset(std::fopen(temporary_.c_str(), "wb"));
  if (!file_) {
    throw Error(ErrorKind::bad_file,
                path_.string() + ": cannot be written: " + std::generic_category().message(errno));
  }
  put(header());
}

LasWriter::~LasWriter() {
  if (!file_) return;
  file_.reset();
  std::error_code ignored;
  std::filesystem::remove(temporary_, ignored);
}

LasChunk LasWriter::encode(const sim::LidarReturns& returns) const {
  LasChunk chunk;
  chunk.bytes.resize(returns.size() * point_size);
  const Eigen::Vector3d shift = returns.origin - config_.offset;
  const double per_unit = 1.0 / config_.scale;
  Eigen::Array3d lowest = Eigen::Array3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Array3d highest = -lowest;
  std::uint8_t* out = chunk.bytes.data();
  for (std::size_t i = 0; i < returns.size(); ++i, out += point_size) {
    const Eigen::Array3d units =
        ((returns.points[i].cast<double>() + shift).array() * per_unit).round();
    lowest = lowest.min(units);
    highest = highest.max(units);
    for (int axis = 0; axis < 3; ++axis) {
      store(out + 4UL * axis,
            static_cast<std::int32_t>(std::clamp(units[axis], -2147483648.0, 2147483647.0)));
    }
    const float intensity = std::clamp(returns.intensities[i], 0.0F, 1.0F);
    store(out + 12, static_cast<std::uint16_t>(std::lround(65535.0F * intensity)));
    out[14] =
        static_cast<std::uint8_t>(returns.return_numbers[i] | (returns.returns_of_shots[i] << 4));
    out[15] = 0;  // no flags
    out[16] = 0;  // never classified
    out[17] = static_cast<std::uint8_t>(returns.channels[i] & 0xFFU);
    store(out + 18,
          static_cast<std::int16_t>(std::lround(returns.scan_angles[i] / scan_angle_unit)));
    store(out + 20, std::uint16_t{1});  // the first and only flight line
    store(out + 22, returns.times[i]);
    ++chunk.points_by_return[returns.return_numbers[i] - 1];
  }
  if (returns.size() == 0) return chunk;
  constexpr double most = std::numeric_limits<std::int32_t>::max();
  if (!(lowest >= -most).all() || !(highest <= most).all()) {
    throw Error(ErrorKind::bad_geometry,
                "a point is farther than " + std::to_string(most * config_.scale) +
                    " m from the LAS file's offset; choose an offset near the scene");
  }
  chunk.bounds.extend((lowest * config_.scale).matrix() + config_.offset);
  chunk.bounds.extend((highest * config_.scale).matrix() + config_.offset);
  return chunk;
}

void LasWriter::append(const LasChunk& chunk) {
  put(chunk.bytes);
  points_ += chunk.bytes.size() / point_size;
  for (std::size_t i = 0; i < points_by_return_.size(); ++i) {
    points_by_return_[i] += chunk.points_by_return[i];
  }
  bounds_.extend(chunk.bounds);
}

void LasWriter::finish() {
  if (std::fseek(file_.get(), 0, SEEK_SET) != 0) {
    throw Error(ErrorKind::bad_file,
                path_.string() + ": " + std::generic_category().message(errno));
  }
  put(header());
  if (std::fclose(file_.release()) != 0) {
    throw Error(ErrorKind::bad_file,
                path_.string() + ": " + std::generic_category().message(errno));
  }
  std::filesystem::rename(temporary_, path_);
}

// Public header block and the one variable length record, that of the reference system.
std::vector<std::uint8_t> LasWriter::header() const {
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
  bytes.add(point_format).add(point_size);
  for (int i = 0; i < 6; ++i)
    bytes.add(std::uint32_t{0});  // counts of older versions, zero from point format 6 on
  for (int axis = 0; axis < 3; ++axis) bytes.add(config_.scale);
  for (int axis = 0; axis < 3; ++axis) bytes.add(config_.offset[axis]);
  for (int axis = 0; axis < 3; ++axis) {
    bytes.add(points_ > 0 ? bounds_.max()[axis] : 0.0).add(points_ > 0 ? bounds_.min()[axis] : 0.0);
  }
  bytes.add(std::uint64_t{0});                        // no waveforms
  bytes.add(std::uint64_t{0}).add(std::uint32_t{0});  // no extended records
  bytes.add(points_);
  for (const std::uint64_t count : points_by_return_) bytes.add(count);

  bytes.add(std::uint16_t{0}).add_text("LASF_Projection", 16).add(std::uint16_t{2112});
  bytes.add(wkt_size).add_text("OGC coordinate system WKT", 32);
  bytes.add_text(config_.crs_wkt, wkt_size);
  return bytes.take();
}

void LasWriter::put(const std::vector<std::uint8_t>& bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) == bytes.size()) return;
  throw Error(ErrorKind::bad_file,
              path_.string() + ": cannot be written: " + std::generic_category().message(errno));
}

}  // namespace skycap::missions
