#include "sim/models/masonry/tree.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace skycap::sim::models {

using std::numbers::pi;

Parts tree(double height, RandomNumbers& draw, const Fineness& fineness) {
  const double trunk = 0.022 * height, crown_foot = 0.28 * height;
  Parts parts;
  parts.push_back({"tree trunk", revolve({{0.0, 0.0},
                                          {1.5 * trunk, 0.0},
                                          {trunk, 0.06 * height},
                                          {0.7 * trunk, 0.6 * height},
                                          {0.0, 0.6 * height}},
                                         std::max(6, fineness.circle(trunk)))});
  // Crown: an ovoid with randomly displaced and scaled rings.
  constexpr int rings = 7, sides = 10;
  std::vector<Polyline3> sections;
  for (int i = 0; i <= rings; ++i) {
    const double share = 0.04 + 0.92 * i / rings, z = crown_foot + share * (height - crown_foot);
    const double wide = 0.30 * height * std::sqrt(std::sin(pi * std::pow(share, 0.8)));
    const double dx = draw.between(-0.02, 0.02) * height, dy = draw.between(-0.02, 0.02) * height;
    Polyline3& ring = sections.emplace_back();
    for (int j = 0; j < sides; ++j) {
      const double angle = 2.0 * pi * j / sides, r = wide * draw.between(0.82, 1.12);
      ring.emplace_back(dx + r * std::cos(angle), dy + r * std::sin(angle), z);
    }
  }
  parts.push_back({"tree crown", loft(sections)});
  return parts;
}

}  // namespace skycap::sim::models
