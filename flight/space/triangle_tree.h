/// Triangles with a tree over them: the nearest to a segment, or whether any is near.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "flight/space/bounding_tree.h"
#include "flight/space/segment_distance.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::flight {

struct TriangleTree {
  std::vector<Triangle> triangles;
  BoundingTree tree;

  /// Has to be called when the triangles are there, before anything is asked.
  void index();

  /// Calls `found(triangle, nearest points)` for triangles nearer than `reach`, each nearer than
  /// those before it; `reach` falls to the distance of the last, and to -1 when one is touched.
  template <typename Found>
  void visit_nearer(const Segment& leg, double& reach, Found&& found) const {
    tree.visit_near(leg, reach, [&](std::uint32_t t) {
      if (!may_be_nearer(leg, triangles[t], reach)) return;
      const NearestPoints pair = nearest(leg, triangles[t]);
      if (!(pair.squared_distance < reach * reach)) return;
      reach = std::sqrt(pair.squared_distance);
      found(t, pair);
      if (reach == 0.0) reach = -1.0;
    });
  }
};

std::vector<Triangle> triangles_of(const geometry::Mesh& mesh);

}  // namespace skycap::flight
