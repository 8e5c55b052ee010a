/// Benchmark of a complete frame of the depth camera, including noise and point cloud. It is
/// compared with Embree casting the same rays, and with the loop over single rays that most
/// simulators use. Skycap's ray casting alone is also compared with Embree's, because bit-identical
/// results on every processor have a cost.
///
///   depth_camera_benchmark [--threads N] [--rounds N] [--largest]
///
/// The frame has 2400 x 1750 pixels, all of which return. The meshes have 70 thousand, 1 million
/// and, with --largest, 10 million triangles. The Embree loop casts the same rays in the same
/// packets and tiles, also on all threads, and stores only their distances. Skycap's casting alone
/// runs tile by tile.

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/parallel.h"
#include "geometry/pose/pose.h"
#include "sim/scene/scene_trees.h"
#include "sim/sensors/depth_camera.h"
#include "tests/benchmarks/embree_packets.h"
#include "tests/benchmarks/interleaved.h"
#include "tests/benchmarks/planet.h"

namespace {

using namespace skycap;

struct BareRays {
  const benchmarks::EmbreeMesh& mesh;
  const geometry::Camera& camera;
  Eigen::Isometry3d world_from_camera;
  Eigen::Vector3f origin = (world_from_camera.translation() - mesh.centre).cast<float>();
  Eigen::Matrix3f axes = world_from_camera.linear().cast<float>();
  Eigen::Vector2f scale = camera.focal_length_px().cast<float>().cwiseInverse();
  Eigen::Vector2f offset = -camera.principal_point_px().cast<float>().cwiseProduct(scale);

  Eigen::Vector3f direction(int column, int row) const {
    const Eigen::Vector2f slope = Eigen::Vector2f(column, row).cwiseProduct(scale) + offset;
    return axes * Eigen::Vector3f(slope.x(), slope.y(), 1.0F);
  }
};

/// Casts the rays of a packet one at a time.
template <int width>
struct EmbreeCaster {
  const benchmarks::EmbreeMesh& mesh;
  benchmarks::EmbreePacket<width> packet;

  void set_origin(int lane, const Eigen::Vector3f& origin) {
    packet.rays.ray.org_x[lane] = origin.x();
    packet.rays.ray.org_y[lane] = origin.y();
    packet.rays.ray.org_z[lane] = origin.z();
  }
  void set_direction(int lane, const Eigen::Vector3f& direction) {
    packet.rays.ray.dir_x[lane] = direction.x();
    packet.rays.ray.dir_y[lane] = direction.y();
    packet.rays.ray.dir_z[lane] = direction.z();
  }
  void cast(float reach) { packet.cast(mesh, reach); }
  float range(int lane) const { return packet.rays.ray.tfar[lane]; }
};

template <int width>
void cast_packets(EmbreeCaster<width> caster, const BareRays& rays, int first_row, float* ranges) {
  for (int lane = 0; lane < width; ++lane) caster.set_origin(lane, rays.origin);
  const int columns = rays.camera.width(), rows = rays.camera.height();
  for (int tile = 0; tile < columns; tile += 32) {
    for (int row = first_row; row < std::min(first_row + 32, rows); row += width / 4) {
      for (int column = tile; column < std::min(tile + 32, columns); column += 4) {
        for (int lane = 0; lane < width; ++lane) {
          caster.set_direction(lane, rays.direction(column + lane % 4, row + lane / 4));
        }
        caster.cast(1e4F);
        for (int lane = 0; lane < width; ++lane) {
          const int y = row + lane / 4;
          if (y < rows) ranges[y * columns + column + lane % 4] = caster.range(lane);
        }
      }
    }
  }
}

void cast_bare(const BareRays& rays, unsigned threads, std::vector<float>& ranges) {
  geometry::parallel_for((rays.camera.height() + 31) / 32, threads, [&](std::size_t band) {
    rays.mesh.with_packet_width([&]<int width>() {
      cast_packets<width>(EmbreeCaster<width>{rays.mesh, {}}, rays, static_cast<int>(band) * 32,
                          ranges.data());
    });
  });
}

/// Casts tiles of 16 x 16 pixels, the tile size of frames.
void cast_own(const sim::Scene& scene, const BareRays& rays, unsigned threads,
              std::vector<float>& ranges) {
  constexpr int edge = 16, packets = edge * edge / sim::RayPacket::width;
  const int columns = rays.camera.width(), rows = rays.camera.height();
  geometry::parallel_for((rows + edge - 1) / edge, threads, [&](std::size_t band) {
    std::array<sim::RayPacket, packets> tile;
    const auto for_each_ray = [&](int first_column, auto work) {
      for (int i = 0; i < edge * edge; ++i) {
        const int packet = i / sim::RayPacket::width, lane = i % sim::RayPacket::width;
        work(tile[packet], lane, first_column + packet % 4 * 4 + lane % 4,
             static_cast<int>(band) * edge + packet / 4 * 4 + lane / 4);
      }
    };
    for (int column = 0; column < columns; column += edge) {
      for_each_ray(column, [&](sim::RayPacket& packet, int lane, int x, int y) {
        const Eigen::Vector3f direction = rays.direction(x, y);
        for (int axis = 0; axis < 3; ++axis) {
          packet.origin[axis][lane] = rays.origin[axis];
          packet.direction[axis][lane] = direction[axis];
        }
      });
      sim::ray_kernels().cast_tile_distances(scene.trees().target, tile.data(), packets, 1e4F);
      for_each_ray(column, [&](const sim::RayPacket& packet, int lane, int x, int y) {
        if (x < columns && y < rows) ranges[y * columns + x] = packet.distance[lane];
      });
    }
  });
}

void cast_one_by_one(const BareRays& rays, unsigned threads, std::vector<float>& ranges) {
  geometry::parallel_for(rays.camera.height(), threads, [&](std::size_t row) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (int column = 0; column < rays.camera.width(); ++column) {
      const Eigen::Vector3f direction = rays.direction(column, static_cast<int>(row));
      RTCRayHit ray = {};
      ray.ray.org_x = rays.origin.x();
      ray.ray.org_y = rays.origin.y();
      ray.ray.org_z = rays.origin.z();
      ray.ray.dir_x = direction.x();
      ray.ray.dir_y = direction.y();
      ray.ray.dir_z = direction.z();
      ray.ray.tfar = 1e4F;
      ray.ray.mask = ~0U;
      ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(rays.mesh.scene, &context, &ray);
      ranges[row * rays.camera.width() + column] = ray.ray.tfar;
    }
  });
}

void run(std::size_t triangles, unsigned threads, int rounds) {
  const geometry::Mesh mesh = benchmarks::planet(triangles);
  const sim::Scene scene(mesh, threads);
  const sim::DepthCamera camera(sim::high_resolution());
  const Eigen::Isometry3d pose =
      geometry::camera_pose(geometry::look_at({25.0, 16.0, 9.0}, Eigen::Vector3d::Zero()));
  const benchmarks::EmbreeMesh embree(mesh, threads);
  const BareRays rays{embree, camera.camera(), pose};

  geometry::Scan scan;
  std::vector<float> ranges(static_cast<std::size_t>(camera.camera().width()) *
                            camera.camera().height());
  std::uint64_t frame = 0;
  const auto whole = [&] { scan = camera.scan(scene, pose, frame++, threads, std::move(scan)); };
  const auto fresh = [&] { scan = camera.scan(scene, pose, frame++, threads); };
  const auto bare = [&] { cast_bare(rays, threads, ranges); };
  const auto own = [&] { cast_own(scene, rays, threads, ranges); };
  const auto single = [&] { cast_one_by_one(rays, threads, ranges); };

  const auto against_bare = benchmarks::interleaved_medians(rounds, whole, bare);
  const auto against_fresh = benchmarks::interleaved_medians(rounds, fresh, bare);
  const auto casting = benchmarks::interleaved_medians(rounds, own, bare);
  const auto against_single =
      benchmarks::interleaved_medians(std::max(1, rounds / 4), whole, single);
  std::printf("%9zu triangles, %.1f %% return, packets of %d\n", mesh.triangles.size(),
              100.0 * static_cast<double>(scan.points.size()) / static_cast<double>(ranges.size()),
              embree.packet_width());
  std::printf("  whole frame %7.1f ms, bare packets %7.1f ms: %.3f\n", 1e3 * against_bare.first,
              1e3 * against_bare.second, against_bare.first / against_bare.second);
  std::printf("  in new memory %5.1f ms, bare packets %7.1f ms: %.3f\n", 1e3 * against_fresh.first,
              1e3 * against_fresh.second, against_fresh.first / against_fresh.second);
  std::printf("  casting alone %5.1f ms, bare packets %7.1f ms: %.3f, so the whole frame %.3f\n",
              1e3 * casting.first, 1e3 * casting.second, casting.first / casting.second,
              benchmarks::compute_own_casting_cost(against_bare, casting));
  std::printf("  whole frame %7.1f ms, single rays  %7.1f ms: %.2f times faster\n",
              1e3 * against_single.first, 1e3 * against_single.second,
              against_single.second / against_single.first);
}

}  // namespace

int main(int argc, char** argv) {
  unsigned threads = 0;
  int rounds = 9;
  bool largest = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view option = argv[i];
    if (option == "--largest") {
      largest = true;
    } else if (option == "--threads" && i + 1 < argc) {
      threads = static_cast<unsigned>(std::atoi(argv[++i]));
    } else if (option == "--rounds" && i + 1 < argc) {
      rounds = std::max(1, std::atoi(argv[++i]));
    } else {
      std::fprintf(stderr,
                   "usage: depth_camera_benchmark [--threads N] [--rounds N] [--largest]\n");
      return 2;
    }
  }
  run(70'000, threads, rounds);
  run(1'000'000, threads, rounds);
  if (largest) run(10'000'000, threads, rounds);
}
