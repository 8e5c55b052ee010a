#include "survey/skycap/prior_guesses.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "survey/skycap/unseen_surface.h"
#include "tests/support/sphere_sensor.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using State = skycap::PriorGuesses::State;

const geometry::Camera camera{geometry::CameraConfig{}};
const std::vector<tests::Sphere> ball = {{}};
constexpr float spacing = 0.02F;
constexpr float jump = 0.06F;
constexpr double radius = 0.5;  // of tests::Sphere

/// Points of a Fibonacci lattice on a sphere of the ball's size.
skycap::PriorSurface sphere_at(const Vector3f& centre, float uncertainty) {
  constexpr int count = 40'000;
  skycap::PriorSurface surface;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / count, r = std::sqrt(1.0 - z * z);
    const Vector3f normal =
        Vector3d(r * std::cos(golden * i), r * std::sin(golden * i), z).cast<float>();
    surface.positions.push_back(centre + static_cast<float>(radius) * normal);
    surface.normals.push_back(normal);
    surface.areas.push_back(static_cast<float>(4.0 * std::numbers::pi * radius * radius / count));
    surface.uncertainties.push_back(uncertainty);
  }
  return surface;
}

struct Knowledge {
  skycap::DoseMap map{spacing};
  skycap::SpaceMemory space{0.6F * spacing, true};
  void look_from(const Vector3d& station) {
    const skycap::BlockImage image = skycap::make_block_image(
        tests::scan_spheres(ball, camera, geometry::look_at(station, {0, 0, 0})), camera,
        {.block_px = 4, .jump = jump});
    space.add(image, 0.0F);
    map.add(image, skycap::DoseModel(0.005, {}), jump, std::nullopt);
  }
};

TEST(PriorGuesses, ArePatchesOfTheWholeArea) {
  const skycap::PriorGuesses guesses(sphere_at({0, 0, 0}, 0.0F), spacing);
  double area = 0.0;
  for (const skycap::PriorPatch& patch : guesses.patches()) {
    area += patch.area;
    EXPECT_NEAR(patch.position.norm(), radius, 0.1 * spacing);
    EXPECT_GT(patch.normal.dot(patch.position), 0.9 * radius);
  }
  EXPECT_NEAR(area, std::numbers::pi, 1e-3);
  EXPECT_LT(guesses.patches().size(), 40'000U / 2);
}

// What one look from +x shows is found; the far side stays open.
TEST(PriorGuesses, AreFoundWhereTheyAreMeasured) {
  Knowledge known;
  known.look_from({2, 0, 0});
  skycap::PriorGuesses guesses(sphere_at({0, 0, 0}, 0.01F), spacing);
  guesses.update(known.map, known.space);
  ASSERT_FALSE(guesses.patches().empty());
  for (std::size_t i = 0; i < guesses.patches().size(); ++i) {
    const float x = guesses.patches()[i].position.x();
    if (x > 0.25F) {
      EXPECT_EQ(guesses.state(i), State::found) << x;
    }
    if (x < 0.0F) {
      EXPECT_EQ(guesses.state(i), State::open) << x;
    }
  }
}

// The same in the planner's guesses: what was shown is not guessed, the far side is.
TEST(PriorGuesses, AreGuessedOnlyWhereTheyAreOpen) {
  Knowledge known;
  known.look_from({2, 0, 0});
  skycap::UnseenSurface unseen({});
  unseen.expect({sphere_at({0, 0, 0}, 0.01F), spacing});
  unseen.predict(known.map, known.space, std::nullopt);
  std::size_t guessed = 0;
  for (const skycap::UnseenPatch& patch : unseen.patches()) {
    if (patch.kind != skycap::prior_kind) continue;
    EXPECT_LE(patch.position.x(), 0.25F);
    ++guessed;
  }
  EXPECT_GT(guessed, 1000U);
}

// A sphere that is not there, beside the ball: the sensor sees through its place.
TEST(PriorGuesses, AreRefutedWhereASensorSeesThroughThem) {
  Knowledge known;
  known.look_from({2, 0, 0});
  skycap::PriorGuesses guesses(sphere_at({0.9F, 0.0F, 0.0F}, 0.01F), spacing);
  guesses.update(known.map, known.space);
  std::size_t refuted = 0;
  ASSERT_FALSE(guesses.patches().empty());
  for (std::size_t i = 0; i < guesses.patches().size(); ++i) {
    refuted += guesses.state(i) == State::refuted ? 1 : 0;
    const Vector3f& place = guesses.patches()[i].position;
    if (place.x() > 0.6F && place.x() < 1.2F &&
        place.tail<2>().norm() < 0.15F) {  // in the image, before the ball
      EXPECT_EQ(guesses.state(i), State::refuted);
    }
  }
  EXPECT_GT(refuted, 20U);
}

/// The rate of the prior after a look from +x, graded by what that should have shown: all that
/// faces it.
double rate_after_a_look(const Vector3f& centre) {
  Knowledge known;
  skycap::UnseenSurface unseen({});
  unseen.expect({sphere_at(centre, 0.01F), spacing});
  const double before = unseen.prior_hit_rate();
  EXPECT_GT(before, 0.8);
  unseen.predict(known.map, known.space, std::nullopt);
  std::vector<skycap::UnseenSurface::Expected> expected;
  for (std::uint32_t i = 0; i < unseen.patches().size(); ++i) {
    const skycap::UnseenPatch& patch = unseen.patches()[i];
    if (patch.kind == skycap::prior_kind && patch.normal.x() > 0.7F) expected.push_back({i, 1.0F});
  }
  EXPECT_GT(expected.size(), 20U);
  known.look_from({2, 0, 0});
  unseen.grade(expected, known.map, known.space, 0);
  return unseen.prior_hit_rate();
}

TEST(UnseenSurface, TrustsAPriorThatIsRightAndSoonGivesUpAWrongOne) {
  EXPECT_GT(rate_after_a_look({0, 0, 0}), 0.85);
  EXPECT_LT(rate_after_a_look({0.3F, 0.0F, 0.0F}), 0.5);
}

}  // namespace
}  // namespace skycap::survey
