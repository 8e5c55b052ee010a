#include "missions/online/live/scan_filter.h"

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "sim/models/masonry/solids.h"
#include "sim/scene/scene.h"
#include "sim/sensors/depth_camera.h"
#include "tests/missions/room_scene.h"

namespace skycap::missions::online {
namespace {

using Pixels = std::set<std::uint32_t>;

/// Room with pillars, seen by a camera of 320 x 240 pixels.
class FlyingPixels : public testing::Test {
 protected:
  static geometry::Mesh pillars() {
    geometry::Mesh mesh = tests::room_mesh({.width = 8.0, .height = 3.0, .wall = 0.2});
    for (const double x : {-1.5, 0.0, 1.7}) {
      geometry::append(mesh, sim::models::box({x, 1.0, 0.0}, {x + 0.3, 1.3, 3.0}));
    }
    return mesh;
  }

  geometry::Scan scan(double noise) {
    sim::DepthCameraConfig config;
    config.camera = {.width = width, .height = 240, .horizontal_fov = 1.05, .vertical_fov = 0.82};
    config.camera.max_range = 20.0;
    config.noise = {.sigma = noise, .direction = sim::NoiseDirection::along_ray, .seed = 3};
    camera_ = geometry::Camera(config.camera);
    return sim::DepthCamera(config).scan(scene_, geometry::look_at({0.2, -3.0, 1.4}, {0, 2, 1.4}),
                                         0, 1);
  }

  /// Moves every fourth edge pixel between a pillar and the wall halfway to the background, as a
  /// mixed pixel.
  static Pixels mix(geometry::Scan& scan) {
    Pixels mixed;
    for (std::size_t i = 1; i + 1 < scan.points.size(); ++i) {
      const double here = compute_depth(scan, i), there = compute_depth(scan, i + 1);
      const bool is_edge = scan.pixels[i] % width > 2 && scan.pixels[i] % width + 3 < width &&
                           std::abs(here - there) > 1.0;
      if (!is_edge || scan.pixels[i] / width % 4 != 0) continue;
      move_to(scan, i, 0.5 * (here + there));
      mixed.insert(scan.pixels[i]);
    }
    return mixed;
  }

  static double compute_depth(const geometry::Scan& scan, std::size_t i) {
    return (scan.world_from_sensor.inverse() * scan.points[i].cast<double>()).z();
  }
  /// Moves a point along its ray.
  static void move_to(geometry::Scan& scan, std::size_t i, double depth) {
    const Eigen::Vector3d ray = scan.points[i].cast<double>() - scan.sensor_position();
    scan.points[i] =
        (scan.sensor_position() + ray * (depth / compute_depth(scan, i))).cast<float>();
  }

  static Pixels missing(const geometry::Scan& before, const geometry::Scan& after) {
    Pixels missing;
    std::ranges::set_difference(before.pixels, after.pixels, std::inserter(missing, missing.end()));
    return missing;
  }

  static constexpr int width = 320;
  sim::Scene scene_{pillars(), 1};
  geometry::Camera camera_{geometry::CameraConfig{}};
};

TEST_F(FlyingPixels, AreRemovedAtEdges) {
  for (const double noise : {0.0, 0.005, 0.01}) {
    geometry::Scan before = scan(noise);
    const Pixels mixed = mix(before);
    ASSERT_GT(mixed.size(), 100U);
    geometry::Scan after = before;
    const LeftOut left_out = remove_flying_pixels(after, camera_);
    const Pixels found = missing(before, after);
    EXPECT_EQ(found.size(), left_out.flying + left_out.isolated);
    const auto right = std::ranges::count_if(mixed, [&](auto p) { return found.contains(p); });
    EXPECT_GT(static_cast<double>(right), 0.95 * static_cast<double>(mixed.size())) << noise;
    const auto wrong = static_cast<double>(std::ssize(found) - right);
    EXPECT_LT(wrong, 0.002 * static_cast<double>(before.points.size())) << noise;
  }
}

TEST_F(FlyingPixels, ExcludeTrueSurfaces) {
  geometry::Scan before = scan(0.0);
  geometry::Scan after = before;
  remove_flying_pixels(after, camera_);
  const auto all = static_cast<double>(before.points.size());
  EXPECT_LT(all - static_cast<double>(after.points.size()), 0.001 * all);
  EXPECT_TRUE(std::ranges::is_sorted(after.pixels));
  ASSERT_EQ(after.points.size(), after.pixels.size());
}

TEST_F(FlyingPixels, AreRemovedWithIsolatedReturns) {
  geometry::Scan before = scan(0.005);
  std::mt19937_64 random(1);
  Pixels stray;
  for (int i = 0; i < 100; ++i) {
    const std::size_t k = random() % before.points.size();
    move_to(before, k, 0.4 * compute_depth(before, k));
    stray.insert(before.pixels[k]);
  }
  geometry::Scan after = before;
  EXPECT_GE(remove_flying_pixels(after, camera_).isolated, stray.size() - 5);
  const Pixels found = missing(before, after);
  const auto right = std::ranges::count_if(stray, [&](auto p) { return found.contains(p); });
  EXPECT_GE(right, std::ssize(stray) - 3);
}

TEST_F(FlyingPixels, RequirePixelIndices) {
  geometry::Scan unorganised = scan(0.0);
  unorganised.pixels.clear();
  const std::size_t count = unorganised.points.size();
  EXPECT_EQ(remove_flying_pixels(unorganised, camera_).flying, 0U);
  EXPECT_EQ(unorganised.points.size(), count);
}

}  // namespace
}  // namespace skycap::missions::online
