/// Frontiers that no proposed view sees. They are deferred until all other frontiers are resolved.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "survey/see/frontier.h"

namespace skycap::survey::see {

/// Part of SEE++ with the preset `building`. The published method discards these frontiers.
class DeferredFrontiers {
 public:
  /// Frontiers closer to each other than `spacing` [m] are represented by one of them.
  explicit DeferredFrontiers(double spacing) : spacing_(spacing) {}

  void add(FrontierMap::node_type frontier) { frontiers_.insert(std::move(frontier)); }
  std::size_t size() const { return frontiers_.size(); }
  void forget(std::uint32_t point) { frontiers_.erase(point); }
  /// Removes the frontiers represented by the frontier at `position` and returns their points.
  std::vector<std::uint32_t> forget_around(const Eigen::Vector3d& position);

  /// Moves frontiers at least `spacing` apart to `to`. Each gets a view on the line from which it
  /// was measured.
  void requeue(const ViewPlacement& placement, FrontierMap& to);

 private:
  double spacing_;
  FrontierMap frontiers_;
};

}  // namespace skycap::survey::see
