/// Newell's teapot (University of Utah, 1975), tessellated from its 32 bicubic Bezier patches.
#pragma once

#include "geometry/surfaces/mesh.h"

namespace skycap::sim::models {

/// Returns the teapot in Newell's units, z up, spout towards +x: x from -3 to 3.434, y from -2 to
/// 2, z from 0 to 3.15. Each patch becomes `cells` x `cells` pairs of triangles. Equal vertices are
/// merged and degenerate triangles removed, so 16 cells give 8,257 vertices and 16,256 triangles.
///
/// As in Newell's original, the model consists of thin shells and is not closed. Handle and spout
/// enter the body, and the lid lies above the rim without touching it.
///
/// Throws Error{bad_config} unless `cells` is from 1 to 1000.
geometry::Mesh teapot(int cells = 16);

}  // namespace skycap::sim::models
