/// The echoes of a block of shots. For the source of lidar.h.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/scene/scene.h"
#include "sim/sensors/echo.h"
#include "sim/sensors/lidar_rays.h"
#include "sim/sensors/sensor.h"

namespace skycap::sim {

/// The n-th echo of every shot, slot by slot.
struct EchoRow {
  std::vector<float> range, cosine, intensity;
  std::vector<std::uint32_t> triangle;

  void resize(std::size_t slots);
};

/// Keeps its memory from block to block.
class BlockEchoes {
 public:
  std::vector<EchoRow> rows;  ///< as many as a shot may have echoes; the caller's to resize
  std::vector<int> counts;    ///< of the echoes in each slot

  /// Of beams without a width: a ray is its echo. Takes the arrays of `hits`.
  void find_of_rays(Hits& hits, const Scene& scene, const LidarConfig& config);

  /// Of beams with a width: the rays of a slot follow each other, in the order of `beam`.
  void find_of_beams(const Hits& hits, std::span<const BeamSample> beam, const Scene& scene,
                     const LidarConfig& config);

 private:
  std::vector<RayHit> beam_hits_;
  std::vector<Echo> echoes_;
};

}  // namespace skycap::sim
