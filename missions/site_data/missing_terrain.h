/// Assumed ground where terrain files have none: between tiles, next to rotated tiles, in holes,
/// and outside all tiles. Missing data does not imply missing ground.
#pragma once

#include <string>
#include <vector>

#include "flight/clearance/prior_obstacle.h"

namespace skycap::missions::site_data {

/// Ground model for unknown areas. A gap that is enclosed by known ground gets the maximum height
/// of the adjacent ground. All other areas are a horizontal plane at a given height. Gaps are
/// detected on a lattice with a spacing of 0.25 m or, if larger, 1/2000 of the longer side of the
/// terrain. Narrower gaps are ignored.
class UnknownGround {
 public:
  /// `terrain` contains the known surfaces and columns, with a non-zero total area.
  UnknownGround(const std::vector<flight::PriorObstacleConfig>& terrain, double plane_z);

  /// Returns the assumed ground height at a position [m]. Where the ground is known, returns the
  /// height of the plane.
  double height(const Eigen::Vector2d& position) const;

  /// Returns the assumed ground as an obstacle with the maximum uncertainty of the terrain.
  const flight::PriorObstacleConfig& obstacle() const { return obstacle_; }

  /// Returns a one-sentence description for the user.
  const std::string& note() const { return note_; }

 private:
  double plane_z_;
  flight::PriorObstacleConfig obstacle_;
  std::string note_;
};

}  // namespace skycap::missions::site_data
