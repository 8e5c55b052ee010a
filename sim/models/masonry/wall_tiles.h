/// Polygons on a wall's developed face: sides shared with neighbours, and stones reduced by their
/// joints.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "sim/models/masonry/wall.h"

namespace skycap::sim::models {

inline constexpr double same_corner = 1e-6;  ///< Distance below which corners are identical [m].

/// Inserts the corners of tiles and openings that lie on a neighbour's side into that side, so that
/// neighbours share complete sides.
class SideSplitter {
 public:
  explicit SideSplitter(const Wall& wall);

  Polyline2 split(const Polyline2& tile) const;

 private:
  using Cell = std::array<std::int64_t, 2>;
  static Cell cell_at(const Eigen::Vector2d& position);

  /// Returns the known corners between a and b, in that order.
  Polyline2 corners_within(const Eigen::Vector2d& a, const Eigen::Vector2d& b) const;

  std::map<Cell, Polyline2> cells_;
};

/// Returns the polygon with each side moved inwards by its own distance. Corners within a straight
/// side keep their relative position, so that they remain between its ends. At the tip of a narrow
/// stone, the blunter end of a side that would be reversed keeps its relative position, too.
Polyline2 inset(const Polyline2& polygon, const std::vector<double>& distances);

}  // namespace skycap::sim::models
