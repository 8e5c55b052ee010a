/// What counts as the ground where files of terrain have none: between tiles, beside a tile that is
/// turned against the site, in holes, and beyond all of them. That a file has no ground there does
/// not say that there is none.
#pragma once

#include <string>
#include <vector>

#include "flight/space/prior_obstacle.h"

namespace skycap::missions::site_data {

/// A gap that known ground surrounds is as high as the highest ground beside it; everything else is
/// the plane at a given height. Gaps are looked for on a lattice of a quarter of a metre, or of a
/// two-thousandth of the terrain's longer side if that is more: narrower ones count for nothing.
class UnknownGround {
 public:
  /// `terrain` is what is known, its surfaces and columns; at least one of them has some area.
  UnknownGround(const std::vector<flight::PriorObstacleConfig>& terrain, double plane_z);

  /// z of it at a place; where the ground is known, of the plane.
  double height(const Eigen::Vector2d& place) const;

  /// As uncertain as the most uncertain terrain.
  const flight::PriorObstacleConfig& obstacle() const { return obstacle_; }

  /// In one sentence for the user.
  const std::string& note() const { return note_; }

 private:
  double plane_z_;
  flight::PriorObstacleConfig obstacle_;
  std::string note_;
};

}  // namespace skycap::missions::site_data
