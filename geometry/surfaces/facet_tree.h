/// The triangles of a mesh in a tree of boxes, for searches of the nearest.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/facet_layout.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

struct FacetTree {
  std::vector<Facet> facets;     ///< in the order of the tree
  std::vector<FacetNode> nodes;  ///< the first one is the root
};

/// Triangles without area are passed over. The tree does not depend on `threads`.
FacetTree facet_tree(const Mesh& mesh, unsigned threads);

/// The facet's point nearest to `point`.
Eigen::Vector3d nearest_on(const Facet& facet, const Eigen::Vector3d& point);

}  // namespace skycap::geometry
