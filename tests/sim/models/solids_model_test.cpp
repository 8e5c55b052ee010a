#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/surfaces/ear_clipping.h"
#include "sim/models/masonry/corinthian.h"
#include "sim/models/masonry/rustication.h"
#include "sim/models/masonry/solids.h"
#include "sim/models/masonry/tower.h"
#include "sim/models/masonry/wall.h"
#include "tests/sim/models/closed_solids.h"
#include "tests/support/not_empty.h"

namespace skycap::sim::models {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::Mesh;
using std::numbers::pi;

TEST(Fineness, KeepsChordErrorWithMinChordCount) {
  for (const double radius : {0.1, 1.0, 14.0}) {
    for (const double error : {1e-4, 1e-3, 1e-2}) {
      const int chords = Fineness{error}.chords(radius, 2 * pi);
      const auto sagitta = [&](int n) { return radius * (1 - std::cos(pi / n)); };
      EXPECT_LE(sagitta(chords), error * (1 + 1e-6));
      EXPECT_GT(sagitta(chords - 1), error);  // the number of chords is the minimum
    }
  }
}

TEST(Profile, KeepsArcRadius) {
  // A quarter turn to the left from (1, 0) to (0, 1) is part of the unit circle.
  const Polyline2 arc = Profile(Fineness{1e-4}, 1, 0).arc_to(0, 1, pi / 2).points();
  EXPECT_GT(arc.size(), 20U);
  for (const Vector2d& point : arc) EXPECT_NEAR(point.norm(), 1.0, 1e-12);
  // To the right it curves the other way, around (1, 1).
  for (const Vector2d& point : Profile(Fineness{1e-4}, 1, 0).arc_to(0, 1, -pi / 2).points()) {
    EXPECT_NEAR((point - Vector2d(1, 1)).norm(), 1.0, 1e-12);
  }
}

double area(const Polyline2& polygon, const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  double sum = 0.0;
  for (const auto& [a, b, c] : triangles) {
    const Vector2d u = polygon[b] - polygon[a], v = polygon[c] - polygon[a];
    const double twice = u.x() * v.y() - u.y() * v.x();
    EXPECT_GT(twice, 0.0);  // counter-clockwise and not degenerate
    sum += 0.5 * twice;
  }
  return sum;
}

double shoelace_area(const Polyline2& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return 0.5 * twice;
}

// Property: n - 2 counter-clockwise triangles whose total area is that of the polygon (shoelace).
TEST(Triangulate, CoversStarsWithCollinearCorners) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> radius(0.3, 1.0);
  for (int round = 0; round < 50; ++round) {
    Polyline2 star;
    for (int i = 0; i < 20; ++i) {
      const double angle = 2 * pi * i / 20;
      star.push_back(radius(random) * Vector2d(std::cos(angle), std::sin(angle)));
    }
    Polyline2 polygon;  // with a third point on each side
    for (std::size_t i = 0; i < star.size(); ++i) {
      const Vector2d &a = star[i], &b = star[(i + 1) % star.size()];
      polygon.push_back(a);
      polygon.push_back(0.75 * a + 0.25 * b);
    }
    const auto triangles = geometry::clip_ears(polygon);
    EXPECT_EQ(triangles.size(), polygon.size() - 2);
    EXPECT_NEAR(area(polygon, triangles), shoelace_area(polygon), 1e-9);
  }
}

// Up to rounding, the tops of equal arches are collinear. No cut may run along them.
TEST(Triangulate, CoversArcadesOfAnyWidth) {
  const Fineness fine{0.01};
  for (int bays = 3; bays <= 12; ++bays) {
    for (int step = 0; step < 31; ++step) {
      const double width = (3.9 + 0.013 * step) * bays;
      const double bay = width / bays, pier = 0.9, radius = 0.5 * (bay - pier), springing = 2.6;
      const double top = springing + radius + 0.7, end = 0.5 * width + 0.5 * pier;
      Profile outline(fine, -end, top);
      outline.by(0.0, springing - top);
      for (int i = 0; i < bays; ++i) {
        const double left = -0.5 * width + i * bay + 0.5 * pier;
        outline.to(left, springing).arc_to(left + 2.0 * radius, springing, -pi);
      }
      const Polyline2 wall = outline.to(end, springing).to(end, top).points();
      const auto triangles = geometry::clip_ears(wall);
      ASSERT_EQ(triangles.size(), wall.size() - 2) << bays << " bays, " << width;
      ASSERT_NEAR(area(wall, triangles), shoelace_area(wall), 1e-9) << bays << " bays, " << width;
    }
  }
}

TEST(Solids, HaveCorrectVolumesAndAreClosed) {
  const Mesh cuboid = box({1, 2, 3}, {2, 4, 6});
  EXPECT_EQ(closedness_error(cuboid), "");
  EXPECT_NEAR(signed_volume(cuboid), 6.0, 1e-12);

  const Fineness fine{1e-4};
  const Mesh ball = revolve(Profile(fine, 0, -1).arc_to(0, 1, pi).points(), fine.circle(1));
  EXPECT_EQ(closedness_error(ball), "");
  EXPECT_NEAR(signed_volume(ball), 4 * pi / 3, 4e-3);  // a shell of up to 3e-4 is missing

  // Pappus: section area times the path of its centroid; 1 - 1e-5 for the polygon.
  const Mesh ring = revolve_ring({{3, 0}, {4, 0}, {4, 2}, {3, 2}}, 1000);
  EXPECT_EQ(closedness_error(ring), "");
  EXPECT_NEAR(signed_volume(ring), 2 * 2 * pi * 3.5, 1e-3);

  // A square moulding around a square: a frame with mitred corners.
  const Mesh frame = sweep({{0, 0}, {1, 0}, {1, 1}, {0, 1}},
                           {{0, 0, 0}, {0, 4, 0}, {4, 4, 0}, {4, 0, 0}}, Vector3d::UnitZ(), true);
  EXPECT_EQ(closedness_error(frame), "");
  EXPECT_NEAR(signed_volume(frame), 6 * 6 - 4 * 4, 1e-12);
}

TEST(PlanCurve, MitresCornersAndKeepsRadius) {
  const PlanCurve plan = PlanCurve::with_projections(10, 4, 4, 12);
  EXPECT_NEAR((plan.point(2.0, 0.5) - Vector2d(12.5, 2.5)).norm(), 0, 1e-12);  // outer corner
  EXPECT_TRUE(plan.is_corner(2.0));
  const double side = 12 - std::sqrt(100 - 4);
  EXPECT_TRUE(plan.is_corner(2.0 + side));
  EXPECT_FALSE(plan.is_corner(2.0 + side + 1.0));
  EXPECT_NEAR(plan.point(2.0 + side + 1.0, 0.25).norm(), 10.25, 1e-12);
  // Each quarter is the first one, rotated.
  const Vector2d quarter = plan.point(3.0 + plan.length() / 4, 0.1);
  EXPECT_NEAR((quarter - Vector2d(-plan.point(3.0, 0.1).y(), plan.point(3.0, 0.1).x())).norm(), 0,
              1e-9);
}

/// Returns the volume of a rectangular tower of 4 x 2 x 3 with one opening in its +x face.
double volume_with(Opening opening, Joint joint = {}) {
  const PlanCurve plan = PlanCurve::rectangle(4, 2);
  Wall wall{plan, 0, 3, {}, {opening}, joint};
  double start = 0;
  for (const double length : {2.0, 4.0, 2.0, 4.0}) {
    const auto openings = start == 0 ? wall.openings : std::vector<Opening>{};
    for (const Polyline2& tile : plain_tiles(start, start + length, 0, 3, openings, 10)) {
      wall.tiles.push_back(tile);
    }
    start += length;
  }
  const Mesh mesh = Tower(0).add(build(wall)).close(3);
  EXPECT_EQ(closedness_error(mesh), "");
  return signed_volume(mesh);
}

TEST(Wall, RemovesVolumeOfOpenings) {
  EXPECT_NEAR(volume_with(rectangular(1.0, 0.8, 0.5, 2.0, 0.3)), 24 - 0.8 * 1.5 * 0.3, 1e-9);

  const Fineness fine{1e-4};
  const double arch = 0.8 * 1.0 + pi * 0.4 * 0.4 / 2;
  EXPECT_NEAR(volume_with(arched(1.0, 0.8, 0.5, 1.9, 0.3, fine)), 24 - arch * 0.3, 1e-4);

  // A niche: half a cylinder below a quarter of a ball.
  Opening niche = arched(1.0, 0.8, 0.5, 1.9, 0.4, fine);
  niche.back = Opening::Back::round;
  const double hollow = pi * 0.4 * 0.4 / 2 * 1.0 + pi * std::pow(0.4, 3) / 3;
  EXPECT_NEAR(volume_with(niche), 24 - hollow, 2e-3);
}

// A ring of blocks with V-joints lacks the grooves of the smooth cylinder. The section of a full V
// is half its width times its depth.
TEST(Wall, RemovesVolumeOfJointGrooves) {
  const Fineness fine{1e-5};
  Wall wall{PlanCurve::circle(10), 0, 2, {}, {}, {0.03, 0.05}};
  add_ring_courses(0, 0.5, 4, 20, fine, wall);
  const Mesh mesh = Tower(0).add(build(wall)).close(2);
  EXPECT_EQ(closedness_error(mesh), "");
  const double groove = 0.03 * 0.05;
  const double grooves = groove * (3 * 2 * pi * 10 + 4 * 20 * 0.5);
  // Crossings are counted twice, and grooves are up to 5 cm inside the circumference: 1%.
  EXPECT_NEAR(signed_volume(mesh), pi * 100 * 2 - grooves, 0.012 * grooves + 0.003);
}

TEST(CorinthianColumn, HasClosedSolidsAndHeightOfOrder) {
  for (const int flutes : {0, 24}) {
    const Parts parts = corinthian_column({11.3, 0.565, 0.475, flutes, pi + 0.1}, Fineness{0.005});
    int leaves = 0, volutes = 0;
    for (const Part& part : testing_support::not_empty(parts)) {
      EXPECT_EQ(closedness_error(part.mesh), "") << part.name;
      leaves += part.name == "acanthus leaf";
      volutes += part.name == "capital volute";
    }
    EXPECT_EQ(leaves, 16);  // two tiers of eight leaves
    EXPECT_EQ(volutes, 4);
    const Eigen::AlignedBox3d box = bounding_box(join(parts));
    EXPECT_NEAR(box.max().z(), 11.3, 0.021);  // the abacus overlaps the architrave by 2 cm
    EXPECT_NEAR(box.min().z(), 0.0, 0.031);   // the plinth overlaps its support by 3 cm
  }
}

}  // namespace
}  // namespace skycap::sim::models
