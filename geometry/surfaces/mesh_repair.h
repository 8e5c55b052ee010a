/// Repair of meshes from external sources.
#pragma once

#include "geometry/surfaces/mesh.h"

namespace skycap::geometry {

/// Merges vertices with identical coordinates, keeps the first of them, and removes unused
/// vertices. The order of the remaining vertices is kept.
void weld_vertices(Mesh& mesh);

/// Removes triangles without area, which have coincident or collinear corners.
void drop_degenerate_triangles(Mesh& mesh);

/// Orients triangles consistently within each connected part and lets the part face outward. Parts
/// are connected through edges of exactly two triangles. Vertices must be welded first, because
/// parts are connected only at shared vertices.
///
/// A closed part faces outward if its volume is positive, even inside another part. An open part
/// faces outward if most of its surface faces away from its centroid. A one-sided part (Moebius
/// strip) cannot be oriented consistently and remains partially oriented.
void orient_outward(Mesh& mesh);

}  // namespace skycap::geometry
