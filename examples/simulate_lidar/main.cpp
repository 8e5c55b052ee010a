// Simulates a laser scanner with 16 lasers that moves past a teapot, and processes the returns in a
// buffer.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <vector>

#include <skycap/sim/lidar.h>
#include <skycap/sim/models.h>

using namespace skycap;

struct MyPoint {
  double x, y, z;
  float intensity;
};

int main() {
  const geometry::Mesh mesh = sim::builtin_model("teapot");
  const sim::Scene scene(mesh);

  sim::LidarConfig config;
  config.firing_period = 1e-4;
  config.rotation_rate = 10.0;
  config.channels.clear();
  for (int laser = 0; laser < 16; ++laser) {
    config.channels.push_back({.elevation = (laser - 7.5) * 2.0 * std::numbers::pi / 180.0});
  }
  config.errors.sigma = 0.01;  // [m]
  const sim::Lidar lidar(config);

  // 0.5 s along x, 8 m in front of the scene.
  const sim::Trajectory path(
      {{.time = 0.0, .position = {-1.0, -8.0, 1.5}}, {.time = 0.5, .position = {1.0, -8.0, 1.5}}});
  const sim::LidarFlight flight{.ground_truth = path, .estimated = path};

  std::vector<MyPoint> buffer;
  const std::uint64_t firings = lidar.firings(path);
  // Number of firings; a small chunk limits the memory for flights of any length.
  constexpr std::uint64_t chunk = 1024;
  sim::LidarReturns returns;
  for (std::uint64_t first = 0; first < firings; first += chunk) {
    returns =
        lidar.measure(scene, flight, {first, std::min(chunk, firings - first)}, std::move(returns));
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const Eigen::Vector3d point = returns.origin + returns.points[i].cast<double>();
      buffer.push_back({point.x(), point.y(), point.z(), returns.intensities[i]});
    }
  }
  std::printf("%zu returns from %zu pulses\n", buffer.size(),
              static_cast<std::size_t>(firings) * config.channels.size());
  return buffer.empty() ? 1 : 0;
}
