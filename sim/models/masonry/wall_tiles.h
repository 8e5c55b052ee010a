/// Polygons on a wall's developed face: sides shared with neighbours, and stones shrunk by their
/// joints.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "sim/models/masonry/wall.h"

namespace skycap::sim::models {

inline constexpr double same_corner = 1e-6;  ///< corners closer than this are one [m]

/// Puts the corners of tiles and openings that lie within a neighbour's side into that side, so
/// that neighbours share whole sides.
class SideSplitter {
 public:
  explicit SideSplitter(const Wall& wall);

  Polyline2 split(const Polyline2& tile) const;

 private:
  using Cell = std::array<std::int64_t, 2>;
  static Cell cell_of(const Eigen::Vector2d& place);

  /// The known corners between a and b, in that order.
  Polyline2 corners_within(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;

  std::map<Cell, Polyline2> cells_;
};

/// The polygon with each side moved inwards by its own distance. Corners within a straight side
/// keep their share of its length, so that they stay between its ends however short it gets. So
/// does the blunter end of a side that would be turned round, beside the tip of a narrow stone.
Polyline2 inset(const Polyline2& polygon, const std::vector<double>& distances);

}  // namespace skycap::sim::models
