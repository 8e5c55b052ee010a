// Benchmark of the clearance check of a leg. It is compared with bisection on CGAL point distances,
// in a city block of 270,000 triangles. The legs are random, 5 to 30 m long, with 2 m clearance.
//
// clearance_benchmark [legs, 20000]
#include <cstdio>
#include <cstdlib>
#include <random>

#include "flight/clearance/clearance.h"
#include "tests/benchmarks/interleaved.h"
#include "tests/flight/clearance/cgal_oracle.h"
#include "tests/flight/scenes.h"

int main(int argc, char** argv) {
  using namespace skycap::flight;
  constexpr double clearance = 2.0;
  const int count = argc > 1 ? std::atoi(argv[1]) : 20000;
  Obstacles obstacles;
  obstacles.mesh = scenes::city(15);  // 270,000 triangles
  std::mt19937_64 random(1);
  const Eigen::AlignedBox3d around(Eigen::Vector3d(-10, -10, 0), Eigen::Vector3d(110, 110, 30));
  const std::vector<Segment> legs = scenes::legs(random, count, around);
  const CgalOracle oracle(obstacles.mesh);

  const auto start = std::chrono::steady_clock::now();
  const KnownSpace solid(obstacles);
  const double build =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  obstacles.mesh_is_solid = false;
  const KnownSpace shell(obstacles);

  std::size_t ours = 0, theirs = 0, solid_verified = 0, yes = 0;
  const auto verify_all = [&](const KnownSpace& space, std::size_t& verified) {
    verified = 0;
    for (const Segment& leg : legs) verified += verify(space, leg, clearance).is_verified ? 1 : 0;
  };
  const auto [certificate, bisection] = skycap::benchmarks::interleaved_medians(
      3, [&] { verify_all(shell, ours); },
      [&] {
        theirs = 0;
        for (const Segment& leg : legs) theirs += oracle.classify(leg, clearance) == Verdict::clear;
      });
  const auto [with_inside_test, yes_or_no] = skycap::benchmarks::interleaved_medians(
      3, [&] { verify_all(solid, solid_verified); },
      [&] {
        for (const Segment& leg : legs) yes += solid.continues_free(leg, clearance) ? 1 : 0;
      });

  const double per_leg = 1e6 / static_cast<double>(legs.size());
  std::printf("%zu triangles, index built in %.2f s\n", obstacles.mesh.triangles.size(), build);
  std::printf("prove, exact minimum:       %6.2f us a leg, %zu of %zu proven\n",
              certificate * per_leg, ours, legs.size());
  std::printf("CGAL bisection, yes or no:  %6.2f us a leg, %zu proven\n", bisection * per_leg,
              theirs);
  std::printf("prove, with inside test:    %6.2f us a leg, %zu proven\n",
              with_inside_test * per_leg, solid_verified);
  std::printf("continues_free, yes or no:  %6.2f us a leg, %.1f times as fast as CGAL bisection\n",
              yes_or_no * per_leg, bisection / yes_or_no);
  return ours == theirs && yes > 0 ? 0 : 1;
}
