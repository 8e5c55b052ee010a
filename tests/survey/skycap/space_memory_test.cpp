#include "survey/skycap/space_memory.h"

#include <random>

#include <gtest/gtest.h>

#include "tests/support/sphere_sensor.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const geometry::Camera camera{geometry::CameraConfig{.width = 424, .height = 240}};
const std::vector<tests::Sphere> ball = {{}};  // radius 0.5 about the origin
constexpr float tolerance = 0.01F;

skycap::SpaceMemory memory_of(const std::vector<Vector3d>& stations, double sigma,
                              bool misses_are_empty,
                              std::size_t most_bytes = skycap::SpaceMemory::usual_size) {
  skycap::SpaceMemory memory(tolerance, misses_are_empty, most_bytes);
  std::uint64_t seed = 1;
  for (const Vector3d& station : stations) {
    const geometry::Scan scan =
        tests::scan_spheres(ball, camera, geometry::look_at(station, {0, 0, 0}), sigma, seed++);
    memory.add(skycap::make_block_image(scan, camera, {.block_px = 4, .jump = 0.1F}),
               static_cast<float>(sigma));
  }
  return memory;
}

std::vector<Vector3f> points_in_ball(float radius, int count) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<float> uniform(-radius, radius);
  std::vector<Vector3f> points;
  while (points.size() < static_cast<std::size_t>(count)) {
    const Vector3f p{uniform(random), uniform(random), uniform(random)};
    if (p.norm() < radius) points.push_back(p);
  }
  return points;
}

const std::vector<Vector3d> around = {{2, 0, 0}, {-2, 0, 0}, {0, 2, 0}, {0, -2, 0.1}, {1, 1, 1.4}};

TEST(SpaceMemory, NeverCallsTheInsideOfASolidEmpty) {
  for (const bool misses_are_empty : {false, true}) {
    const skycap::SpaceMemory clean = memory_of(around, 0.0, misses_are_empty);
    // Ranges are kept in single precision of a few tenths of a millimetre.
    for (const Vector3f& p : points_in_ball(0.499F, 20000)) {
      ASSERT_NE(clean.query(p), skycap::SpaceState::empty) << p.transpose();
    }
    // Noisy depths of sixteen pixels scatter by a quarter of sigma about their mean; 3 cm inside is
    // beyond the worst of a hundred thousand.
    const skycap::SpaceMemory noisy = memory_of(around, 0.01, misses_are_empty);
    for (const Vector3f& p : points_in_ball(0.47F, 20000)) {
      ASSERT_NE(noisy.query(p), skycap::SpaceState::empty) << p.transpose();
    }
  }
}

TEST(SpaceMemory, TellsEmptyMeasuredAndUnknownApart) {
  const skycap::SpaceMemory memory = memory_of({{2, 0, 0}}, 0.0, false);
  EXPECT_EQ(memory.query({1.0F, 0, 0}), skycap::SpaceState::empty);  // between sensor and ball
  EXPECT_EQ(memory.query({0.5F, 0, 0}), skycap::SpaceState::measured);
  EXPECT_EQ(memory.query({0, 0, 0}), skycap::SpaceState::unknown);      // inside
  EXPECT_EQ(memory.query({-1.0F, 0, 0}), skycap::SpaceState::unknown);  // behind
  EXPECT_EQ(memory.query({1.0F, 0, 0.3F}),
            skycap::SpaceState::unknown);                              // on a ray without a return
  EXPECT_EQ(memory.query({3.0F, 0, 0}), skycap::SpaceState::unknown);  // behind the sensor
}

TEST(SpaceMemory, RaysWithoutAReturnProveEmptySpaceOnlyIfToldSo) {
  const skycap::SpaceMemory memory = memory_of({{2, 0, 0}}, 0.0, true);
  EXPECT_EQ(memory.query({1.0F, 0, 0.35F}), skycap::SpaceState::empty);
  EXPECT_FALSE(memory.is_proven_empty({1.0F, 0, 0.35F}, 0.02F));
}

TEST(SpaceMemory, ABallIsProvenEmptyOnlyInFrontOfReturns) {
  const skycap::SpaceMemory memory = memory_of({{2, 0, 0}}, 0.0, true);
  EXPECT_TRUE(memory.is_proven_empty({1.0F, 0, 0}, 0.1F));
  EXPECT_FALSE(memory.is_proven_empty({0.55F, 0, 0}, 0.1F));  // reaches into the ball
  EXPECT_FALSE(memory.is_proven_empty({1.0F, 0, 0}, 0.4F));   // reaches beyond its outline
  EXPECT_FALSE(memory.is_proven_empty({-1.0F, 0, 0}, 0.1F));
}

/// Many looks at one side, and one at the other side long before.
TEST(SpaceMemory, ForgetsWhatOthersShowAsWell) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-0.1, 0.1);
  std::vector<Vector3d> stations = {{-2, 0, 0}, {0, 2, 0}};
  for (int i = 0; i < 40; ++i) {
    Vector3d station(2, 0, 0);
    for (double& coordinate : station) coordinate += uniform(random);
    stations.push_back(station);
  }
  constexpr std::size_t size_of_one = std::size_t{106} * 60 * 3 * sizeof(float);
  const skycap::SpaceMemory all = memory_of(stations, 0.0, false);
  const skycap::SpaceMemory few = memory_of(stations, 0.0, false, 12 * size_of_one);
  EXPECT_EQ(all.bytes(), stations.size() * size_of_one);
  EXPECT_EQ(few.bytes(), 12 * size_of_one);
  EXPECT_EQ(few.image_count(), stations.size());
  for (const Vector3f& p : {Vector3f(-1, 0, 0), Vector3f(0, 1, 0), Vector3f(1, 0, 0)}) {
    EXPECT_EQ(few.query(p), skycap::SpaceState::empty) << p.transpose();
    EXPECT_TRUE(few.is_proven_empty(p, 0.1F));
  }
  EXPECT_EQ(few.query({-1, 0, 0}, 1), skycap::SpaceState::unknown);  // the first one is not asked
  for (const Vector3f& p : points_in_ball(0.499F, 2000)) {
    ASSERT_NE(few.query(p), skycap::SpaceState::empty);
  }
}

TEST(SpaceMemory, KeepsTheNewestHoweverLittleItMayKeep) {
  const skycap::SpaceMemory memory = memory_of(around, 0.0, false, 1);
  EXPECT_EQ(memory.image_count(), around.size());
  EXPECT_EQ(memory.query({0.6F, 0.6F, 0.84F}), skycap::SpaceState::empty);
  EXPECT_EQ(memory.query({1.0F, 0, 0}), skycap::SpaceState::unknown);
}

}  // namespace
}  // namespace skycap::survey
