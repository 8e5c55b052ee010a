/// Benchmark of a moving LiDAR. Complete scans are compared with Embree casting the same rays.
/// Flights written to a LAS file are compared with Embree and with the time to write the same
/// number of bytes. The construction of scenes is timed as well.
///
///   lidar_benchmark [--threads N] [--rounds N] [--file FILE.las] [--only turns|flights|scenes]
/// [--largest 1]
///
/// The platform flies at 10 m/s inside a hilly sphere, 600 m above a town of one million triangles
/// like an airborne scanner, and above the built-in city. The Embree loop reads precomputed rays
/// from memory in packets of the same shape, and stores only their distances. Skycap's casting of
/// these rays is also compared with Embree, because bit-identical results on every processor have a
/// cost. --largest adds the construction of a scene of 30 million triangles.

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
#include "missions/scan/las_format.h"
#include "missions/scan/scan_runner.h"
#include "sim/models/models.h"
#include "sim/sensors/echo.h"
#include "sim/sensors/lidar.h"
#include "sim/sensors/lidar_rays.h"
#include "sim/sensors/scan_pattern.h"
#include "tests/benchmarks/embree_packets.h"
#include "tests/benchmarks/interleaved.h"
#include "tests/benchmarks/planet.h"
#include "tests/benchmarks/town.h"

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

/// Returns the rays of one revolution in slot order, with the rays of each beam next to each other.
sim::Rays all_rays(const sim::LidarConfig& config, const sim::Trajectory& trajectory,
                   const Eigen::Vector3d& centre, std::uint64_t blocks) {
  const sim::ScanPattern pattern(config);
  const std::vector<sim::BeamSample> beam = sim::beam_samples(config.beam.rings);
  sim::Rays rays;
  rays.resize(blocks * pattern.slots() * beam.size());
  sim::Pulses pulses;
  std::size_t next = 0;
  for (std::uint64_t block = 0; block < blocks; ++block) {
    pattern.aim(block, pulses);
    for (std::size_t slot = 0; slot < pattern.slots(); ++slot) {
      const std::size_t firing = slot / 4 / config.channels.size() * 4 + slot % 4;
      const Eigen::Isometry3d pose =
          trajectory.pose(static_cast<double>(block * 32 + firing) * config.firing_period);
      const Eigen::Vector3f from = (pose.translation() - centre).cast<float>();
      const Eigen::Vector3f axis =
          pose.linear().cast<float>() * Eigen::Vector3f(pulses.direction[0][slot],
                                                        pulses.direction[1][slot],
                                                        pulses.direction[2][slot]);
      const auto [horizontal, vertical] = sim::across(axis, pose.linear().col(2).cast<float>());
      for (const sim::BeamSample& sample : beam) {
        const Eigen::Vector3f aside = static_cast<float>(0.5 * config.beam.divergence_horizontal) *
                                      (sample.horizontal * horizontal + sample.vertical * vertical);
        rays.set_direction(next, (axis + aside).normalized());
        for (int i = 0; i < 3; ++i) rays.origin[i][next] = from[i];
        ++next;
      }
    }
  }
  return rays;
}

template <int width>
void cast_packets(const benchmarks::EmbreeMesh& mesh, const sim::Rays& rays, std::size_t begin,
                  std::size_t end, float reach, float* ranges) {
  benchmarks::EmbreePacket<width> packet;
  auto& ray = packet.rays.ray;
  for (std::size_t first = begin; first < end; first += width) {
    std::memcpy(ray.org_x, &rays.origin[0][first], sizeof ray.org_x);
    std::memcpy(ray.org_y, &rays.origin[1][first], sizeof ray.org_y);
    std::memcpy(ray.org_z, &rays.origin[2][first], sizeof ray.org_z);
    std::memcpy(ray.dir_x, &rays.direction[0][first], sizeof ray.dir_x);
    std::memcpy(ray.dir_y, &rays.direction[1][first], sizeof ray.dir_y);
    std::memcpy(ray.dir_z, &rays.direction[2][first], sizeof ray.dir_z);
    packet.cast(mesh, reach);
    std::memcpy(ranges + first, ray.tfar, sizeof ray.tfar);
  }
}

/// Casts the rays on all threads, chunk by chunk, without a sensor model.
class BareLoop {
 public:
  BareLoop(const geometry::Mesh& mesh, const sim::Scene& scene, const sim::LidarConfig& config,
           const sim::Trajectory& trajectory, std::uint64_t blocks, unsigned threads)
      : mesh_(mesh, threads),
        scene_(scene),
        threads_(threads),
        reach_(static_cast<float>(config.max_range)),
        rays_(all_rays(config, trajectory, mesh_.centre, blocks)),
        ranges_(rays_.origin[0].size()) {}

  std::size_t rays() const { return ranges_.size(); }
  /// Casts with Embree.
  void operator()() {
    in_chunks([&](std::size_t begin, std::size_t end) {
      mesh_.with_packet_width([&]<int width>() {
        cast_packets<width>(mesh_, rays_, begin, end, reach_, ranges_.data());
      });
    });
  }
  /// Casts with Skycap's kernels, including the normals and triangles that returns need.
  void cast_own() {
    in_chunks([&](std::size_t begin, std::size_t end) {
      constexpr int width = sim::RayPacket::width;
      sim::RayPacket packet;
      for (std::size_t first = begin; first < end; first += width) {
        for (int axis = 0; axis < 3; ++axis) {
          std::copy_n(&rays_.origin[axis][first], width, packet.origin[axis]);
          std::copy_n(&rays_.direction[axis][first], width, packet.direction[axis]);
        }
        sim::ray_kernels().cast(scene_.trees().target, packet, sim::RayPacket::all_lanes, reach_);
        std::copy_n(packet.distance, width, &ranges_[first]);
      }
    });
  }

 private:
  template <typename Cast>
  void in_chunks(const Cast& cast) const {
    constexpr std::size_t chunks = 16;
    const std::size_t size = ranges_.size() / chunks;
    geometry::parallel_for(chunks, threads_,
                           [&](std::size_t i) { cast(i * size, (i + 1) * size); });
  }

  benchmarks::EmbreeMesh mesh_;
  const sim::Scene& scene_;
  unsigned threads_;
  float reach_;
  sim::Rays rays_;
  std::vector<float> ranges_;
};

void compare(const geometry::Mesh& mesh, unsigned threads, int rounds) {
  const sim::Scene scene(mesh, threads);
  const sim::LidarConfig config = spinner(64, 1024);
  const sim::Trajectory trajectory = flight(0.1);
  const sim::Lidar lidar(config);
  const sim::LidarFlight lidar_flight{trajectory, trajectory};
  constexpr std::uint64_t blocks = 32, blocks_per_chunk = 2;
  BareLoop bare(mesh, scene, config, trajectory, blocks, threads);
  std::vector<sim::LidarReturns> chunks(blocks / blocks_per_chunk);
  const auto whole = [&] {
    geometry::parallel_for(chunks.size(), threads, [&](std::size_t i) {
      chunks[i] =
          lidar.measure(scene, lidar_flight, {i * 32 * blocks_per_chunk, 32 * blocks_per_chunk},
                        std::move(chunks[i]));
    });
  };
  const auto medians = benchmarks::interleaved_medians(rounds, whole, [&] { bare(); });
  std::printf("%9zu triangles, a turn of 64 x 1024: %6.2f ms, bare packets %6.2f ms: %.3f\n",
              mesh.triangles.size(), 1e3 * medians.first, 1e3 * medians.second,
              medians.first / medians.second);
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Returns the write speed of the disk [MB/s] for the same number of bytes in chunk-sized blocks.
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

/// Terrain below the flight.
struct Ground {
  Ground(geometry::Mesh surface, unsigned threads)
      : mesh(std::move(surface)), scene(mesh, threads) {}
  geometry::Mesh mesh;
  sim::Scene scene;
};

/// Times flights of `turns` revolutions and the ray casting of one revolution.
void fly_into_file(const Ground& ground, sim::LidarConfig config, const Eigen::Vector3d& from,
                   int turns, int rings, unsigned threads, int rounds, const std::string& path) {
  config.beam.rings = rings;
  config.beam.divergence_horizontal = config.beam.divergence_vertical = 0.0005;
  config.beam.max_returns = 5;
  const double duration = 0.1 * turns;
  const Eigen::Quaterniond level = Eigen::Quaterniond::Identity();
  const Eigen::Vector3d to = from + Eigen::Vector3d(10.0 * duration, 0, 0);
  const sim::Trajectory trajectory({{0.0, from, level}, {duration, to, level}});
  const sim::Lidar lidar(config);
  missions::scan::ScanResult result;
  std::uint64_t bytes = 0;
  const auto whole = [&] {
    std::vector<missions::scan::CloudFile> files;
    files.emplace_back(path, missions::scan::las_format({}));
    result = missions::scan::run_scan(ground.scene, lidar, {trajectory, trajectory}, files,
                                      {.threads = threads, .report = {}, .stop = {}});
    files[0].finish();
    bytes = files[0].bytes();
  };
  BareLoop bare(ground.mesh, ground.scene, config, trajectory,
                lidar.firings(trajectory) / (32U * turns), threads);
  const auto medians = benchmarks::interleaved_medians(rounds, whole, [&] { bare(); });
  const auto casting = benchmarks::interleaved_medians(
      rounds, [&] { bare.cast_own(); }, [&] { bare(); });
  std::filesystem::remove(path);
  const auto channels = static_cast<double>(config.channels.size());
  const double pulses = channels * static_cast<double>(result.progress.firings);
  const double samples = 1 + 3 * rings * (rings + 1);
  const double bare_pulses = static_cast<double>(bare.rays()) / samples;
  const benchmarks::Medians in_file{medians.first / pulses, medians.second / bare_pulses};
  std::printf(
      "          %2.0f rays a shot, into LAS: %5.2f M shots/s, %4.2f points a shot; bare packets "
      "%5.2f M shots/s: %.3f; casting alone %.3f, so the whole %.3f; %4.0f MB/s, the disk alone "
      "%4.0f MB/s\n",
      samples, 1e-6 * pulses / medians.first, static_cast<double>(result.progress.points) / pulses,
      1e-6 * bare_pulses / medians.second, in_file.first / in_file.second,
      casting.first / casting.second, benchmarks::compute_own_casting_cost(in_file, casting),
      1e-6 * static_cast<double>(bytes) / medians.first, raw_write_speed(path, bytes));
}

void fly_both(const Ground& ground, const sim::LidarConfig& config, const Eigen::Vector3d& from,
              unsigned threads, int rounds, const std::string& path) {
  fly_into_file(ground, config, from, 10, 0, threads, rounds, path);
  fly_into_file(ground, config, from, 1, 2, threads, rounds, path);
}

/// Times level flights over built-up terrain, from an altitude at which one revolution sees all of
/// it, and from 60 m.
void fly_over_towns(unsigned threads, int rounds, const std::string& path) {
  sim::LidarConfig high = spinner(64, 2048), low = high;
  high.max_range = 1000.0;
  for (std::size_t i = 0; i < 64; ++i) {
    high.channels[i].elevation = (-79.5 - 10.0 * static_cast<double>(i) / 63) * degree;
    low.channels[i].elevation -= 60 * degree;
  }
  const Ground town(benchmarks::town(1'000'000), threads);
  std::printf("%9zu triangles, a town from 600 m above:\n", town.mesh.triangles.size());
  fly_both(town, high, {-5, 0, 600}, threads, rounds, path);
  const Ground city(sim::builtin_model("city-block", {.detail = sim::LevelOfDetail::fine}),
                    threads);
  std::printf("%9zu triangles, the builtin city from 60 m above:\n", city.mesh.triangles.size());
  fly_both(city, low, {-5, 0, 60}, threads, rounds, path);
}

std::size_t resident_bytes() {
  std::size_t pages = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> pages >> resident;
  return resident * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void make_scene(std::size_t triangles, unsigned threads, int rounds) {
  const geometry::Mesh mesh = benchmarks::planet(triangles);
  const std::size_t before = resident_bytes();
  std::size_t bytes = 0;
  const auto [time, bare_time] = benchmarks::interleaved_medians(
      rounds,
      [&] {
        const sim::Scene scene(mesh, threads);
        if (bytes == 0) bytes = resident_bytes() - before;
      },
      [&] { const benchmarks::EmbreeMesh bare(mesh, threads); });
  const auto count = static_cast<double>(mesh.triangles.size());
  std::printf(
      "%9zu triangles made ready in %.2f s, %.0f bytes a triangle besides the mesh; bare Embree "
      "%.2f s: %.2f\n",
      mesh.triangles.size(), time, static_cast<double>(bytes) / count, bare_time, time / bare_time);
}

}  // namespace

int main(int argc, char** argv) {
  unsigned threads = 0;
  int rounds = 15;
  bool is_largest = false;
  std::string_view only;
  std::string file = (std::filesystem::temp_directory_path() / "lidar_benchmark.las").string();
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string_view option = argv[i];
    if (option == "--threads") threads = static_cast<unsigned>(std::atoi(argv[i + 1]));
    if (option == "--rounds") rounds = std::max(1, std::atoi(argv[i + 1]));
    if (option == "--file") file = argv[i + 1];
    if (option == "--only") only = argv[i + 1];
    if (option == "--largest") is_largest = std::atoi(argv[i + 1]) != 0;
  }
  const auto is_asked = [&](std::string_view part) { return only.empty() || only == part; };
  for (const std::size_t triangles : {70'000UL, 1'000'000UL}) {
    if (!is_asked("turns")) break;
    compare(benchmarks::planet(triangles), threads, rounds);
  }
  if (is_asked("flights")) {
    const Ground planet(benchmarks::planet(1'000'000), threads);
    std::printf("  1000000 triangles, inside a hilly sphere:\n");
    fly_both(planet, spinner(64, 2048), {-2, 3, 1}, threads, rounds, file);
    fly_over_towns(threads, rounds, file);
  }
  if (is_asked("scenes")) make_scene(1'000'000, threads, std::min(rounds, 5));
  if (is_largest) make_scene(30'000'000, threads, 1);
}
