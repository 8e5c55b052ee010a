#include "missions/scan/preview.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "geometry/split_mix.h"
#include "missions/scan/little_endian.h"

namespace skycap::missions::scan {
namespace {

constexpr double wanted_shots = 1.5e6;

class PreviewFormat final : public CloudFormat {
 public:
  PreviewFormat(const PreviewPieces& pieces, double share) : pieces_(pieces), share_(share) {}

  std::vector<std::uint8_t> header(const CloudState& grown) const override {
    const std::string count = std::to_string(grown.totals.points);
    // The comment takes up what the number of points leaves.
    const std::string text =
        "ply\nformat binary_little_endian 1.0\ncomment written by Skycap" +
        std::string(20 - count.size(), ' ') + "\nelement vertex " + count +
        "\nproperty float x\nproperty float y\nproperty float z\nproperty uint view\nend_header\n";
    return {text.begin(), text.end()};
  }

  void encode(const sim::LidarReturns& returns, ReturnPosition position,
              CloudChunk& chunk) const override {
    constexpr std::size_t size = 16;
    const auto& points =
        position == ReturnPosition::reported ? returns.points : returns.true_points;
    chunk.totals = {};
    chunk.bytes.clear();
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const double time = returns.times[i];
      if (!is_previewed(std::bit_cast<std::uint64_t>(time), returns.channels[i], share_)) continue;
      const Eigen::Vector3d point = returns.origin + points[i].cast<double>();
      if (!(point.cwiseAbs().maxCoeff() < farthest_coordinate)) continue;
      chunk.bytes.resize(chunk.bytes.size() + size);
      std::uint8_t* out = &chunk.bytes[chunk.bytes.size() - size];
      for (int axis = 0; axis < 3; ++axis) store(out + 4UL * axis, static_cast<float>(point[axis]));
      const double piece = std::floor((time - pieces_.start) / pieces_.length);
      store(out + 12, static_cast<std::uint32_t>(std::max(0.0, piece)));
      ++chunk.totals.points;
    }
  }

 private:
  PreviewPieces pieces_;
  double share_;
};

}  // namespace

double preview_share(double shots) { return shots > wanted_shots ? wanted_shots / shots : 1.0; }

bool is_previewed(std::uint64_t time, std::uint64_t number, double share) {
  const std::uint64_t random = geometry::split_mix(geometry::split_mix(time) + number);
  return std::ldexp(static_cast<double>(random), -64) < share;
}

PreviewPieces preview_pieces(const sim::LidarConfig& sensor, const sim::Trajectory& flown) {
  constexpr double most_pieces = 1000.0;
  const bool spins = sensor.prisms.empty() && sensor.rotation_rate != 0.0;
  const double turn = spins ? 1.0 / std::abs(sensor.rotation_rate) : 0.1;
  const double turns = (flown.end() - flown.start()) / turn;
  return {flown.start(), turn * std::max(1.0, std::ceil(turns / most_pieces))};
}

std::shared_ptr<const CloudFormat> preview_format(const PreviewPieces& pieces, double share) {
  return std::make_shared<PreviewFormat>(pieces, share);
}

}  // namespace skycap::missions::scan
