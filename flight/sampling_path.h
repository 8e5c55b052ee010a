/// A second engine for paths: OMPL's informed trees, for narrow places that a grid would have to be
/// very fine for, and to cross-check the first engine.
#pragma once

#include <cstddef>
#include <cstdint>

#include "flight/path.h"

namespace skycap::flight {

enum class SamplingPlanner { bit_star, ait_star };

struct SamplingOptions {
  SamplingPlanner planner = SamplingPlanner::bit_star;
  /// Legs and places checked at most: the effort, in place of a time limit, which no result may
  /// depend on.
  std::size_t max_checks = 4000;
  double worthwhile_saving = 0.004;  ///< as in PathOptions
};

/// A path by sampling (Gammell et al., BIT*, ICRA 2015; Strub & Gammell, AIT*, ICRA 2020), pulled
/// tight; its pieces are free at the clearance like PathFinder's. Never proves that there is no
/// path: `unreachable` means that none was found. OMPL seeds its generators once a process: the
/// first call is repeatable, later ones in the same order too. Throws what PathFinder's constructor
/// throws.
Path find_path_by_sampling(const FreeSpace& space, const Eigen::Vector3d& from,
                           const Eigen::Vector3d& to, double clearance,
                           const SamplingOptions& options = {});

}  // namespace skycap::flight
