/// Batches of complementary views planned ahead, and the order of flying them.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "survey/surfel/view_gain.h"

namespace skycap::survey::surfel {

/// Candidate view of a batch: position and targets in sight.
struct BatchView {
  Eigen::Vector3d position;
  std::vector<VisibleTarget> visible_targets;
};

struct BatchSettings {
  std::size_t size = 5;     ///< maximum number of views; above 6 there are too many tours
  double view_price = 4.0;  ///< fixed cost of a view, in metres of path
  double min_fraction =
      0.5;  ///< minimum gain of further views, as a fraction of the first view's gain
  double impatience = 0.15;  ///< weight of early gain relative to tour length
};

struct Stop {
  std::size_t view;  ///< index of the view
  double gain;       ///< gain in addition to the previously picked stops
};

/// Selects views greedily. Each pick maximises the additional coverage of the targets' `weights`
/// per cost. The cost is the price of the view plus the path from the nearest position in the list,
/// which initially contains only `position`. Ties are resolved by the order of the views.
std::vector<Stop> pick_batch(std::span<const BatchView> views, std::vector<float> weights,
                             const Eigen::Vector3d& position, const BatchSettings& settings);

/// Returns the index in `batch` (not empty) of the first stop of the best open tour from
/// `position`. The best tour minimises its length plus `impatience` times the gain-weighted mean
/// path to the stops. Evaluates all permutations.
std::size_t first_stop(std::span<const BatchView> views, std::span<const Stop> batch,
                       const Eigen::Vector3d& position, double impatience);

}  // namespace skycap::survey::surfel
