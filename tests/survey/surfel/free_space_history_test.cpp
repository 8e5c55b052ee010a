#include "survey/surfel/free_space_history.h"

#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/sphere_sensor.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const geometry::Camera camera{geometry::CameraConfig{.width = 424, .height = 240}};
const std::vector<tests::Sphere> ball = {{}};  // radius 0.5 around the origin
constexpr float tolerance = 0.01F;

surfel::FreeSpaceHistory make_history(
    const std::vector<Vector3d>& viewpoints, double sigma, bool misses_are_empty,
    std::size_t max_bytes = surfel::FreeSpaceHistory::usual_size) {
  surfel::FreeSpaceHistory history(tolerance, misses_are_empty, {}, max_bytes);
  std::uint64_t seed = 1;
  for (const Vector3d& viewpoint : viewpoints) {
    const geometry::Scan scan =
        tests::scan_spheres(ball, camera, geometry::look_at(viewpoint, {0, 0, 0}), sigma, seed++);
    history.add(surfel::make_block_image(scan, camera, {.block_px = 4, .jump = 0.1F}),
                static_cast<float>(sigma));
  }
  return history;
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

TEST(FreeSpaceHistory, NeverMarksInsideOfSolidAsEmpty) {
  for (const bool misses_are_empty : {false, true}) {
    const surfel::FreeSpaceHistory clean = make_history(around, 0.0, misses_are_empty);
    // Ranges have single precision with an error of a few tenths of a millimetre.
    for (const Vector3f& p : points_in_ball(0.499F, 20000)) {
      ASSERT_NE(clean.query(p), surfel::SpaceState::empty) << p.transpose();
    }
    // The mean of sixteen noisy depths has a standard deviation of a quarter of sigma. 3 cm inside
    // exceeds the worst of a hundred thousand.
    const surfel::FreeSpaceHistory noisy = make_history(around, 0.01, misses_are_empty);
    for (const Vector3f& p : points_in_ball(0.47F, 20000)) {
      ASSERT_NE(noisy.query(p), surfel::SpaceState::empty) << p.transpose();
    }
  }
}

TEST(FreeSpaceHistory, DistinguishesEmptyMeasuredAndUnknown) {
  const surfel::FreeSpaceHistory history = make_history({{2, 0, 0}}, 0.0, false);
  EXPECT_EQ(history.query({1.0F, 0, 0}), surfel::SpaceState::empty);  // between sensor and ball
  EXPECT_EQ(history.query({0.5F, 0, 0}), surfel::SpaceState::measured);
  EXPECT_EQ(history.query({0, 0, 0}), surfel::SpaceState::hidden);      // inside
  EXPECT_EQ(history.query({-1.0F, 0, 0}), surfel::SpaceState::hidden);  // behind
  EXPECT_EQ(history.query({1.0F, 0, 0.3F}),
            surfel::SpaceState::hidden);                                // on a no-return ray
  EXPECT_EQ(history.query({3.0F, 0, 0}), surfel::SpaceState::outside);  // behind the sensor
}

TEST(FreeSpaceHistory, MarksNoReturnRaysAsEmptyOnlyWhenConfigured) {
  const surfel::FreeSpaceHistory history = make_history({{2, 0, 0}}, 0.0, true);
  EXPECT_EQ(history.query({1.0F, 0, 0.35F}), surfel::SpaceState::empty);
  EXPECT_FALSE(history.is_verified_empty({1.0F, 0, 0.35F}, 0.02F));
}

// Beyond the range, a ray without a return proves nothing, and nothing is hidden.
TEST(FreeSpaceHistory, KnowsNothingBeyondTheRange) {
  const geometry::View view = geometry::look_at({2, 0, 0}, {0, 0, 0});
  for (const bool has_radial_range : {false, true}) {
    surfel::FreeSpaceHistory history(tolerance, true, {.min = 0.2F, .max = 2.0F});
    surfel::BlockImage image = surfel::make_block_image(tests::scan_spheres(ball, camera, view),
                                                        camera, {.block_px = 4, .jump = 0.1F});
    image.has_radial_range = has_radial_range;
    history.add(image, 0.0F);
    EXPECT_EQ(history.query({0.1F, 0.55F, 0}), surfel::SpaceState::empty);
    EXPECT_EQ(history.query({-0.1F, 0.9F, 0}), surfel::SpaceState::outside);
    EXPECT_EQ(history.query({1.9F, 0.05F, 0}), surfel::SpaceState::outside);  // too near
    EXPECT_EQ(history.query({1.9F, 0, 0}), surfel::SpaceState::empty);        // before a return
    EXPECT_EQ(history.query({1.0F, 0, 0}), surfel::SpaceState::empty);
    EXPECT_EQ(history.query({0.2F, 0, 0}), surfel::SpaceState::hidden);
    EXPECT_EQ(history.query({-0.2F, 0, 0}), surfel::SpaceState::outside);
    // The depth is less than the range, the distance is more.
    EXPECT_EQ(history.query({0.05F, 0.9F, 0}),
              has_radial_range ? surfel::SpaceState::outside : surfel::SpaceState::empty);
  }
}

/// Returns points next to the ball, on no-return rays of a sensor at (2, 0, 0), closer than some of
/// the returns.
std::vector<Vector3f> offset_points(int count) {
  std::vector<Vector3f> points;
  for (int i = 0; i < count; ++i) {
    points.emplace_back(0.3F, 0.7F + 0.3F * static_cast<float>(i) / static_cast<float>(count), 0);
  }
  return points;
}

TEST(FreeSpaceHistory, LimitsMissesToFacingSurfacesAfterFalseMisses) {
  surfel::FreeSpaceHistory history = make_history({{2, 0, 0}}, 0.0, true);
  const Vector3f beside(0.3F, 0.8F, 0), before(1, 0, 0);
  const Vector3f front = Vector3f::UnitX(), back = -front, side = Vector3f::UnitZ();
  for (const Vector3f& normal : {front, back, side}) {
    EXPECT_EQ(history.query_surface(beside, normal), surfel::SpaceState::empty);
  }
  const std::vector<Vector3f> points = offset_points(40);
  history.compare_misses(points, std::vector<Vector3f>(points.size(), front));
  ASSERT_TRUE(history.has_false_misses());
  EXPECT_EQ(history.query_surface(beside, front), surfel::SpaceState::empty);
  EXPECT_EQ(history.query_surface(beside, back), surfel::SpaceState::hidden);
  EXPECT_EQ(history.query_surface(beside, side), surfel::SpaceState::hidden);
  EXPECT_EQ(history.query(beside), surfel::SpaceState::empty);  // if no side is specified
  // Space in front of a return is empty for both orientations.
  EXPECT_EQ(history.query_surface(before, back), surfel::SpaceState::empty);
}

TEST(FreeSpaceHistory, DetectsFalseMissesOnlyFromManyPoints) {
  const Vector3f front = Vector3f::UnitX(), side = Vector3f::UnitZ();
  const auto finds_false_misses = [](const std::vector<Vector3f>& points, const Vector3f& normal) {
    surfel::FreeSpaceHistory history = make_history({{2, 0, 0}}, 0.0, true);
    history.compare_misses(points, std::vector<Vector3f>(points.size(), normal));
    return history.has_false_misses();
  };
  EXPECT_FALSE(finds_false_misses(points_in_ball(0.499F, 2000), front));  // behind the returns
  EXPECT_FALSE(finds_false_misses(offset_points(20), front));             // noise or a wire
  EXPECT_FALSE(finds_false_misses(offset_points(40), side));              // edge-on: rays miss it
  std::vector<Vector3f> far = offset_points(40);
  for (Vector3f& point : far) point.x() -= 2.0F;
  EXPECT_FALSE(finds_false_misses(far, front));  // beyond all returns, possibly out of range
  std::vector<Vector3f> mixed = points_in_ball(0.499F, 100000);
  for (const Vector3f& point : offset_points(40)) mixed.push_back(point);
  EXPECT_FALSE(finds_false_misses(mixed, front));  // below 0.1 to 0.2%
}

/// Reference: one history compares after each scan, the other compares everything at the end.
TEST(FreeSpaceHistory, ComparesEachPointWithEachImageOnce) {
  const std::vector<Vector3f> points = offset_points(40);
  const std::vector<Vector3f> normals(points.size(), Vector3f::UnitX());
  for (const std::size_t known : {std::size_t{0}, std::size_t{15}, std::size_t{29}}) {
    surfel::FreeSpaceHistory history = make_history({{2, 0, 0}}, 0.0, true);
    history.compare_misses(std::span(points).first(known), std::span(normals).first(known));
    history.compare_misses(std::span(points).first(29), std::span(normals).first(29));
    EXPECT_FALSE(history.has_false_misses()) << known;
    history.compare_misses(std::span(points).first(29), std::span(normals).first(29));
    EXPECT_FALSE(history.has_false_misses()) << known;
    history.compare_misses(std::span(points).first(30), std::span(normals).first(30));
    EXPECT_TRUE(history.has_false_misses()) << known;
  }
}

TEST(FreeSpaceHistory, VerifiesBallsAsEmptyOnlyInFrontOfReturns) {
  const surfel::FreeSpaceHistory history = make_history({{2, 0, 0}}, 0.0, true);
  EXPECT_TRUE(history.is_verified_empty({1.0F, 0, 0}, 0.1F));
  EXPECT_FALSE(history.is_verified_empty({0.55F, 0, 0}, 0.1F));  // extends into the ball
  // Extends beyond the outline of the ball.
  EXPECT_FALSE(history.is_verified_empty({1.0F, 0, 0}, 0.4F));
  EXPECT_FALSE(history.is_verified_empty({-1.0F, 0, 0}, 0.1F));
}

// A wall of large spheres is 1.5 m in front of two cameras whose images overlap. Neither image
// contains the whole ball between them.
TEST(FreeSpaceHistory, VerifiesBallsAsEmptyFromSeveralScans) {
  const std::vector<tests::Sphere> wall = {{.centre = {51.5, 0, 0}, .radius = 50.0}};
  surfel::FreeSpaceHistory history(tolerance, true);
  for (const double side : {-0.4, 0.4}) {
    const geometry::View view{{0, side, 0}, {1, 0, 0}};
    history.add(surfel::make_block_image(tests::scan_spheres(wall, camera, view), camera,
                                         {.block_px = 4, .jump = 0.1F}),
                0.0F);
  }
  const Vector3f between(0.9F, 0, 0);
  EXPECT_FALSE(history.is_verified_empty(between, 0.15F));
  EXPECT_TRUE(history.is_jointly_verified_empty(between, 0.15F));
  EXPECT_FALSE(history.is_jointly_verified_empty({1.4F, 0, 0}, 0.15F));     // extends into the wall
  EXPECT_FALSE(history.is_jointly_verified_empty({0.9F, 0, 0.2F}, 0.15F));  // above the images
  int verified = 0;
  for (const Vector3f& p : points_in_ball(1.6F, 4000)) {
    if (!history.is_jointly_verified_empty(p, 0.1F)) continue;
    ++verified;
    EXPECT_GE((p.cast<double>() - wall[0].centre).norm(), wall[0].radius + 0.1 - 0.001);
    EXPECT_GE(p.x(), 0.1F);
  }
  EXPECT_GT(verified, 100);
}

/// Many observations of one side, after one early observation of the other side.
TEST(FreeSpaceHistory, RemovesRedundantImages) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-0.1, 0.1);
  std::vector<Vector3d> viewpoints = {{-2, 0, 0}, {0, 2, 0}};
  for (int i = 0; i < 40; ++i) {
    Vector3d viewpoint(2, 0, 0);
    for (double& coordinate : viewpoint) coordinate += uniform(random);
    viewpoints.push_back(viewpoint);
  }
  constexpr std::size_t image_size = std::size_t{106} * 60 * 3 * sizeof(float);
  const surfel::FreeSpaceHistory all = make_history(viewpoints, 0.0, false);
  const surfel::FreeSpaceHistory few = make_history(viewpoints, 0.0, false, 12 * image_size);
  EXPECT_EQ(all.bytes(), viewpoints.size() * image_size);
  EXPECT_EQ(few.bytes(), 12 * image_size);
  EXPECT_EQ(few.image_count(), viewpoints.size());
  for (const Vector3f& p : {Vector3f(-1, 0, 0), Vector3f(0, 1, 0), Vector3f(1, 0, 0)}) {
    EXPECT_EQ(few.query(p), surfel::SpaceState::empty) << p.transpose();
    EXPECT_TRUE(few.is_verified_empty(p, 0.1F));
  }
  EXPECT_TRUE(is_unknown(few.query({-1, 0, 0}, 1)));  // the first image is not queried
  for (const Vector3f& p : points_in_ball(0.499F, 2000)) {
    ASSERT_NE(few.query(p), surfel::SpaceState::empty);
  }
}

TEST(FreeSpaceHistory, KeepsNewestImageAtAnyMemoryLimit) {
  const surfel::FreeSpaceHistory history = make_history(around, 0.0, false, 1);
  EXPECT_EQ(history.image_count(), around.size());
  EXPECT_EQ(history.query({0.6F, 0.6F, 0.84F}), surfel::SpaceState::empty);
  EXPECT_TRUE(is_unknown(history.query({1.0F, 0, 0})));
}

}  // namespace
}  // namespace skycap::survey
