/// Benchmark of the HTML report of a survey: the time to create it from a package, the time to read
/// the cloud alone, and the file size.
///
///   report_benchmark [points, 1000000] [rounds, 3]
///
/// A small survey of a 10 m long teapot is simulated. Its cloud is then replaced by noisy points of
/// the same surface, each assigned to one of the nearest views. On one core: taskset -c 0
/// report_benchmark
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "geometry/io/cloud_io.h"
#include "missions/evaluation/survey_scene.h"
#include "missions/package/package.h"
#include "missions/report/survey_report.h"
#include "tests/benchmarks/interleaved.h"
#include "tests/missions/run_skycap.h"

namespace {

using namespace skycap;

constexpr const char* mission = R"(
scene: {model: 'builtin:teapot', longest_side: 10.0}
sensor: {width: 160, height: 100, noise: {sigma: 0.03}}
planner: {name: skycap, preset: building, density: 100, resolution_radius: 0.3, view_distance: 12}
evaluation: {coverage_distance: 0.2, samples: 3000, visible_directions: 30, attainable_views: 0}
flight: {vehicle: m350_rtk, clearance: 2.0, unknown_box: {min: [-7, -7, 0], max: [7, 7, 7]}}
limits: {max_views: 12}
)";

/// Returns a random one of the three views nearest to `position`.
std::uint32_t view_near(const Eigen::Vector3f& position, const std::vector<geometry::View>& views,
                        std::mt19937_64& random) {
  std::vector<std::uint32_t> order(views.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
  const auto near = std::min<std::size_t>(3, order.size());
  std::ranges::partial_sort(order, order.begin() + static_cast<std::ptrdiff_t>(near), {},
                            [&](std::uint32_t view) {
                              return (views[view].position.cast<float>() - position).squaredNorm();
                            });
  return order[random() % near];
}

/// Replaces the cloud of the package by `points` points of the mission's surface.
void replace_cloud(const std::filesystem::path& folder, std::size_t points) {
  const missions::package::PackageSummary survey =
      missions::package::read_package_summary(folder, {});
  missions::evaluation::SimulationOptions dense = survey.mission.simulation;
  dense.evaluation.samples = points;
  geometry::SurfaceSamples surface =
      missions::evaluation::SurveyScene(dense, "", survey.mission.run.threads).samples();
  std::mt19937_64 random(5);
  std::normal_distribution<float> noise(0.0F, 0.01F);
  std::vector<std::uint32_t> views;
  for (Eigen::Vector3f& point : surface.points) {
    for (float& coordinate : point) coordinate += noise(random);
    views.push_back(view_near(point, survey.views, random));
  }
  geometry::write_cloud(
      folder / "cloud.ply",
      {.positions = surface.points, .normals = surface.normals, .views = views, .colours = {}});
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t points = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 1'000'000;
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 3;
  const tests::TestFolder folder;
  const auto run = tests::run_skycap(
      {"plan", folder.write("m.yaml", mission), "--quiet", "--no-report", "--out", folder / "out"});
  if (run.exit_code != 0) {
    std::fprintf(stderr, "%s", run.err.c_str());
    return 1;
  }
  const std::filesystem::path results = folder / "out";
  const auto page = [&] {
    return missions::report::survey_report(missions::report::results_in(results), points);
  };
  std::filesystem::remove(results / "cloud.ply");
  const std::size_t besides = page().size();
  replace_cloud(results, points);
  std::size_t bytes = 0;
  const benchmarks::Medians times = benchmarks::interleaved_medians(
      rounds, [&] { bytes = page().size(); }, [&] { geometry::read_cloud(results / "cloud.ply"); });
  std::printf("%zu points: the page takes %.2f s, reading the cloud alone %.2f s (%.1f times)\n",
              points, times.first, times.second, times.first / times.second);
  std::printf("%.2f bytes a point and %.3f MB besides\n",
              static_cast<double>(bytes - besides) / static_cast<double>(points),
              static_cast<double>(besides) / 1e6);
  return 0;
}
