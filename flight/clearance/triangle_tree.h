/// Triangles with a search tree, for the triangle closest to a segment.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "flight/clearance/bounding_tree.h"
#include "flight/clearance/segment_distance.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::flight {

struct TriangleTree {
  std::vector<Triangle> triangles;
  BoundingTree tree;

  /// Builds the tree. Must be called after the triangles are set and before any query.
  void index();

  /// Calls `found(triangle, nearest points)` for triangles within `reach` [m], each closer than the
  /// previous one. `reach` becomes the distance of the last one, or -1 on contact.
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

std::vector<Triangle> to_triangles(const geometry::Mesh& mesh);

}  // namespace skycap::flight
