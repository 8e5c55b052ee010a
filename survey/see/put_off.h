/// The frontiers that no proposed view sees, kept until nothing else is left to look at.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "survey/see/frontier.h"

namespace skycap::survey::see {

/// Of SEE++ in the preset `building`: the published method gives these frontiers up.
class PutOffFrontiers {
 public:
  /// Of frontiers nearer to each other than `spacing` one stands for the others.
  explicit PutOffFrontiers(double spacing) : spacing_(spacing) {}

  void add(FrontierMap::node_type frontier) { frontiers_.insert(std::move(frontier)); }
  std::size_t size() const { return frontiers_.size(); }
  void forget(std::uint32_t point) { frontiers_.erase(point); }
  /// Forgets those that the frontier at `place` stands for, and says which they were.
  std::vector<std::uint32_t> forget_around(const Eigen::Vector3d& place);

  /// Moves frontiers `spacing` apart to `to`, each with a view along the line that it was seen on.
  void take_up_again(const ViewPlacement& placement, FrontierMap& to);

 private:
  double spacing_;
  FrontierMap frontiers_;
};

}  // namespace skycap::survey::see
