/// Where a laser scanner shoots, firing by firing, in its own frame.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/sensors/sensor.h"

namespace skycap::sim {

/// The shots of 32 consecutive firings. Their slots are in the order in which packets of rays are
/// cast: four firings of a channel, then the same four of the channel next to it in elevation.
struct Shots {
  std::vector<float> origin[3];       ///< sensor frame
  std::vector<float> direction[3];    ///< unit, sensor frame
  std::vector<float> azimuth;         ///< in (-pi, pi]
  std::vector<std::uint8_t> is_shot;  ///< 0 outside of the field of view
};

class ScanPattern {
 public:
  static constexpr std::uint32_t firings_in_block = 32;

  /// The configuration must be valid.
  explicit ScanPattern(const LidarConfig& config);

  std::size_t slots() const { return firings_in_block * channels_.size(); }

  /// The slot of a channel's shot, `firing` counted in the block.
  std::size_t slot(std::uint32_t firing, std::size_t channel) const {
    return ((firing / 4) * channels_.size() + rank_[channel]) * 4 + firing % 4;
  }

  /// The shots of firings 32 * block to 32 * block + 31.
  void aim(std::uint64_t block, Shots& shots) const;

 private:
  struct ChannelTable {
    float cos_elevation, sin_elevation;
    float cos_azimuth, sin_azimuth;  // of the laser, turned on during the delay
    float cos_encoder, sin_encoder;  // of the rotation during the delay
    float height;
    float azimuth;  // in [0, 2 pi)
    double delay;
    Eigen::Vector3d beam;  // before the prisms
  };

  void aim_spinning(std::uint64_t first_firing, Shots& shots, std::size_t first_slot) const;
  void aim_rosette(double time, std::uint32_t firing, Shots& shots) const;

  LidarConfig config_;
  std::vector<ChannelTable> channels_;
  std::vector<std::size_t> rank_;             // of each channel by elevation
  std::vector<std::size_t> channel_of_rank_;  // the inverse
};

/// A beam of direction `beam` (unit, about along x) after the turning prisms at `time`: Snell's law
/// at each face, no small-angle formula. Unit.
Eigen::Vector3d refract(const std::vector<WedgePrism>& prisms, double time, Eigen::Vector3d beam);

}  // namespace skycap::sim
