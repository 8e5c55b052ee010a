/// What stands for the world in `skycap plan`: a mission's scene and the sensor that measures it,
/// for survey loops of one's own.
#pragma once

#include <cstdint>
#include <memory>

#include "geometry/place/pose.h"
#include "geometry/points/scan.h"
#include "missions/api/mission.h"

namespace skycap::missions::api {

/// Immutable; safe to use from any number of threads.
class Simulation {
 public:
  /// Makes the scene ready. Throws Error{bad_file} or Error{bad_geometry} if the mission has no
  /// model, or none that can be measured.
  explicit Simulation(const Mission& mission);
  ~Simulation();

  /// Where `skycap plan` begins. Throws Error{bad_config} if the mission's limits leave no place.
  geometry::View first_view() const;

  /// What the mission's sensor measures from `view`, with its noise; with the mission's seed,
  /// `frame` alone decides the noise. A survey counts its frames from 0.
  geometry::Scan scan(const geometry::View& view, std::uint64_t frame) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace skycap::missions::api

namespace skycap::missions {
namespace library = api;  ///< the name in programs of users
}
