// Benchmark of path planning between random positions in a city block and around a building of the
// size of the Radcliffe Camera. The grid planner is compared with OMPL's BIT*, at 2 m clearance.
//
// path_benchmark [paths in each, 30]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <random>
#include <vector>

#include "flight/paths/path.h"
#include "flight/paths/sampling_path.h"
#include "tests/flight/scenes.h"

namespace {

using namespace skycap::flight;
using Eigen::Vector3d;

/// Returns the CPU time of `work` [s], because both planners run on one thread and the machine may
/// be shared.
double seconds(auto&& work) {
  const std::clock_t start = std::clock();
  work();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

void run(const char* name, const Obstacles& obstacles, const Eigen::AlignedBox3d& around,
         std::size_t count) {
  constexpr double clearance = 2.0;
  const KnownSpace space(obstacles);
  PathFinder finder(space, clearance);
  std::mt19937_64 random(4);
  std::vector<double> grid_times, sampling_times, ratios;
  while (grid_times.size() < count) {
    const Vector3d from = scenes::point_in(random, around), to = scenes::point_in(random, around);
    if (!space.is_free({from, from}, clearance) || !space.is_free({to, to}, clearance)) continue;
    // Skip queries that the straight line solves.
    if (space.continues_free({from, to}, clearance)) continue;
    Path grid, sampled;
    grid_times.push_back(seconds([&] { grid = finder.find(from, to); }));
    sampling_times.push_back(
        seconds([&] { sampled = find_path_by_sampling(space, from, to, clearance); }));
    if (grid.status == PathStatus::found && sampled.status == PathStatus::found) {
      ratios.push_back(grid.length / sampled.length);
    }
  }
  for (auto* values : {&grid_times, &sampling_times, &ratios}) {
    std::sort(values->begin(), values->end());
  }
  std::printf(
      "%-10s grid: median %6.1f ms, slowest %6.1f ms; BIT*: median %6.1f ms; length of grid "
      "to BIT*: median %.3f, worst %.3f (%zu of %zu found by both)\n",
      name, 1e3 * grid_times[count / 2], 1e3 * grid_times.back(), 1e3 * sampling_times[count / 2],
      ratios[ratios.size() / 2], ratios.back(), ratios.size(), count);
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t count = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 30;
  Obstacles city, building;
  city.mesh = scenes::city(15);
  city.ground_height = 0.0;
  run("city", city, Eigen::AlignedBox3d(Vector3d(-5, -5, 2), Vector3d(105, 105, 20)), count);
  building.mesh = scenes::box({-20, -20, 0}, {20, 20, 40}, 60);
  building.ground_height = 0.0;
  run("building", building, Eigen::AlignedBox3d(Vector3d(-40, -40, 2), Vector3d(40, 40, 50)),
      count);
  return 0;
}
