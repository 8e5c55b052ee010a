/// Several views planned ahead that complement each other, and which of them to fly to first.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "survey/skycap/view_gain.h"

namespace skycap::survey::skycap {

/// A view that a batch may take: where it is, and the targets in its sight.
struct BatchView {
  Eigen::Vector3d position;
  std::vector<Sight> sights;
};

struct BatchSettings {
  std::size_t size = 5;      ///< views in a batch at most; above 6 the tours are too many
  double view_price = 4.0;   ///< what a view costs besides the way to it, in metres of way
  double least_share = 0.5;  ///< of the first view's gain, for another one to join it
  double impatience = 0.15;  ///< weight of early gain against the length of a tour
};

struct Stop {
  std::size_t view;  ///< index into the views
  double gain;       ///< given the stops picked before it
};

/// Greedy cover: each pick is the view that adds most, per metre of its price and of the way from
/// the nearest place already on the list (at first `position`), to what the picks before it leave
/// uncovered of the targets' `weights`. Of equals, the earlier view.
std::vector<Stop> pick_batch(std::span<const BatchView> views, std::vector<float> weights,
                             const Eigen::Vector3d& position, const BatchSettings& settings);

/// Index into `batch`, which is not empty, of the first stop of its best open tour from `position`:
/// the one with the least length plus `impatience` times the mean way to the stops, weighted by
/// their gains. Tries every order.
std::size_t first_stop(std::span<const BatchView> views, std::span<const Stop> batch,
                       const Eigen::Vector3d& position, double impatience);

}  // namespace skycap::survey::skycap
