/// Scenes for the tests and benchmarks of flight/: known shapes with known clearances.
#pragma once

#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/clearance/obstacles.h"
#include "flight/clearance/segment_distance.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::flight::scenes {

/// A closed box, outward; each face is `cells` by `cells` squares of two triangles.
geometry::Mesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int cells = 1);

/// Random boxes in a 60 m cube.
geometry::Mesh boxes(std::mt19937_64& random, int count);

/// Slim upright poles, 5 to 20 cm thick, 10 to 40 m high.
geometry::Mesh poles(std::mt19937_64& random, int count);

/// Wires: straight tubes of triangular section, 2 cm thick, 20 to 60 m long, in any direction.
geometry::Mesh wires(std::mt19937_64& random, int count);

/// 10 x 10 buildings on 100 m x 100 m of street grid; `cells` as in box(): 1,200 cells^2 triangles.
geometry::Mesh city(int cells);

/// A wall of 60 x 40 m with a window of 6 x 6 m: at a clearance of 2 m a hole of 2 x 2 m, and
/// within the fence the only way to the other side.
Obstacles wall_with_window();

/// Random legs, 5 to 30 m long, with both ends in the box.
std::vector<Segment> legs(std::mt19937_64& random, std::size_t count,
                          const Eigen::AlignedBox3d& within);

/// A random point in a box.
Eigen::Vector3d point_in(std::mt19937_64& random, const Eigen::AlignedBox3d& box);

}  // namespace skycap::flight::scenes
