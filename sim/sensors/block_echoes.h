/// Echoes of a block of laser pulses. Internal to lidar.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/scene/scene.h"
#include "sim/sensors/echo.h"
#include "sim/sensors/lidar_rays.h"
#include "sim/sensors/sensor.h"

namespace skycap::sim {

/// The n-th echo of every pulse, indexed by slot.
struct EchoRow {
  std::vector<float> range, cosine, intensity;
  std::vector<std::uint32_t> triangle;

  void resize(std::size_t slots);
};

/// Echo computation that reuses its memory from block to block.
class BlockEchoes {
 public:
  std::vector<EchoRow> rows;  ///< One row per possible echo of a pulse. The caller resizes it.
  std::vector<int> counts;    ///< Number of echoes per slot.

  /// Computes echoes for beams without width: each ray is one echo. Moves the arrays out of `hits`.
  void find_ray_echoes(Hits& hits, const Scene& scene, const LidarConfig& config);

  /// Computes echoes for beams with width. The rays of a slot are consecutive, in the order of
  /// `beam`.
  void find_beam_echoes(const Hits& hits, std::span<const BeamSample> beam, const Scene& scene,
                        const LidarConfig& config);

 private:
  std::vector<RayHit> beam_hits_;
  std::vector<Echo> echoes_;
};

}  // namespace skycap::sim
