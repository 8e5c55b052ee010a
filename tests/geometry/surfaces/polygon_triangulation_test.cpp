#include "geometry/surfaces/polygon_triangulation.h"

#include <limits>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/not_empty.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;

struct Polygon {
  std::vector<Vector3d> corners;
  std::vector<std::uint32_t> begin{0};

  Polygon& ring(const std::vector<Vector3d>& more) {
    corners.insert(corners.end(), more.begin(), more.end());
    begin.push_back(static_cast<std::uint32_t>(corners.size()));
    return *this;
  }
  Mesh mesh() const {
    Mesh result;
    const std::size_t added = add_polygon(result, corners, begin);
    EXPECT_EQ(added, result.triangles.size());
    return result;
  }
};

std::vector<Vector3d> square(double low, double high) {
  return {{low, low, 0}, {high, low, 0}, {high, high, 0}, {low, high, 0}};
}

double area(const Mesh& mesh) { return mesh.triangles.empty() ? 0.0 : surface_area(mesh); }

TEST(PolygonTriangulation, CutsHolesOfBothOrientations) {
  std::vector<Vector3d> hole = square(2, 4);
  EXPECT_DOUBLE_EQ(area(Polygon().ring(square(0, 10)).ring(hole).mesh()), 96.0);
  std::reverse(hole.begin(), hole.end());
  EXPECT_DOUBLE_EQ(area(Polygon().ring(square(0, 10)).ring(hole).mesh()), 96.0);
}

TEST(PolygonTriangulation, FillsAreasInsideOddNumberOfRings) {
  EXPECT_DOUBLE_EQ(area(Polygon().ring(square(0, 10)).ring(square(1, 9)).ring(square(2, 8)).mesh()),
                   100.0 - 64.0 + 36.0);
  // A hole that shares two edges with the outline leaves an L shape.
  EXPECT_DOUBLE_EQ(area(Polygon().ring(square(0, 10)).ring(square(0, 5)).mesh()), 75.0);
}

TEST(PolygonTriangulation, KeepsOrientationOfOutlineOnAnyPlane) {
  const Vector3d right(0.0, 0.6, 0.8), up(1.0, 0.0, 0.0), shift(1e6, -2e6, 300.0);
  std::vector<Vector3d> outline;
  for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(9, 0, 0), Vector3d(9, 9, 0),
                            Vector3d(5, 9, 0), Vector3d(5, 4, 0), Vector3d(0, 4, 0)}) {
    outline.push_back(shift + p.x() * right + p.y() * up);
  }
  const Mesh mesh = Polygon().ring(outline).mesh();
  EXPECT_NEAR(area(mesh), 9.0 * 9.0 - 5.0 * 5.0, 1e-6);
  for (const auto& t : testing_support::not_empty(mesh.triangles)) {
    const Vector3d normal = (mesh.vertices[t[1]] - mesh.vertices[t[0]])
                                .cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
    EXPECT_GT(normal.dot(right.cross(up)), 0.0);
  }
}

TEST(PolygonTriangulation, AcceptsClosedTouchingAndCrossingRings) {
  std::vector<Vector3d> closed = square(0, 3);
  closed.push_back(closed[0]);
  EXPECT_DOUBLE_EQ(area(Polygon().ring(closed).mesh()), 9.0);
  // Bow tie: two triangles of different size that meet where the sides cross.
  const Mesh bow = Polygon().ring({{0, 0, 0}, {6, 4, 0}, {6, 0, 0}, {0, 2, 0}}).mesh();
  EXPECT_NEAR(area(bow), 0.5 * 2.0 * 2.0 + 0.5 * 4.0 * 4.0, 1e-9);
}

TEST(PolygonTriangulation, AddsNoTrianglesForRingsWithoutArea) {
  EXPECT_EQ(area(Polygon().ring({{0, 0, 0}, {1, 1, 1}}).mesh()), 0.0);
  EXPECT_EQ(area(Polygon().ring({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}).mesh()), 0.0);
  EXPECT_EQ(area(Polygon().mesh()), 0.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(area(Polygon().ring({{0, 0, 0}, {1, 0, 0}, {0, nan, 0}}).mesh()), 0.0);
}

/// The area of a star-shaped polygon is compared with the shoelace formula.
TEST(PolygonTriangulation, KeepsAreaOfRandomStars) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> radius(1.0, 5.0);
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<Vector3d> star;
    double shoelace = 0.0;
    const int corners = 5 + trial;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2.0 * M_PI * i / corners, r = radius(random);
      star.emplace_back(r * std::cos(angle), r * std::sin(angle), 0.0);
    }
    for (std::size_t i = 0; i < star.size(); ++i) {
      const Vector3d &a = star[i], &b = star[(i + 1) % star.size()];
      shoelace += 0.5 * (a.x() * b.y() - b.x() * a.y());
    }
    EXPECT_NEAR(area(Polygon().ring(star).mesh()), shoelace, 1e-9);
  }
}

}  // namespace
}  // namespace skycap::geometry
