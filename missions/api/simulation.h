/// Simulated world of `skycap plan` for custom survey loops: a mission's scene and the sensor that
/// measures it.
#pragma once

#include <cstdint>
#include <memory>

#include "geometry/points/scan.h"
#include "geometry/pose/pose.h"
#include "missions/api/mission.h"

namespace skycap::missions::api {

/// Immutable after construction; may be used concurrently.
class Simulation {
 public:
  /// Loads the scene. Throws Error{bad_file} or Error{bad_geometry} if the mission has no model, or
  /// an unusable one.
  explicit Simulation(const Mission& mission);
  ~Simulation();

  /// Returns the first view of `skycap plan`. Throws Error{bad_config} if no position is within the
  /// mission's limits.
  geometry::View first_view() const;

  /// Returns the mission sensor's measurement from `view`, including noise. The noise depends only
  /// on the mission's seed and on `frame`, which a survey counts from 0.
  geometry::Scan scan(const geometry::View& view, std::uint64_t frame) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace skycap::missions::api

namespace skycap::missions {
namespace library = api;  ///< public name for user programs
}
