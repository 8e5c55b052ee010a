/// Pulse directions of a laser scanner per firing, in its own frame.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "sim/sensors/sensor.h"

namespace skycap::sim {

/// Pulses of 32 consecutive firings. Slots are in the order of ray packets: four firings of a
/// channel, then the same four of the channel next in elevation.
struct Pulses {
  std::vector<float> origin[3];          ///< Sensor frame [m].
  std::vector<float> direction[3];       ///< Unit vectors, sensor frame.
  std::vector<float> azimuth;            ///< In (-pi, pi] [rad].
  std::vector<std::uint8_t> is_emitted;  ///< 0 outside the field of view.
};

class ScanPattern {
 public:
  static constexpr std::uint32_t firings_in_block = 32;

  /// `config` must be valid.
  explicit ScanPattern(const LidarConfig& config);

  std::size_t slots() const { return firings_in_block * channels_.size(); }

  /// Returns the slot of a channel's pulse. `firing` is counted within the block.
  std::size_t slot(std::uint32_t firing, std::size_t channel) const {
    return ((firing / 4) * channels_.size() + rank_[channel]) * 4 + firing % 4;
  }

  /// Computes the pulses of firings 32 * block to 32 * block + 31.
  void aim(std::uint64_t block, Pulses& pulses) const;

 private:
  struct ChannelTable {
    float cos_elevation, sin_elevation;
    float cos_azimuth, sin_azimuth;  // Laser azimuth, including the rotation during the delay.
    float cos_encoder, sin_encoder;  // Rotation during the delay.
    float height;
    float azimuth;  // In [0, 2 pi) [rad].
    double delay;
    Eigen::Vector3d beam;  // Direction before the prisms.
  };

  void aim_spinning(std::uint64_t first_firing, Pulses& pulses, std::size_t first_slot) const;
  void aim_rosette(double time, std::uint32_t firing, Pulses& pulses) const;

  LidarConfig config_;
  std::vector<ChannelTable> channels_;
  std::vector<std::size_t> rank_;           // Rank of each channel by elevation.
  std::vector<std::size_t> rank_channels_;  // Inverse of `rank_`.
};

/// Returns the direction of a beam after the rotating prisms at `time` [s], as a unit vector.
/// `beam` is a unit vector approximately along x. Applies Snell's law at each face without
/// small-angle approximation.
Eigen::Vector3d refract(const std::vector<WedgePrism>& prisms, double time, Eigen::Vector3d beam);

}  // namespace skycap::sim
