/// Bounding volume hierarchy of the triangles of a mesh, for nearest-triangle queries.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "geometry/surfaces/facet_layout.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

struct FacetTree {
  std::vector<Facet> facets;     ///< in tree order
  std::vector<FacetNode> nodes;  ///< root first
};

/// Builds the tree. Triangles without area are skipped. The result does not depend on `threads`.
FacetTree facet_tree(const Mesh& mesh, unsigned threads);

/// Returns the point of the facet that is nearest to `point`.
Eigen::Vector3d nearest_on(const Facet& facet, const Eigen::Vector3d& point);

}  // namespace skycap::geometry
