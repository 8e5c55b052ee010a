/// A moving laser scanner, all of it, against the bare casting of the same rays; whole flights into
/// a LAS file, against writing the same bytes; and what a scene costs.
///
///   lidar_benchmark [--threads N] [--rounds N] [--file FILE.las] [--largest 1]
///
/// The platform flies at 10 m/s inside a hilly sphere, where all shots return, and over a city. The
/// bare loop has its rays ready in memory, in packets of the same shape, and keeps only their
/// distances. --largest adds the making of a scene of 30 million triangles.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <unistd.h>

#include "geometry/parallel.h"
#include "missions/las_format.h"
#include "missions/scan_runner.h"
#include "sim/lidar.h"
#include "sim/models/models.h"
#include "sim/scan_pattern.h"
#include "sim/scene_embree.h"
#include "tests/benchmarks/interleaved.h"
#include "tests/benchmarks/planet.h"

namespace {

using namespace skycap;

constexpr double degree = 0.017453292519943295;

sim::LidarConfig spinner(int channels, int columns) {
  sim::LidarConfig config;
  config.rotation_rate = 10.0;
  config.firing_period = 0.1 / columns;
  config.channels.clear();
  for (int i = 0; i < channels; ++i) {
    config.channels.push_back({.elevation = (22.5 - 45.0 * i / (channels - 1)) * degree});
  }
  config.errors.sigma = 0.01;
  return config;
}

sim::Trajectory flight(double duration) {
  const Eigen::Quaterniond level = Eigen::Quaterniond::Identity();
  return sim::Trajectory(
      {{0.0, {-2.0, 3.0, 1.0}, level},
       {duration, Eigen::Vector3d(-2.0 + 10.0 * std::min(duration, 0.5), 3.0, 1.0), level}});
}

struct BareRays {
  std::vector<float> origin[3], direction[3];
};

BareRays all_rays(const sim::LidarConfig& config, const sim::Trajectory& trajectory,
                  const Eigen::Vector3d& centre, std::uint64_t blocks) {
  BareRays rays;
  const sim::ScanPattern pattern(config);
  sim::Shots shots;
  for (std::uint64_t block = 0; block < blocks; ++block) {
    pattern.aim(block, shots);
    for (std::size_t slot = 0; slot < pattern.slots(); ++slot) {
      const std::size_t firing = slot / 4 / config.channels.size() * 4 + slot % 4;
      const Eigen::Isometry3d pose =
          trajectory.pose(static_cast<double>(block * 32 + firing) * config.firing_period);
      const Eigen::Vector3d towards =
          pose.linear() * Eigen::Vector3d(shots.direction[0][slot], shots.direction[1][slot],
                                          shots.direction[2][slot]);
      for (int axis = 0; axis < 3; ++axis) {
        rays.origin[axis].push_back(static_cast<float>(pose.translation()[axis] - centre[axis]));
        rays.direction[axis].push_back(static_cast<float>(towards[axis]));
      }
    }
  }
  return rays;
}

template <int width>
void cast_packets(const sim::Scene::Embree& embree, const BareRays& rays, std::size_t begin,
                  std::size_t end, float* ranges) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  sim::Packet<width> packet;
  auto& ray = packet.rays.ray;
  for (std::size_t first = begin; first < end; first += width) {
    std::memcpy(ray.org_x, &rays.origin[0][first], sizeof ray.org_x);
    std::memcpy(ray.org_y, &rays.origin[1][first], sizeof ray.org_y);
    std::memcpy(ray.org_z, &rays.origin[2][first], sizeof ray.org_z);
    std::memcpy(ray.dir_x, &rays.direction[0][first], sizeof ray.dir_x);
    std::memcpy(ray.dir_y, &rays.direction[1][first], sizeof ray.dir_y);
    std::memcpy(ray.dir_z, &rays.direction[2][first], sizeof ray.dir_z);
    for (int lane = 0; lane < width; ++lane) {
      ray.tfar[lane] = 200.0F;
      packet.rays.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
    }
    sim::PacketTypes<width>::intersect(packet.active, embree.scene, &context, &packet.rays);
    std::memcpy(ranges + first, ray.tfar, sizeof ray.tfar);
  }
}

void compare(const sim::Scene& scene, std::size_t triangles, unsigned threads, int rounds) {
  const sim::LidarConfig config = spinner(64, 1024);
  const sim::Trajectory trajectory = flight(0.1);
  const sim::Lidar lidar(config);
  const sim::LidarFlight flown{trajectory, trajectory};
  constexpr std::uint64_t blocks = 32, blocks_in_piece = 2;
  const BareRays rays = all_rays(config, trajectory, scene.embree().centre, blocks);
  std::vector<float> ranges(rays.origin[0].size());
  std::vector<sim::LidarReturns> pieces(blocks / blocks_in_piece);
  const auto whole = [&] {
    geometry::parallel_for(pieces.size(), threads, [&](std::size_t i) {
      pieces[i] = lidar.measure(scene, flown, {i * 32 * blocks_in_piece, 32 * blocks_in_piece},
                                std::move(pieces[i]));
    });
  };
  const auto bare = [&] {
    geometry::parallel_for(pieces.size(), threads, [&](std::size_t i) {
      const std::size_t size = ranges.size() / pieces.size();
      sim::with_packet_width(scene.embree(), [&]<int width>() {
        cast_packets<width>(scene.embree(), rays, i * size, (i + 1) * size, ranges.data());
      });
    });
  };
  const auto medians = benchmarks::interleaved_medians(rounds, whole, bare);
  std::printf("%9zu triangles, a turn of 64 x 1024: %6.2f ms, bare packets %6.2f ms: %.3f\n",
              triangles, 1e3 * medians.first, 1e3 * medians.second, medians.first / medians.second);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Megabytes a second at which the disk takes as many bytes in blocks of the size of a chunk.
double raw_write_speed(const std::string& path, std::uintmax_t bytes) {
  const std::vector<char> block(1 << 20, 'x');
  const auto start = std::chrono::steady_clock::now();
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return 0.0;
  std::setvbuf(file, nullptr, _IONBF, 0);
  for (std::uintmax_t written = 0; written < bytes; written += block.size()) {
    std::fwrite(block.data(), 1, block.size(), file);
  }
  std::fclose(file);
  const double time = seconds_since(start);
  std::filesystem::remove(path);
  return 1e-6 * static_cast<double>(bytes) / time;
}

void fly_into_file(const sim::Scene& scene, sim::LidarConfig config,
                   const sim::Trajectory& trajectory, int rings, unsigned threads,
                   const std::string& path) {
  config.beam.rings = rings;
  config.beam.divergence_horizontal = config.beam.divergence_vertical = 0.003;
  config.beam.max_returns = 5;
  std::vector<missions::CloudFile> files;
  files.emplace_back(path, missions::las_format({}));
  const auto start = std::chrono::steady_clock::now();
  const missions::ScanResult result =
      missions::run_scan(scene, sim::Lidar(config), {trajectory, trajectory}, files,
                         {.threads = threads, .report = {}, .stop = {}});
  files[0].finish();
  const double time = seconds_since(start);
  const auto channels = static_cast<double>(config.channels.size());
  const double shots = channels * static_cast<double>(result.progress.firings);
  std::filesystem::remove(path);
  std::printf(
      "          %2d rays a shot, into LAS: %5.2f M shots/s, %5.2f M points/s, %4.0f MB/s; "
      "the disk alone %4.0f MB/s\n",
      1 + 3 * rings * (rings + 1), 1e-6 * shots / time,
      1e-6 * static_cast<double>(result.progress.points) / time,
      1e-6 * static_cast<double>(files[0].bytes()) / time, raw_write_speed(path, files[0].bytes()));
}

/// Level flight over the city, all lasers looking down at it: as an airborne scanner does.
void fly_over_city(unsigned threads, const std::string& path) {
  const geometry::Mesh mesh =
      sim::builtin_model("city-block", {.detail = sim::LevelOfDetail::fine});
  const sim::Scene scene(mesh, threads);
  std::printf("%9zu triangles, a city from 60 m above:\n", mesh.triangles.size());
  sim::LidarConfig config = spinner(64, 2048);
  for (sim::Channel& channel : config.channels) channel.elevation -= 60 * degree;
  const Eigen::Quaterniond level = Eigen::Quaterniond::Identity();
  const auto over = [&](double duration) {
    return sim::Trajectory({{0.0, {-10, 0, 60}, level}, {duration, {10, 0, 60}, level}});
  };
  fly_into_file(scene, config, over(4.0), 0, threads, path);
  fly_into_file(scene, config, over(0.4), 2, threads, path);
}

std::size_t resident_bytes() {
  std::size_t pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void make_scene(std::size_t triangles, unsigned threads) {
  const geometry::Mesh mesh = benchmarks::planet(triangles);
  const std::size_t before = resident_bytes();
  const auto start = std::chrono::steady_clock::now();
  const sim::Scene scene(mesh, threads);
  const double time = seconds_since(start);
  const auto count = static_cast<double>(mesh.triangles.size());
  std::printf("%9zu triangles made ready in %.2f s, %.0f bytes a triangle besides the mesh\n",
              mesh.triangles.size(), time, static_cast<double>(resident_bytes() - before) / count);
}

}  // namespace

int main(int argc, char** argv) {
  unsigned threads = 0;
  int rounds = 15;
  bool is_largest = false;
  std::string file = (std::filesystem::temp_directory_path() / "lidar_benchmark.las").string();
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view option = argv[i];
    if (option == "--threads") threads = static_cast<unsigned>(std::atoi(argv[i + 1]));
    if (option == "--rounds") rounds = std::max(1, std::atoi(argv[i + 1]));
    if (option == "--file") file = argv[i + 1];
    if (option == "--largest") is_largest = std::atoi(argv[i + 1]) != 0;
  }
  for (const std::size_t triangles : {70'000UL, 1'000'000UL}) {
    const sim::Scene scene(benchmarks::planet(triangles), threads);
    compare(scene, triangles, threads, rounds);
    fly_into_file(scene, spinner(64, 2048), flight(2.0), 0, threads, file);
    fly_into_file(scene, spinner(64, 2048), flight(0.2), 2, threads, file);
  }
  fly_over_city(threads, file);
  make_scene(1'000'000, threads);
  if (is_largest) make_scene(30'000'000, threads);
}
