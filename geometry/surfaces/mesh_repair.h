/// What meshes from the field need before they can be worked with.
#pragma once

#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

/// Joins vertices of exactly equal coordinates, keeping the first, and drops those that no triangle
/// uses. The order of the rest stays.
void weld_vertices(Mesh& mesh);

/// Drops triangles without area: corners that coincide or lie on one line.
void drop_degenerate_triangles(Mesh& mesh);

/// Turns triangles so that those of each connected part (joined through edges of two triangles)
/// agree, and that the part faces outward. Outward is away from the inside of a closed part
/// (positive volume), and on an open one, where the surface mostly faces away from its own
/// centroid. A closed part inside another one faces outward too. Weld before: parts join at shared
/// vertices only. A one-sided part (a Moebius strip) cannot agree with itself and is left in
/// partial agreement.
void orient_outward(Mesh& mesh);

}  // namespace skycap::geometry
