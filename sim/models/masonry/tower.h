/// Combines walls and profiles of revolution into one closed solid.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/surfaces/mesh.h"
#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

/// Surface around the z axis that is open at the bottom and the top.
struct Band {
  geometry::Mesh mesh;
  std::vector<std::uint32_t> bottom, top;  ///< Boundary edges, counter-clockwise from above.
};

/// Closed solid around the z axis, built from the bottom up.
class Tower {
 public:
  /// Starts with a point on the axis, the centre of the floor.
  explicit Tower(double bottom);
  /// Adds a profile of revolution (radius, height) or a band. A flat ring or disc connects it to
  /// the part below.
  Tower& add(const Polyline2& profile, int chords);
  Tower& add(const Band& band);
  /// Ends with a point on the axis and returns the solid.
  geometry::Mesh close(double top);

 private:
  void join_to(const std::vector<std::uint32_t>& next);

  geometry::Mesh mesh_;
  std::vector<std::uint32_t> rim_;  // Open upper edge. Empty while there is only the floor.
};

}  // namespace skycap::sim::models
