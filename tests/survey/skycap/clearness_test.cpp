#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "survey/skycap/unseen_surface.h"
#include "tests/support/sphere_sensor.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const geometry::Camera camera{geometry::CameraConfig{}};
const std::vector<tests::Sphere> ball = {{}};
constexpr float scale = 0.3F;

/// What was seen of a ball of radius 0.5 at the origin.
struct Seen {
  skycap::SpaceMemory space{0.012F, true};
  void look_from(const Vector3d& station) {
    space.add(skycap::make_block_image(
                  tests::scan_spheres(ball, camera, geometry::look_at(station, {0, 0, 0})), camera,
                  {.block_px = 4, .jump = 0.06F}),
              0.0F);
  }
};

std::vector<skycap::UnseenPatch> patches_at(const std::vector<Vector3f>& places) {
  std::vector<skycap::UnseenPatch> patches;
  for (const Vector3f& place : places) {
    patches.push_back({place, Vector3f::UnitX(), 0.02F, 1.0F, 0, patches.size()});
  }
  return patches;
}

TEST(Clearness, IsOneBeforeAllThatIsKnown) {
  Seen seen;
  seen.look_from({2, 0, 0});
  const auto patches = patches_at({{0.55F, 0, 0}});
  skycap::Clearness clearness(scale);
  clearness.update(patches, seen.space);
  EXPECT_EQ(clearness.of(0, {2, 0, 0}), 1.0F);
}

// The whole stretch before a place in the ball's shadow is unknown from behind.
TEST(Clearness, FallsWithUnknownSpaceOnTheWay) {
  Seen seen;
  seen.look_from({2, 0, 0});
  const auto patches = patches_at({{-0.55F, 0, 0}, {0, 0.45F, 0}});
  skycap::Clearness clearness(scale);
  clearness.update(patches, seen.space);
  EXPECT_NEAR(clearness.of(0, {-2, 0, 0}), std::exp(-3.0F), 1e-6F);
  // From the side the shadow ends soon.
  EXPECT_GT(clearness.of(1, {0, 2, 0}), 2.0F * clearness.of(0, {-2, 0, 0}));
  EXPECT_LT(clearness.of(1, {0, 2, 0}), 1.0F);
}

TEST(Clearness, IsOneWithoutMemoryAndForWhatAPriorTells) {
  const Seen nothing;
  auto patches = patches_at({{0, 0, 0}});
  skycap::Clearness clearness(scale);
  clearness.update(patches, nothing.space);
  EXPECT_EQ(clearness.of(0, {1, 0, 0}), 1.0F);
  Seen seen;
  seen.look_from({2, 0, 0});
  patches[0].kind = skycap::prior_kind;
  clearness.update(patches, seen.space);
  EXPECT_EQ(clearness.of(0, {-1, 0, 0}), 1.0F);
}

// Twin: one is asked after every scan, with other patches before and beside; the other only once.
TEST(Clearness, AsksOnlyWhatIsNewWithTheSameAnswers) {
  Seen seen;
  const std::vector<Vector3f> places = {
      {-0.55F, 0, 0}, {0, 0.55F, 0}, {0, 0, -0.52F}, {0.3F, -0.5F, 0.1F}};
  const std::vector<Vector3f> sensors = {
      {-2, 0, 0}, {0, 2, 0.3F}, {1, -1, 1}, {0.2F, 0.1F, -2}, {2, 0, 0}};
  skycap::Clearness old(scale);
  int between = 0;
  for (const Vector3d& station :
       {Vector3d(2, 0, 0), Vector3d(0, 2, 0), Vector3d(-1.2, -1.2, 0), Vector3d(0, 0, -2)}) {
    seen.look_from(station);
    auto patches = patches_at(places);
    // Another order, other names, one that moved.
    std::rotate(patches.begin(), patches.begin() + 1, patches.end());
    patches[0].position.x() += 0.01F * static_cast<float>(seen.space.image_count());
    old.update(patches, seen.space);
    skycap::Clearness anew(scale);
    anew.update(patches, seen.space);
    for (std::size_t i = 0; i < patches.size(); ++i) {
      for (const Vector3f& sensor : sensors) {
        EXPECT_EQ(old.of(i, sensor), anew.of(i, sensor));
        between += old.of(i, sensor) < 0.99F && old.of(i, sensor) > 0.06F ? 1 : 0;
      }
    }
  }
  EXPECT_GT(between, 5);
}

}  // namespace
}  // namespace skycap::survey
