// Benchmark of the least occluded direction among n occluded ones, against the obvious
// alternatives.
// GLOBAL  against the convex hull of all directions (CGAL), whose facet nearest to the origin gives
// the same result. The hull is skipped above 100,000 directions, where it takes many seconds.
// LOCAL   against the paper's nonlinear program (NLopt), whose cosine should not be smaller.
// The sets resemble the surroundings of a frontier: directions all over the sphere except for some
// holes. The last table has no holes, so that any gap between directions might be the largest.
//
// spherical_cap_benchmark [most directions, 300000]
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <vector>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>
#include <Eigen/Geometry>

#include "geometry/spherical_cap/spherical_cap.h"
#include "tests/benchmarks/interleaved.h"

namespace {

using Eigen::Vector3d;
using namespace skycap;
using geometry::CapPolicy;

struct Case {
  std::vector<Vector3d> occluded;
  Vector3d known_clear;
};

Vector3d random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> coordinate;
  return Vector3d{coordinate(random), coordinate(random), coordinate(random)}.normalized();
}

Case directions_around_holes(int count, int holes, std::mt19937_64& random) {
  std::uniform_real_distribution<double> radius(0.2, 0.9);  // [rad]
  std::vector<Vector3d> centres;
  std::vector<double> cosines;
  for (int hole = 0; hole < holes; ++hole) {
    centres.push_back(random_direction(random));
    cosines.push_back(std::cos(radius(random)));
  }
  Case made{{}, holes > 0 ? centres[0] : Vector3d(Vector3d::UnitZ())};
  while (static_cast<int>(made.occluded.size()) < count) {
    const Vector3d q = random_direction(random);
    bool is_in_hole = false;
    for (std::size_t i = 0; i < centres.size(); ++i) {
      is_in_hole = is_in_hole || q.dot(centres[i]) > cosines[i];
    }
    if (!is_in_hole) made.occluded.push_back(q);
  }
  return made;
}

double clearest(const Case& at, CapPolicy policy) {
  const auto cap = geometry::clearest_direction(at.occluded, at.known_clear, {policy});
  return cap ? cap->cosine : std::numeric_limits<double>::quiet_NaN();
}

double by_full_hull(const Case& at) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> points;
  for (const Vector3d& q : at.occluded) points.emplace_back(q.x(), q.y(), q.z());
  CGAL::Surface_mesh<Kernel::Point_3> hull;
  CGAL::convex_hull_3(points.begin(), points.end(), hull);
  double nearest = 1.0;
  for (const auto face : hull.faces()) {
    std::vector<Vector3d> corners;
    for (const auto v : hull.vertices_around_face(hull.halfedge(face))) {
      corners.emplace_back(hull.point(v).x(), hull.point(v).y(), hull.point(v).z());
    }
    const Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    nearest = std::min(nearest, normal.dot(corners[0]));
  }
  return nearest;
}

void compare_global(int holes, int largest, std::mt19937_64& random) {
  constexpr int largest_hull = 100'000;
  std::printf("%10s %12s %14s %8s %12s\n", "directions", "GLOBAL ms", "full hull ms", "ratio",
              "difference");
  for (const int count : {1'000, 10'000, 30'000, 100'000, 300'000}) {
    if (count > largest) break;
    const Case at = directions_around_holes(count, holes, random);
    const bool has_hull = count <= largest_hull;
    double ours = 0.0, theirs = 0.0;
    const auto medians = benchmarks::interleaved_medians(
        has_hull ? (count > 30'000 ? 3 : 5) : 11, [&] { ours = clearest(at, CapPolicy::global); },
        [&] { theirs = has_hull ? by_full_hull(at) : 0.0; });
    std::printf("%10d %12.3f", count, 1e3 * medians.first);
    if (has_hull) {
      std::printf(" %14.1f %8.0f %12.1e", 1e3 * medians.second, medians.second / medians.first,
                  ours - theirs);
    }
    std::printf("\n");
  }
}

void compare_local(int largest, std::mt19937_64& random) {
  std::printf("%10s %12s %12s %8s %10s %12s\n", "directions", "LOCAL ms", "NLopt ms", "ratio",
              "LOCAL cos", "NLopt cos");
  for (const int count : {1'000, 3'000, 10'000, 30'000}) {
    if (count > largest) break;
    const Case at = directions_around_holes(count, 6, random);
    double ours = 0.0, theirs = 0.0;
    const auto medians = benchmarks::interleaved_medians(
        7, [&] { ours = clearest(at, CapPolicy::local); },
        [&] { theirs = clearest(at, CapPolicy::nonlinear_program); });
    std::printf("%10d %12.3f %12.2f %8.0f %10.4f %12.4f\n", count, 1e3 * medians.first,
                1e3 * medians.second, medians.second / medians.first, ours, theirs);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const int largest = argc > 1 ? std::atoi(argv[1]) : 300'000;
  std::mt19937_64 random(1);
  std::printf("six holes\n");
  compare_global(6, largest, random);
  std::printf("\n");
  compare_local(largest, random);
  std::printf("\nno holes\n");
  compare_global(0, std::min(largest, 100'000), random);
}
