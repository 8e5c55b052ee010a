/// Stacks walls and turned profiles into one closed solid.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/surfaces/mesh.h"
#include "sim/models/masonry/solids.h"

namespace skycap::sim::models {

/// A surface round the z axis that is open at the bottom and at the top.
struct Band {
  geometry::Mesh mesh;
  std::vector<std::uint32_t> bottom, top;  ///< its two edges, counter-clockwise from above
};

/// One closed solid about the z axis, made from the bottom up.
class Tower {
 public:
  /// Starts with a point on the axis, the middle of the floor.
  explicit Tower(double bottom);
  /// Goes on with a turned profile (radius, height). A flat ring or disc joins it to what is below.
  Tower& add(const Polyline2& profile, int chords);
  Tower& add(const Band& band);
  /// Ends with a point on the axis.
  geometry::Mesh close(double top);

 private:
  void join_to(const std::vector<std::uint32_t>& next);

  geometry::Mesh mesh_;
  std::vector<std::uint32_t> rim_;  // the open upper edge; empty while there is only the floor
};

}  // namespace skycap::sim::models
