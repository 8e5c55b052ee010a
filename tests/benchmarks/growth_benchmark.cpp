/// Benchmark of the run time of each part against its input size. Prints the measured times and the
/// fitted exponent (time = c size^exponent, least squares of the logarithms). All parts run on one
/// thread. Times are medians of three runs of process CPU time, which depends little on the load of
/// the machine.
///
///   growth_benchmark [--points N, 10000000] [--triangles N, 10000000] [--area N, 32]
///
/// points: insertion of the returns of a tower scan into a cloud with minimum spacing, in scan
/// order and shuffled, then neighbour queries in that cloud. The tower's area grows with the number
/// of returns.
/// triangles: construction of the ray and distance structures of a hilly sphere, one frame of 848 x
/// 480 pixels, and a million distance queries near it.
/// area: surveys of spheres with SEE++ against the number of views. The largest sphere has N times
/// the surface of a sphere of radius 0.5 m.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "geometry/points/spaced_points.h"
#include "geometry/pose/pose.h"
#include "geometry/surfaces/mesh_distance.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "survey/see/see.h"
#include "tests/benchmarks/planet.h"
#include "tests/benchmarks/processor_time.h"
#include "tests/support/sphere_sensor.h"

namespace {

using namespace skycap;
using Eigen::Vector3f;

constexpr int rounds = 3;

double processor_seconds() { return seconds_on(CLOCK_PROCESS_CPUTIME_ID); }

template <typename Work>
double measure_seconds(Work work) {
  std::vector<double> times;
  for (int round = 0; round < rounds; ++round) {
    const double start = processor_seconds();
    work();
    times.push_back(processor_seconds() - start);
  }
  std::nth_element(times.begin(), times.begin() + rounds / 2, times.end());
  return times[rounds / 2];
}

/// Measured costs of one part for several input sizes.
class Curve {
 public:
  /// `work` is the number of repetitions at every size. If it is 0, the input size is used.
  Curve(const char* what, const char* unit, std::size_t work = 0)
      : what_(what), unit_(unit), work_(static_cast<double>(work)) {}

  void add(std::size_t size, double seconds) {
    costs_.push_back({static_cast<double>(size), seconds});
  }

  void print() const {
    std::printf("%s\n", what_);
    for (const auto& [size, seconds] : costs_) {
      std::printf("  %12.0f %-10s %12.6f s %12.1f ns each\n", size, unit_, seconds,
                  1e9 * seconds / (work_ > 0.0 ? work_ : size));
    }
    if (costs_.size() > 1) std::printf("  exponent %.2f\n", exponent());
  }

 private:
  struct Cost {
    double size, seconds;
  };

  double exponent() const {
    double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0;
    for (const auto& [size, seconds] : costs_) {
      const double a = std::log(size), b = std::log(seconds);
      x += a, y += b, xx += a * a, xy += a * b;
    }
    const auto n = static_cast<double>(costs_.size());
    return (n * xy - x * y) / (n * xx - x * x);
  }

  const char* what_;
  const char* unit_;
  double work_;
  std::vector<Cost> costs_;
};

constexpr double spacing = 0.0685;  // density of the building in the paper
constexpr double radius = 0.15;

/// Returns scan points of a tower 30 m wide, in rows around it, with five points for each square of
/// the spacing.
std::vector<Vector3f> tower(std::size_t count) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 0.01);
  const double step = spacing / std::sqrt(5.0);
  const double around = std::floor(30.0 * std::numbers::pi / step);
  std::vector<Vector3f> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double row = std::floor(static_cast<double>(i) / around);
    const double azimuth = 2.0 * std::numbers::pi * static_cast<double>(i) / around;
    const double across = 15.0 + noise(random);
    points[i] = Eigen::Vector3d(across * std::cos(azimuth), across * std::sin(azimuth), row * step)
                    .cast<float>();
  }
  return points;
}

void grow_points(std::size_t max) {
  Curve in_rows("keep returns at a spacing, in rows", "returns");
  Curve shuffled("keep returns at a spacing, shuffled", "returns");
  constexpr std::size_t queries = 100'000;
  Curve balls("find the neighbours within 0.15 m", "points", queries);
  for (std::size_t count = 10'000; count <= max; count *= 10) {
    std::vector<Vector3f> returns = tower(count);
    std::optional<geometry::SpacedPoints> kept;
    const auto keep_all = [&] {
      kept.emplace(spacing);
      for (const Vector3f& point : returns) kept->keep(point);
    };
    in_rows.add(count, measure_seconds(keep_all));
    std::shuffle(returns.begin(), returns.end(), std::mt19937_64(2));
    shuffled.add(count, measure_seconds(keep_all));

    geometry::PointGrid grid(radius);
    for (std::uint32_t i = 0; i < kept->grid().size(); ++i) grid.insert(kept->grid().point(i));
    std::vector<geometry::Neighbour> found;
    balls.add(grid.size(), measure_seconds([&] {
                for (std::size_t i = 0; i < queries; ++i) {
                  found.clear();
                  grid.find_within(returns[i % returns.size()], radius, found);
                }
              }));
  }
  in_rows.print();
  shuffled.print();
  balls.print();
}

void grow_triangles(std::size_t max) {
  Curve scene("make a scene ready for rays", "triangles");
  Curve frame("frame of 848 x 480 pixels, all of which return", "triangles", 848 * 480);
  Curve ready("make a mesh ready for distances", "triangles");
  constexpr std::size_t asked = 1'000'000;
  Curve distances("distances of points 1 cm from it, in rows", "triangles", asked);
  for (std::size_t count = 10'000; count <= max; count *= 10) {
    const geometry::Mesh mesh = benchmarks::planet(count);
    const std::size_t triangles = mesh.triangles.size();
    std::optional<sim::Scene> made;
    scene.add(triangles, measure_seconds([&] { made.emplace(mesh, 1); }));
    const sim::DepthCamera camera(sim::d435());
    const geometry::View view = geometry::look_at({26.0, 0.0, 0.0}, {0.0, 0.0, 0.0});
    frame.add(triangles, measure_seconds([&] { camera.scan(*made, view, 0, 1); }));
    made.reset();

    std::optional<geometry::MeshDistance> distance;
    ready.add(triangles, measure_seconds([&] { distance.emplace(mesh); }));
    std::vector<Vector3f> points(asked);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double polar = 0.5 + 2.0 * std::floor(static_cast<double>(i) / 1e3) / 1e3;
      const double azimuth = 2.0 * std::numbers::pi * static_cast<double>(i % 1000) / 1e3;
      const Eigen::Vector3d up(std::sin(polar) * std::cos(azimuth),
                               std::sin(polar) * std::sin(azimuth), std::cos(polar));
      points[i] = ((20.01 + benchmarks::hill(up)) * up).cast<float>();
    }
    std::vector<double> found(points.size());
    distances.add(triangles, measure_seconds([&] { distance->distances(points, found); }));
  }
  scene.print();
  frame.print();
  ready.print();
  distances.print();
}

/// A D435 with a sixteenth of its pixels. The density is reduced by the same factor, so that
/// distances remain the published ones.
const geometry::Camera small_camera(geometry::CameraConfig{.width = 212, .height = 120});

/// Number of points at the minimum spacing within the resolution radius. With the published
/// threshold, a large sphere that fills the image would have no frontiers, because its density does
/// not drop at the image edges.
constexpr std::size_t half_a_disc = 18;

void grow_views(double max_area) {
  Curve planning("plan a survey by SEE++", "views");
  Curve kept("the same survey, by the points that it keeps", "points");
  for (double area = 1.0; area <= max_area; area *= 2.0) {
    const tests::Sphere sphere{.radius = 0.5 * std::sqrt(area)};
    survey::see::SeePlanner planner({.density = 146'000.0 / 16,
                                     .resolution_radius = 0.017 * std::cbrt(16.0),
                                     .core_threshold = half_a_disc},
                                    small_camera);
    std::optional<geometry::View> next =
        geometry::look_at({sphere.radius + planner.view_distance(), 0.3, 0.2}, {0, 0, 0});
    std::size_t views = 0;
    double seconds = 0.0;
    while (next) {
      const geometry::Scan scan =
          tests::scan_spheres({sphere}, small_camera, *next, 0.0025, ++views);
      const double start = processor_seconds();
      next = planner.next_view(scan);
      seconds += processor_seconds() - start;
    }
    planning.add(views, seconds);
    kept.add(planner.cloud().positions.size(), seconds);
  }
  planning.print();
  kept.print();
}

}  // namespace

int main(int argc, char** argv) {
  // Flush every line: the largest sizes may run out of memory.
  std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
  std::size_t points = 10'000'000, triangles = 10'000'000;
  double area = 32.0;
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view name = argv[i];
    if (name == "--points") points = std::strtoul(argv[i + 1], nullptr, 10);
    if (name == "--triangles") triangles = std::strtoul(argv[i + 1], nullptr, 10);
    if (name == "--area") area = std::atof(argv[i + 1]);
  }
  grow_points(points);
  grow_triangles(triangles);
  grow_views(area);
}
