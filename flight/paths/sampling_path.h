/// Sampling-based path search with OMPL's informed trees. It finds narrow passages that would need
/// a very fine grid, and serves to cross-check PathFinder.
#pragma once

#include <cstddef>
#include <cstdint>

#include "flight/paths/path.h"

namespace skycap::flight {

enum class SamplingPlanner { bit_star, ait_star };

struct SamplingOptions {
  SamplingPlanner planner = SamplingPlanner::bit_star;
  /// Maximum number of lines and positions to check. Results must not depend on a time limit.
  std::size_t max_checks = 4000;
  /// The limit that applies until a first path is found. Narrow passages need more samples.
  std::size_t max_checks_for_first_path = 40000;
  std::uint32_t seed = 1;            ///< Seed of the samples. Must not be 0.
  double worthwhile_saving = 0.004;  ///< Minimum relative saving, see PathOptions.
};

/// Returns a path found by sampling and pulled tight (Gammell et al., BIT*, ICRA 2015; Strub &
/// Gammell, AIT*, ICRA 2020). Like PathFinder's, its lines are free at the clearance. `unreachable`
/// means that no path was found, not that none exists.
///
/// Repeatable: the result depends only on the arguments. Concurrent calls are serialised, because
/// OMPL has one seed source per process. Throws the same errors as the PathFinder constructor, and
/// Error{bad_config} if the seed is 0.
Path find_path_by_sampling(const FreeSpace& space, const Eigen::Vector3d& from,
                           const Eigen::Vector3d& to, double clearance,
                           const SamplingOptions& options = {});

}  // namespace skycap::flight
