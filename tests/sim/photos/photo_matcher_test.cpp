// The matcher finds the depths of a textured wall, and no depths without texture.
#include "sim/photos/photo_matcher.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/sim/photos/wall.h"

namespace skycap::sim {
namespace {

using Eigen::Vector3d;
using testing::Each;

/// Photos of a wall from positions side by side, and samples on the wall.
struct WallPhotos {
  explicit WallPhotos(double contrast, double spacing = 0.9, int count = 4,
                      const geometry::PhotoCameraConfig& config = small_camera(4))
      : scene(wall_at(5.0)), camera(config) {
    for (int i = 0; i < count; ++i) {
      views.push_back({{spacing * (i - 0.5 * (count - 1)), 0, 0}, Vector3d::UnitY()});
      images.push_back(simulate_photo(
          scene, camera, views.back(),
          {.gsd = 0.018, .contrast = contrast, .noise = 2.0, .seed = std::uint64_t(i) + 1}));
    }
    for (double x = -0.6; x <= 0.6; x += 0.3) {
      for (double z = -0.6; z <= 0.6; z += 0.3) samples.push_back({{x, 5, z}, {0, -1, 0}});
    }
  }

  std::vector<std::uint8_t> right(const MatchOptions& options = {}) const {
    return right_depths(
        samples, images, views, camera,
        [](const geometry::View&, const MatchSample&) { return true; }, options);
  }

  Scene scene;
  geometry::PhotoCamera camera;
  std::vector<geometry::View> views;
  std::vector<GreyImage> images;
  std::vector<MatchSample> samples;
};

TEST(PhotoMatcher, FindsTheDepthsOfATexturedWall) {
  const WallPhotos photos(1.0);
  EXPECT_GE(completeness(photos.right(), 1), 0.99);
  EXPECT_GE(completeness(photos.right(), 3), 0.9) << "of four photos";
  EXPECT_EQ(photos.right({.threads = 1}), photos.right({.threads = 3}));
}

TEST(PhotoMatcher, FindsTheDepthsInDistortedPhotos) {
  geometry::PhotoCameraConfig config = small_camera(4);
  config.distortion = geometry::BrownDistortion{.k1 = 0.5, .p1 = 0.01};
  EXPECT_GE(completeness(WallPhotos(1.0, 0.9, 4, config).right(), 1), 0.95);
}

TEST(PhotoMatcher, FindsNothingWithoutTexture) {
  const WallPhotos photos(0.0);
  EXPECT_LT(completeness(photos.right(), 1), 0.2) << "noise alone must not match";
}

// Two photos at the same position have no parallax. A single photo has no partner.
TEST(PhotoMatcher, NeedsParallax) {
  EXPECT_THAT(WallPhotos(1.0, 0.05, 2).right(), Each(0));
  EXPECT_THAT(WallPhotos(1.0, 1.0, 1).right(), Each(0));
}

// A surface 5 GSD behind its assumed position is not reconstructed.
TEST(PhotoMatcher, RejectsWrongDepths) {
  WallPhotos photos(1.0);
  const double gsd = photos.camera.gsd(5.0);
  for (MatchSample& sample : photos.samples) sample.point.y() -= 5.0 * gsd;
  EXPECT_LT(completeness(photos.right(), 1), 0.05);
  for (MatchSample& sample : photos.samples) sample.point.y() += 4.0 * gsd;
  EXPECT_GT(completeness(photos.right(), 1), 0.9) << "1 GSD is within the tolerance";
}

TEST(PhotoMatcher, AsksWhetherTheSightIsFree) {
  const WallPhotos photos(1.0);
  const auto right = right_depths(
      photos.samples, photos.images, photos.views, photos.camera,
      [&](const geometry::View& view, const MatchSample&) { return view.position.x() < 0.0; });
  EXPECT_THAT(right, Each(testing::Le(2)));
}

}  // namespace
}  // namespace skycap::sim
