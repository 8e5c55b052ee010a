#include "tests/flight/scenes.h"

#include <numbers>

#include "geometry/pose/pose.h"

namespace skycap::flight::scenes {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using geometry::Mesh;

double uniform(std::mt19937_64& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Returns a grid over the parallelogram at `corner`, with its front along u x v.
Mesh patch(const Vector3d& corner, const Vector3d& u, const Vector3d& v, int cells) {
  Mesh mesh;
  for (int row = 0; row <= cells; ++row) {
    for (int column = 0; column <= cells; ++column) {
      mesh.vertices.push_back(corner + u * column / cells + v * row / cells);
    }
  }
  for (int row = 0; row < cells; ++row) {
    for (int column = 0; column < cells; ++column) {
      const auto a = static_cast<std::uint32_t>(row * (cells + 1) + column);
      const auto above = static_cast<std::uint32_t>(cells + 1);
      mesh.triangles.push_back({a, a + 1, a + 1 + above});
      mesh.triangles.push_back({a, a + 1 + above, a + above});
    }
  }
  return mesh;
}

Mesh tube(const Vector3d& from, const Vector3d& to, double thickness) {
  const Vector3d axis = (to - from).normalized();
  const Vector3d side = geometry::any_orthogonal(axis), other = axis.cross(side);
  Mesh mesh;
  for (const Vector3d& end : {from, to}) {
    for (int i = 0; i < 3; ++i) {
      const double angle = i * 2.0 * std::numbers::pi / 3.0;
      mesh.vertices.push_back(end +
                              0.5 * thickness * (std::cos(angle) * side + std::sin(angle) * other));
    }
  }
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint32_t next = (i + 1) % 3;
    mesh.triangles.push_back({i, next, next + 3});
    mesh.triangles.push_back({i, next + 3, i + 3});
  }
  mesh.triangles.push_back({0, 2, 1});
  mesh.triangles.push_back({3, 4, 5});
  return mesh;
}

}  // namespace

Mesh box(const Vector3d& low, const Vector3d& high, int cells) {
  const Vector3d x(high.x() - low.x(), 0, 0), y(0, high.y() - low.y(), 0),
      z(0, 0, high.z() - low.z());
  Mesh mesh = patch(low, y, x, cells);
  geometry::append(mesh, patch(low, x, z, cells));
  geometry::append(mesh, patch(low, z, y, cells));
  geometry::append(mesh, patch(low + z, x, y, cells));
  geometry::append(mesh, patch(low + y, z, x, cells));
  geometry::append(mesh, patch(low + x, y, z, cells));
  return mesh;
}

Mesh boxes(std::mt19937_64& random, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vector3d low = point_in(random, {Vector3d::Zero(), Vector3d::Constant(50)});
    geometry::append(
        mesh, box(low, low + point_in(random, {Vector3d::Constant(1), Vector3d::Constant(10)})));
  }
  return mesh;
}

Mesh poles(std::mt19937_64& random, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    Vector3d low = point_in(random, {Vector3d::Zero(), Vector3d::Constant(60)});
    low.z() = 0.0;
    const double width = uniform(random, 0.05, 0.2);
    geometry::append(mesh, box(low, low + Vector3d(width, width, uniform(random, 10.0, 40.0))));
  }
  return mesh;
}

Mesh wires(std::mt19937_64& random, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vector3d from = point_in(random, {Vector3d::Zero(), Vector3d::Constant(60)});
    const Vector3d direction =
        point_in(random, {Vector3d::Constant(-1), Vector3d::Constant(1)}).normalized();
    geometry::append(mesh, tube(from, from + uniform(random, 20.0, 60.0) * direction, 0.02));
  }
  return mesh;
}

Mesh city(int cells) {
  Mesh mesh;
  for (int row = 0; row < 10; ++row) {
    for (int column = 0; column < 10; ++column) {
      const Vector3d low(10.0 * column + 2.0, 10.0 * row + 2.0, 0.0);
      const double height = 8.0 + (7 * row + 3 * column) % 11;
      geometry::append(mesh, box(low, low + Vector3d(6.0, 6.0, height), cells));
    }
  }
  return mesh;
}

Obstacles wall_with_window() {
  Obstacles obstacles;
  geometry::Mesh& mesh = obstacles.mesh;
  geometry::append(mesh, box({-30, 0, 0}, {-3, 1, 40}));
  geometry::append(mesh, box({3, 0, 0}, {30, 1, 40}));
  geometry::append(mesh, box({-3, 0, 0}, {3, 1, 17}));
  geometry::append(mesh, box({-3, 0, 23}, {3, 1, 40}));
  obstacles.fence = Prism{"yard", {{-30, -15}, {30, -15}, {30, 16}, {-30, 16}}, 0.0, 40.0};
  return obstacles;
}

std::vector<Segment> legs(std::mt19937_64& random, std::size_t count, const AlignedBox3d& within) {
  std::vector<Segment> legs;
  while (legs.size() < count) {
    const Segment leg{point_in(random, within), point_in(random, within)};
    if (leg.length() >= 5.0 && leg.length() <= 30.0) legs.push_back(leg);
  }
  return legs;
}

Vector3d point_in(std::mt19937_64& random, const AlignedBox3d& box) {
  Vector3d point;
  for (int axis = 0; axis < 3; ++axis) {
    point[axis] = uniform(random, box.min()[axis], box.max()[axis]);
  }
  return point;
}

}  // namespace skycap::flight::scenes
