#include "missions/scan/preview.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "geometry/byte_values.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/text/ply.h"
#include "geometry/split_mix.h"

namespace skycap::missions::scan {
namespace {

constexpr double target_pulses = 1.5e6;

class PreviewFormat final : public CloudFormat {
 public:
  PreviewFormat(const PreviewSegments& segments, double share)
      : segments_(segments), share_(share) {}

  std::vector<std::uint8_t> header(const CloudState& grown) const override {
    geometry::PlyElement vertex{"vertex", grown.totals.points, {}};
    vertex.add(geometry::PlyType::float32, {"x", "y", "z"});
    vertex.add(geometry::PlyType::uint32, {"view"});
    const std::string text = geometry::growing_ply_header(vertex);
    return {text.begin(), text.end()};
  }

  void encode(const sim::LidarReturns& returns, ReturnPosition position,
              CloudChunk& chunk) const override {
    constexpr std::size_t size = 16;
    const auto& points = select_positions(returns, position);
    chunk.totals = {};
    chunk.bytes.clear();
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const double time = returns.times[i];
      if (!is_previewed(std::bit_cast<std::uint64_t>(time), returns.channels[i], share_)) continue;
      const Eigen::Vector3d point = returns.origin + points[i].cast<double>();
      if (!(point.cwiseAbs().maxCoeff() < geometry::farthest_single_coordinate)) continue;
      chunk.bytes.resize(chunk.bytes.size() + size);
      std::uint8_t* out = &chunk.bytes[chunk.bytes.size() - size];
      for (int axis = 0; axis < 3; ++axis)
        geometry::put_value(out, 4UL * axis, static_cast<float>(point[axis]));
      const double segment = std::floor((time - segments_.start) / segments_.length);
      geometry::put_value(out, 12, static_cast<std::uint32_t>(std::max(0.0, segment)));
      ++chunk.totals.points;
    }
  }

 private:
  PreviewSegments segments_;
  double share_;
};

}  // namespace

double preview_share(double pulses) {
  return pulses > target_pulses ? target_pulses / pulses : 1.0;
}

bool is_previewed(std::uint64_t time, std::uint64_t number, double share) {
  const std::uint64_t random = geometry::split_mix(geometry::split_mix(time) + number);
  return std::ldexp(static_cast<double>(random), -64) < share;
}

PreviewSegments make_preview_segments(const sim::LidarConfig& sensor,
                                      const sim::Trajectory& ground_truth) {
  constexpr double max_pieces = 1000.0;
  const bool spins = sensor.prisms.empty() && sensor.rotation_rate != 0.0;
  const double turn = spins ? 1.0 / std::abs(sensor.rotation_rate) : 0.1;
  const double turns = (ground_truth.end() - ground_truth.start()) / turn;
  return {ground_truth.start(), turn * std::max(1.0, std::ceil(turns / max_pieces))};
}

std::shared_ptr<const CloudFormat> preview_format(const PreviewSegments& segments, double share) {
  return std::make_shared<PreviewFormat>(segments, share);
}

}  // namespace skycap::missions::scan
