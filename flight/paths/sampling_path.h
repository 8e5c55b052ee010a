/// A second engine for paths: OMPL's informed trees, for narrow places that a grid would have to be
/// very fine for, and to cross-check the first engine.
#pragma once

#include <cstddef>
#include <cstdint>

#include "flight/paths/path.h"

namespace skycap::flight {

enum class SamplingPlanner { bit_star, ait_star };

struct SamplingOptions {
  SamplingPlanner planner = SamplingPlanner::bit_star;
  /// Legs and places checked at most: the effort, in place of a time limit, which no result may
  /// depend on.
  std::size_t max_checks = 4000;
  /// The same while there is no path yet: narrow places take luck, which more samples bring.
  std::size_t max_checks_for_first_path = 40000;
  std::uint32_t seed = 1;            ///< of the samples; not zero
  double worthwhile_saving = 0.004;  ///< as in PathOptions
};

/// A path by sampling (Gammell et al., BIT*, ICRA 2015; Strub & Gammell, AIT*, ICRA 2020), pulled
/// tight; its pieces are free at the clearance like PathFinder's. Never proves that there is no
/// path: `unreachable` means that none was found. Repeatable: the
/// result depends on the arguments alone. Calls from several threads take turns, because OMPL's
/// source of seeds is one for the process. Throws what PathFinder's constructor throws, and
/// Error{bad_config} for a seed of zero.
Path find_path_by_sampling(const FreeSpace& space, const Eigen::Vector3d& from,
                           const Eigen::Vector3d& to, double clearance,
                           const SamplingOptions& options = {});

}  // namespace skycap::flight
