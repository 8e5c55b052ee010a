/// Benchmark of point-to-mesh distances against the CGAL tree and Embree point queries. The points
/// are a noisy frame of a town, in scan order and shuffled. It runs on one core.
///
///   mesh_distance_benchmark [triangles, 500000] [rounds, 3]
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <optional>
#include <random>
#include <vector>

#include "geometry/pose/pose.h"
#include "geometry/surfaces/mesh_distance.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "tests/benchmarks/embree_packets.h"
#include "tests/benchmarks/interleaved.h"
#include "tests/benchmarks/town.h"
#include "tests/flight/clearance/cgal_oracle.h"

namespace {

using namespace skycap;

/// Returns the squared distance between a point and a triangle in single precision. Embree point
/// queries require this function from the caller.
float squared_distance(const Eigen::Vector3f& p, const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                       const Eigen::Vector3f& c) {
  const Eigen::Vector3f normal = (b - a).cross(c - a);
  const auto is_left = [&](const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
    return normal.dot((to - from).cross(p - from)) >= 0.0F;
  };
  if (is_left(a, b) && is_left(b, c) && is_left(c, a)) {
    const float above = normal.dot(p - a);
    return above * above / normal.squaredNorm();
  }
  const auto to_edge = [&](const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
    const Eigen::Vector3f edge = to - from;
    const float t = std::clamp((p - from).dot(edge) / edge.squaredNorm(), 0.0F, 1.0F);
    return (p - from - t * edge).squaredNorm();
  };
  return std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
}

struct Query {
  const geometry::Mesh* mesh;
  Eigen::Vector3f point;
  float nearest = std::numeric_limits<float>::infinity();
};

bool look_at(RTCPointQueryFunctionArguments* arguments) {
  Query& query = *static_cast<Query*>(arguments->userPtr);
  const auto& [a, b, c] = query.mesh->triangles[arguments->primID];
  const auto corner = [&](std::uint32_t i) -> Eigen::Vector3f {
    return query.mesh->vertices[i].cast<float>();
  };
  const float squared = squared_distance(query.point, corner(a), corner(b), corner(c));
  if (squared >= query.nearest) return false;
  query.nearest = squared;
  arguments->query->radius = std::sqrt(squared);
  return true;
}

double embree_distance(const benchmarks::EmbreeMesh& embree, const geometry::Mesh& centred,
                       const Eigen::Vector3f& point) {
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  Query query{&centred, point};
  RTCPointQuery rtc{point.x(), point.y(), point.z(), 0.0F, std::numeric_limits<float>::infinity()};
  rtcPointQuery(embree.scene, &rtc, &context, look_at, &query);
  return std::sqrt(query.nearest);
}

/// Returns a frame from above the town with about 1 m between neighbouring points at the far end.
std::vector<Eigen::Vector3f> make_frame(const geometry::Mesh& mesh) {
  sim::DepthCameraConfig config = sim::high_resolution();
  config.camera.width = 800;
  config.camera.height = 600;
  config.noise.sigma = 0.02;
  const sim::Scene scene(mesh);
  return sim::DepthCamera(config)
      .scan(scene, geometry::look_at({-90, -80, 90}, {0, 0, 10}), 0)
      .points;
}

}  // namespace

int main(int argc, char** argv) {
  const auto triangles = static_cast<std::size_t>(argc > 1 ? std::atol(argv[1]) : 500000);
  const int rounds = argc > 2 ? std::atoi(argv[2]) : 3;
  geometry::Mesh mesh = benchmarks::town(triangles);
  std::vector<Eigen::Vector3f> points = make_frame(mesh);

  const auto seconds = [](const auto& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  std::optional<geometry::MeshDistance> ours;
  std::optional<flight::CgalOracle> cgal;
  std::optional<benchmarks::EmbreeMesh> embree;
  const double our_build = seconds([&] { ours.emplace(mesh); });
  const double cgal_build = seconds([&] { cgal.emplace(mesh); });
  const double embree_build = seconds([&] { embree.emplace(mesh, 1); });
  std::printf("%zu triangles, %zu points; ready in %.2f s, CGAL %.2f s, Embree %.2f s\n",
              mesh.triangles.size(), points.size(), our_build, cgal_build, embree_build);
  geometry::Mesh centred = mesh;
  for (Eigen::Vector3d& vertex : centred.vertices) vertex -= embree->centre;

  double worst = 0.0;
  std::mt19937_64 random(1);
  for (const char* order : {"in the order of the scan", "shuffled"}) {
    if (*order == 's') std::ranges::shuffle(points, random);
    std::vector<double> found(points.size()), by_cgal(points.size()), by_embree(points.size());
    const auto run_ours = [&] { ours->distances(points, found); };
    const auto [time, embree_time] = benchmarks::interleaved_medians(rounds, run_ours, [&] {
      for (std::size_t i = 0; i < points.size(); ++i) {
        by_embree[i] = embree_distance(*embree, centred, points[i] - embree->centre.cast<float>());
      }
    });
    const double cgal_time = benchmarks::interleaved_medians(rounds, run_ours, [&] {
                               for (std::size_t i = 0; i < points.size(); ++i) {
                                 by_cgal[i] = cgal->distance(points[i].cast<double>());
                               }
                             }).second;
    const double per_point = 1e9 / static_cast<double>(points.size());
    std::printf("%-25s %6.0f ns a point, Embree %6.0f (ratio %.2f), CGAL %6.0f (ratio %.2f)\n",
                order, time * per_point, embree_time * per_point, time / embree_time,
                cgal_time * per_point, time / cgal_time);
    for (std::size_t i = 0; i < points.size(); ++i) {
      worst = std::max(worst, std::abs(found[i] - by_cgal[i]));
    }
  }
  std::printf("largest difference from CGAL's distances: %.2g m\n", worst);
  return worst < 1e-9 ? 0 : 1;
}
