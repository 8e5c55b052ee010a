/// Scenes for the tests and benchmarks of flight/: simple shapes with known clearances.
#pragma once

#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "flight/clearance/obstacles.h"
#include "flight/clearance/segment_distance.h"
#include "geometry/surfaces/mesh.h"

namespace skycap::flight::scenes {

/// Returns a closed box, oriented outward. Each face has `cells` x `cells` squares of two
/// triangles.
geometry::Mesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int cells = 1);

/// Returns random boxes in a cube of 60 m.
geometry::Mesh boxes(std::mt19937_64& random, int count);

/// Returns thin vertical poles, 5 to 20 cm thick and 10 to 40 m high.
geometry::Mesh poles(std::mt19937_64& random, int count);

/// Returns wires in random directions: straight tubes with a triangular section, 2 cm thick and 20
/// to 60 m long.
geometry::Mesh wires(std::mt19937_64& random, int count);

/// Returns 10 x 10 buildings on a street grid of 100 x 100 m, with 1,200 cells^2 triangles. For
/// `cells` see box().
geometry::Mesh city(int cells);

/// Returns a wall of 60 x 40 m with a window of 6 x 6 m. At 2 m clearance the free opening is 2 x 2
/// m. Within the fence it is the only connection to the other side.
Obstacles wall_with_window();

/// Returns random legs, 5 to 30 m long, with both ends in the box.
std::vector<Segment> legs(std::mt19937_64& random, std::size_t count,
                          const Eigen::AlignedBox3d& within);

/// Returns a random point in a box.
Eigen::Vector3d point_in(std::mt19937_64& random, const Eigen::AlignedBox3d& box);

}  // namespace skycap::flight::scenes
