#include "survey/surfel/predicted_surface.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/sphere_sensor.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const geometry::Camera camera{geometry::CameraConfig{}};
const std::vector<tests::Sphere> ball = {{}};
constexpr float spacing = 0.02F;
constexpr float jump = 0.06F;

struct Knowledge {
  surfel::SurfelMap map{spacing};
  surfel::FreeSpaceHistory space{0.6F * spacing, true};
  void scan_from(const Vector3d& viewpoint) {
    const surfel::BlockImage image = surfel::make_block_image(
        tests::scan_spheres(ball, camera, geometry::look_at(viewpoint, {0, 0, 0})), camera,
        {.block_px = 4, .jump = jump});
    space.add(image, 0.0F);
    map.add(image, surfel::CoverageModel(0.005, {}), jump, std::nullopt);
  }
};

TEST(PredictedSurface, ContinuesBeyondOutlineIntoUnknownSpaceOnly) {
  Knowledge known;
  known.scan_from({2, 0, 0});
  surfel::PredictedSurface predicted({});
  predicted.predict(known.map, known.space, std::nullopt);
  ASSERT_GT(predicted.patches().size(), 50U);
  double behind = 0.0, all = 0.0;
  for (const surfel::PredictedPatch& patch : predicted.patches()) {
    EXPECT_TRUE(is_unknown(known.space.query(patch.position)));
    EXPECT_GT(patch.weight, 0.0F);
    all += patch.weight;
    // The sensor at (2, 0, 0) observed the ball up to x = 0.125.
    if (patch.position.x() < 0.2F) behind += patch.weight;
  }
  EXPECT_GT(behind, 0.9 * all);
}

// Reference: one instance predicts after each scan and only queries what is new; the other queries
// everything.
TEST(PredictedSurface, MatchesFullPredictionWhenUpdated) {
  Knowledge known;
  surfel::PredictedSurface old({});
  for (const Vector3d& viewpoint : {Vector3d(2, 0, 0), Vector3d(1.4, 1.4, 0), Vector3d(0, 1.4, 1.4),
                                    Vector3d(0, -2, 0), Vector3d(-1.4, 0, -1.4)}) {
    known.scan_from(viewpoint);
    old.predict(known.map, known.space, std::nullopt);
    surfel::PredictedSurface replanned({});
    replanned.predict(known.map, known.space, std::nullopt);
    ASSERT_EQ(old.patches().size(), replanned.patches().size());
    EXPECT_GT(replanned.patches().size(), 0U);
    for (std::size_t i = 0; i < replanned.patches().size(); ++i) {
      EXPECT_EQ(old.patches()[i].position, replanned.patches()[i].position);
      EXPECT_EQ(old.patches()[i].key, replanned.patches()[i].key);
      EXPECT_EQ(old.patches()[i].kind, replanned.patches()[i].kind);
    }
  }
}

// Patches refuted by no-return rays are open again as soon as such rays are found to pass through
// surface. The reference model has this information from the first scan.
TEST(PredictedSurface, RestoresPatchesRefutedByFalseMisses) {
  Knowledge known;
  for (const Vector3d& viewpoint : {Vector3d(2, 0, 0), Vector3d(0, 2, 0)})
    known.scan_from(viewpoint);
  surfel::PredictedSurface old({});
  old.predict(known.map, known.space, std::nullopt);
  const std::size_t before = old.patches().size();
  std::vector<Vector3f> beside;  // on no-return rays of the first scan
  for (int i = 0; i < 1000; ++i) {
    beside.emplace_back(0.3F, 0.0003F * static_cast<float>(i) + 0.6F, 0.0F);
  }
  known.space.compare_misses(beside, std::vector<Vector3f>(beside.size(), Vector3f::UnitX()));
  ASSERT_TRUE(known.space.has_false_misses());
  old.predict(known.map, known.space, std::nullopt);
  surfel::PredictedSurface replanned({});
  replanned.predict(known.map, known.space, std::nullopt);
  EXPECT_GT(old.patches().size(), before);
  ASSERT_EQ(old.patches().size(), replanned.patches().size());
  for (std::size_t i = 0; i < replanned.patches().size(); ++i) {
    EXPECT_EQ(old.patches()[i].position, replanned.patches()[i].position);
    EXPECT_EQ(old.patches()[i].key, replanned.patches()[i].key);
  }
}

int count_patches(const surfel::PredictedSurface& predicted, surfel::Continuation continuation) {
  return static_cast<int>(
      std::ranges::count_if(predicted.patches(), [&](const surfel::PredictedPatch& patch) {
        return patch.kind % surfel::continuations == static_cast<int>(continuation);
      }));
}

// From nearby, the image edge cuts off the ball. From far away, the whole ball is in the image.
TEST(PredictedSurface, DistinguishesCutOffFromHiddenSurface) {
  Knowledge near, far;
  near.scan_from({0.9, 0, 0});
  far.scan_from({2, 0, 0});
  surfel::PredictedSurface cut({}), whole({});
  cut.predict(near.map, near.space, std::nullopt);
  whole.predict(far.map, far.space, std::nullopt);
  EXPECT_EQ(count_patches(whole, surfel::Continuation::beyond), 0);
  EXPECT_GT(count_patches(whole, surfel::Continuation::straight), 50);
  EXPECT_GT(count_patches(cut, surfel::Continuation::beyond), 50);
  for (const surfel::PredictedPatch& patch : cut.patches()) {
    const auto kind = static_cast<surfel::Continuation>(patch.kind % surfel::continuations);
    const bool is_outside = near.space.query(patch.position) == surfel::SpaceState::outside;
    if (kind == surfel::Continuation::beyond) {
      EXPECT_TRUE(is_outside);
    }
    if (kind == surfel::Continuation::straight) {
      EXPECT_FALSE(is_outside);
    }
  }
  // After another image covers that region, the surface there is hidden or known.
  near.scan_from({2, 0, 0});
  cut.predict(near.map, near.space, std::nullopt);
  EXPECT_EQ(count_patches(cut, surfel::Continuation::beyond), 0);
}

TEST(PredictedSurface, LearnsSeparateHitRateForCutOffSurface) {
  Knowledge known;
  known.scan_from({0.9, 0, 0});
  surfel::PredictedSurface predicted({});
  predicted.predict(known.map, known.space, std::nullopt);
  std::vector<surfel::PredictedSurface::Expected> cut_off;
  for (std::uint32_t i = 0; i < predicted.patches().size(); ++i) {
    const int kind = predicted.patches()[i].kind % surfel::continuations;
    if (kind == static_cast<int>(surfel::Continuation::beyond)) cut_off.push_back({i, 1.0F});
  }
  const double beyond = predicted.hit_rate(surfel::Continuation::beyond, 0);
  const double straight = predicted.hit_rate(surfel::Continuation::straight, 0);
  predicted.grade(cut_off, known.map, known.space, known.map.surfels().size());  // no new surface
  EXPECT_LT(predicted.hit_rate(surfel::Continuation::beyond, 0), beyond);
  EXPECT_EQ(predicted.hit_rate(surfel::Continuation::straight, 0), straight);
}

/// Scans a plate of 40 x 40 cm, 5 mm thick, with its front at x = 0.
geometry::Scan scan_plate(const geometry::View& view) {
  geometry::Scan scan;
  scan.world_from_sensor = geometry::camera_pose(view);
  const double x = view.position.x() > 0.0 ? 0.0 : -0.005;
  for (int row = 0; row < camera.height(); ++row) {
    for (int column = 0; column < camera.width(); ++column) {
      const Vector3d ray = scan.world_from_sensor.linear() * camera.ray({column, row});
      const Vector3d hit = view.position + (x - view.position.x()) / ray.x() * ray;
      if (std::abs(hit.y()) > 0.2 || std::abs(hit.z()) > 0.2) continue;
      scan.points.push_back(hit.cast<float>());
      scan.pixels.push_back(static_cast<std::uint32_t>(row * camera.width() + column));
    }
  }
  return scan;
}

// Space beyond the plate's rim is empty, so it is thin and has a back. This never holds for a ball.
TEST(PredictedSurface, PredictsBackOfThinObjects) {
  Knowledge plate, solid;
  const auto scan_from = [&](const Vector3d& viewpoint) {
    const surfel::BlockImage image = surfel::make_block_image(
        scan_plate(geometry::look_at(viewpoint, {0, 0, 0})), camera, {.block_px = 4, .jump = jump});
    plate.space.add(image, 0.0F);
    plate.map.add(image, surfel::CoverageModel(0.005, {}), jump, std::nullopt);
  };
  scan_from({1, 0, 0});
  surfel::PredictedSurface predicted({});
  predicted.predict(plate.map, plate.space, std::nullopt);
  EXPECT_GT(count_patches(predicted, surfel::Continuation::back), 20);
  for (const surfel::PredictedPatch& patch : predicted.patches()) {
    const auto kind = static_cast<surfel::Continuation>(patch.kind % surfel::continuations);
    if (kind != surfel::Continuation::back) continue;
    EXPECT_LT(patch.normal.x(), -0.9F);
    EXPECT_LT(patch.position.x(), -0.5F * spacing);
    EXPECT_LT(patch.position.tail<2>().cwiseAbs().maxCoeff(), 0.2F + spacing);
  }
  scan_from({-1, 0, 0});
  predicted.predict(plate.map, plate.space, std::nullopt);
  EXPECT_EQ(count_patches(predicted, surfel::Continuation::back), 0);

  solid.scan_from({1.2, 0, 0});
  predicted.predict(solid.map, solid.space, std::nullopt);
  EXPECT_EQ(count_patches(predicted, surfel::Continuation::back), 0);
}

TEST(PredictedSurface, VanishesWhenAllSurfaceIsObserved) {
  Knowledge known;
  surfel::PredictedSurface predicted({});
  known.scan_from({2, 0, 0});
  predicted.predict(known.map, known.space, std::nullopt);
  const auto weight = [&] {
    double sum = 0.0;
    for (const surfel::PredictedPatch& patch : predicted.patches()) sum += patch.weight;
    return sum;
  };
  const double after_one = weight();
  for (const Vector3d& viewpoint : {Vector3d(-2, 0, 0), Vector3d(0, 2, 0), Vector3d(0, -2, 0),
                                    Vector3d(0, 0, 2), Vector3d(0, 0, -2)}) {
    known.scan_from(viewpoint);
  }
  predicted.predict(known.map, known.space, std::nullopt);
  EXPECT_LT(weight(), 0.05 * after_one);
}

TEST(PredictedSurface, UpdatesHitRatesFromObservedSurface) {
  Knowledge known;
  known.scan_from({2, 0, 0});
  surfel::PredictedSurface hopeful({}), disappointed({}), stubborn({.learns_rates = false});
  std::vector<surfel::PredictedSurface::Expected> all;
  for (surfel::PredictedSurface* predicted : {&hopeful, &disappointed, &stubborn}) {
    predicted->predict(known.map, known.space, std::nullopt);
  }
  for (std::uint32_t i = 0; i < hopeful.patches().size(); ++i) all.push_back({i, 1.0F});
  const double before = hopeful.hit_rate(surfel::Continuation::straight, 0);
  const float weight_before = disappointed.patches().front().weight;

  // No new surface appeared: all predictions failed, and their positions are still unknown.
  disappointed.grade(all, known.map, known.space, known.map.surfels().size());
  stubborn.grade(all, known.map, known.space, known.map.surfels().size());
  EXPECT_LT(disappointed.hit_rate(surfel::Continuation::straight, 0), before);
  EXPECT_EQ(stubborn.hit_rate(surfel::Continuation::straight, 0), before);
  disappointed.predict(known.map, known.space, std::nullopt);
  EXPECT_LT(disappointed.patches().front().weight, 0.4F * weight_before);
  EXPECT_GT(disappointed.patches().front().weight, 0.0F);

  // Views all around the outline show the surface predicted by straight patches.
  const std::size_t first_new = known.map.surfels().size();
  for (const Vector3d& viewpoint :
       {Vector3d(0, 2, 0), Vector3d(0, -2, 0), Vector3d(0, 0, 2), Vector3d(0, 0, -2)}) {
    known.scan_from(viewpoint);
  }
  hopeful.grade(all, known.map, known.space, first_new);
  EXPECT_GT(hopeful.hit_rate(surfel::Continuation::straight, 0),
            disappointed.hit_rate(surfel::Continuation::straight, 0) + 0.1);
}

// If a patch was hardly visible, its absence contains little information.
TEST(PredictedSurface, ReducesWeightByLineOfSightConfidence) {
  Knowledge known;
  known.scan_from({2, 0, 0});
  const auto weight_after = [&](float line_of_sight) {
    surfel::PredictedSurface predicted({.learns_rates = false});
    predicted.predict(known.map, known.space, std::nullopt);
    predicted.grade(std::vector<surfel::PredictedSurface::Expected>{{0, line_of_sight}}, known.map,
                    known.space, known.map.surfels().size());
    predicted.predict(known.map, known.space, std::nullopt);
    return predicted.patches().front().weight;
  };
  const float untouched = weight_after(0.0F);
  EXPECT_FLOAT_EQ(weight_after(1.0F), 0.35F * untouched);
  EXPECT_FLOAT_EQ(weight_after(0.2F), 0.87F * untouched);
}

constexpr float scale = 0.3F;  // of the line-of-sight confidence

std::vector<surfel::PredictedPatch> patches_at(const std::vector<Vector3f>& positions) {
  std::vector<surfel::PredictedPatch> patches;
  for (const Vector3f& key : positions) {
    patches.push_back({key, Vector3f::UnitX(), 0.02F, 1.0F, 0, patches.size()});
  }
  return patches;
}

TEST(LineOfSightModel, IsOneInFrontOfKnownSurface) {
  Knowledge seen;
  seen.scan_from({2, 0, 0});
  const auto patches = patches_at({{0.55F, 0, 0}});
  surfel::LineOfSightModel line_of_sight(scale);
  line_of_sight.update(patches, seen.space);
  EXPECT_EQ(line_of_sight.of(0, {2, 0, 0}), 1.0F);
}

// The radius of the ball is 0.5. From behind, all space in front of a position in its shadow is
// unknown.
TEST(LineOfSightModel, DecreasesWithUnknownSpaceOnRay) {
  Knowledge seen;
  seen.scan_from({2, 0, 0});
  const auto patches = patches_at({{-0.55F, 0, 0}, {0, 0.45F, 0}});
  surfel::LineOfSightModel line_of_sight(scale);
  line_of_sight.update(patches, seen.space);
  EXPECT_NEAR(line_of_sight.of(0, {-2, 0, 0}), std::exp(-3.0F), 1e-6F);
  // From the side, the shadow is short.
  EXPECT_GT(line_of_sight.of(1, {0, 2, 0}), 2.0F * line_of_sight.of(0, {-2, 0, 0}));
  EXPECT_LT(line_of_sight.of(1, {0, 2, 0}), 1.0F);
}

TEST(LineOfSightModel, IsOneWithoutImagesAndForPriors) {
  const Knowledge nothing;
  auto patches = patches_at({{0, 0, 0}});
  surfel::LineOfSightModel line_of_sight(scale);
  line_of_sight.update(patches, nothing.space);
  EXPECT_EQ(line_of_sight.of(0, {1, 0, 0}), 1.0F);
  Knowledge seen;
  seen.scan_from({2, 0, 0});
  patches[0].kind = surfel::prior_kind;
  line_of_sight.update(patches, seen.space);
  EXPECT_EQ(line_of_sight.of(0, {-1, 0, 0}), 1.0F);
}

// Reference: one model is queried after each scan, with other patches before and between; the other
// only once.
TEST(LineOfSightModel, MatchesFullEvaluationWhenUpdated) {
  Knowledge seen;
  const std::vector<Vector3f> positions = {
      {-0.55F, 0, 0}, {0, 0.55F, 0}, {0, 0, -0.52F}, {0.3F, -0.5F, 0.1F}};
  const std::vector<Vector3f> sensors = {
      {-2, 0, 0}, {0, 2, 0.3F}, {1, -1, 1}, {0.2F, 0.1F, -2}, {2, 0, 0}};
  surfel::LineOfSightModel old(scale);
  int between = 0;
  for (const Vector3d& viewpoint :
       {Vector3d(2, 0, 0), Vector3d(0, 2, 0), Vector3d(-1.2, -1.2, 0), Vector3d(0, 0, -2)}) {
    seen.scan_from(viewpoint);
    auto patches = patches_at(positions);
    // Different order, different identifiers, and one moved patch.
    std::rotate(patches.begin(), patches.begin() + 1, patches.end());
    patches[0].position.x() += 0.01F * static_cast<float>(seen.space.image_count());
    old.update(patches, seen.space);
    surfel::LineOfSightModel replanned(scale);
    replanned.update(patches, seen.space);
    ASSERT_FALSE(patches.empty());
    for (std::size_t i = 0; i < patches.size(); ++i) {
      for (const Vector3f& sensor : sensors) {
        EXPECT_EQ(old.of(i, sensor), replanned.of(i, sensor));
        between += old.of(i, sensor) < 0.99F && old.of(i, sensor) > 0.06F ? 1 : 0;
      }
    }
  }
  EXPECT_GT(between, 5);
}

TEST(PredictionYield, IsRatioOfObservedToPredictedArea) {
  surfel::PredictionYield yield;
  EXPECT_EQ(yield.value(), 1.0);
  yield.learn(2.0, 1.0, 0.0);
  EXPECT_DOUBLE_EQ(yield.value(), 0.5);
  yield.learn(0.0, 7.0, 7.0);  // without a prediction the yield does not change
  EXPECT_DOUBLE_EQ(yield.value(), 0.5);
  yield.learn(4.0, 12.0, 12.0);  // 12.6 m^2 found for 5.2 m^2 predicted
  EXPECT_DOUBLE_EQ(yield.value(), 12.6 / 5.2);
}

// Earlier scans have at most twice the weight of the present one. After 100 m^2, a new square metre
// still has a third of the total weight.
TEST(PredictionYield, LimitsWeightOfPastToTwiceThePresent) {
  surfel::PredictionYield yield;
  yield.learn(100.0, 100.0, 0.0);
  EXPECT_EQ(yield.value(), 1.0);
  yield.learn(1.0, 0.0, 0.0);
  EXPECT_DOUBLE_EQ(yield.value(), 2.0 / 3.0);
  yield.learn(1.0, 0.0, 0.0);  // the previous sums, 2 of 3, are multiplied by 0.6
  EXPECT_DOUBLE_EQ(yield.value(), 1.2 / 2.8);
}

// Relief and noise next to known surface do not raise the yield above 1.
TEST(PredictionYield, ExceedsOneForNewTerritoryOnly) {
  surfel::PredictionYield yield;
  yield.learn(1.0, 5.0, 0.1);
  EXPECT_DOUBLE_EQ(yield.value(), 1.0);
  yield.learn(1.0, -5.0, 0.1);  // new surfels shared existing area: 1.1 - 0.4 for 1.6
  EXPECT_DOUBLE_EQ(yield.value(), 0.7 / 1.6);
}

TEST(PredictionYield, IsBoundedAndForgetsOldScans) {
  surfel::PredictionYield yield;
  yield.learn(1.0, 0.0, 0.0);
  EXPECT_DOUBLE_EQ(yield.value(), 0.15);
  yield.learn(1.0, 1000.0, 1000.0);
  EXPECT_DOUBLE_EQ(yield.value(), 6.0);
  // After ten scans without new surface, the large find has no more effect.
  for (int scan = 0; scan < 10; ++scan) yield.learn(1.0, 0.0, 0.0);
  EXPECT_DOUBLE_EQ(yield.value(), 0.15);
}

}  // namespace
}  // namespace skycap::survey
