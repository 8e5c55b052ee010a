#include "survey/photo/photo_planner.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/surfaces/mesh_distance.h"
#include "tests/survey/photo/test_scenes.h"

namespace skycap::survey::photo {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

/// Box of 8 x 6 x 5 m on a plane, with a stand-off of 3 m and a minimum height of 2 m.
class PhotosOfABox : public testing::Test {
 protected:
  PhotosOfABox() {
    add_box(site_.target, {-4, -3, 0}, {4, 3, 5});
    walls_.emplace(site_.target, 1);
    site_.ground = [](const Eigen::Vector2d&) { return 0.0; };
    site_.min_height = 2.0;
    site_.space.min_standoff = 3.0;
    site_.space.limits.min_height = 2.0;
    site_.space.is_free = [this](const Vector3d& at) { return walls_->distance(at) >= 3.0; };
    options_.camera = test_camera();
    options_.gsd = geometry::PhotoCamera(test_camera()).gsd(8.0);
    options_.patterns = {Pattern::dome};
    options_.repair_rounds = 20;
  }

  PhotoPlanResult plan(unsigned threads = 2) const {
    return plan_photos(options_, site_, {.seed = 1, .threads = threads});
  }
  /// Returns the plan with the default options of this suite, which is computed once.
  const PhotoPlanResult& default_plan() const {
    static const PhotoPlanResult result = plan();
    return result;
  }
  std::string message() const {
    try {
      plan();
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }

  PhotoSite site_;
  PhotoPlanOptions options_;
  std::optional<geometry::MeshDistance> walls_;
};

TEST_F(PhotosOfABox, SatisfyAlmostAllThatIsAttainable) {
  const PhotoPlanResult& result = default_plan();
  EXPECT_NEAR(result.view_distance, 8.0, 1e-9);
  // The floor of the box is inner surface.
  EXPECT_NEAR(result.exposed_area, 48.0 + 2.0 * 5.0 * (8.0 + 6.0), 2.0);
  const PhotoFigures& figures = result.figures;
  EXPECT_GE(figures.attainable_share(figures.satisfied), 0.96);
  EXPECT_GE(figures.share(figures.attainable), 0.95);
  EXPECT_LE(result.views.size(), 40U);
  EXPECT_EQ(figures.good + figures.weak + figures.missing, figures.samples);
  EXPECT_LE(result.bound.photos, result.views.size());
  EXPECT_GE(static_cast<double>(result.bound.photos),
            0.6 * static_cast<double>(result.views.size()));
  ASSERT_EQ(result.patterns.size(), 1U);
  EXPECT_LT(result.views.size(), result.patterns[0].views.size());
  EXPECT_LT(result.patterns[0].pruned_views.size(), result.patterns[0].views.size());
}

TEST_F(PhotosOfABox, KeepStandOffHeightAndDistanceFromOneAnother) {
  const PhotoPlanResult& result = default_plan();
  for (std::size_t i = 0; i < result.views.size(); ++i) {
    EXPECT_GE(walls_->distance(result.views[i].position), 3.0);
    EXPECT_GE(result.views[i].position.z(), 2.0);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE((result.views[i].position - result.views[j].position).norm(), 0.4);
    }
  }
}

TEST_F(PhotosOfABox, HaveACurveThatRisesToThePlan) {
  const PhotoPlanResult& result = default_plan();
  ASSERT_EQ(result.curve.size(), result.views.size());
  for (std::size_t i = 1; i < result.curve.size(); ++i) {
    EXPECT_GE(result.curve[i].completeness, result.curve[i - 1].completeness - 1e-12);
  }
  EXPECT_DOUBLE_EQ(result.curve.back().completeness, result.figures.completeness);
}

TEST_F(PhotosOfABox, AccountForAllThatIsNotSatisfied) {
  const PhotoPlanResult& result = default_plan();
  double missing = 0.0;
  for (const double area : result.missing_area) missing += area;
  const double expected =
      result.exposed_area * (1.0 - result.figures.share(result.figures.satisfied));
  EXPECT_NEAR(missing, expected, 1e-6 * result.exposed_area);
}

TEST_F(PhotosOfABox, AreTheSameForAnyThreads) {
  options_.repair_rounds = 4;
  const PhotoPlanResult one = plan(1), several = plan(8);
  ASSERT_EQ(one.views.size(), several.views.size());
  for (std::size_t i = 0; i < one.views.size(); ++i) {
    EXPECT_EQ(one.views[i].position, several.views[i].position);
    EXPECT_EQ(one.views[i].direction, several.views[i].direction);
  }
  EXPECT_EQ(one.figures.completeness, several.figures.completeness);
}

// One photo of a hall observes less than 0.2% of the gain that all samples offer together.
TEST_F(PhotosOfABox, SatisfyAlmostAllOfALargeTarget) {
  site_.target = {};
  add_box(site_.target, {-60, -20, 0}, {60, 20, 8});
  walls_.emplace(site_.target, 1);
  options_.patterns.clear();
  options_.repair_rounds = 0;
  const PhotoFigures figures = plan().figures;
  EXPECT_GE(figures.attainable_share(figures.satisfied), 0.95);
}

TEST_F(PhotosOfABox, RegisterToOneAnotherWhenPosesAreUnknown) {
  options_.poses = PosesGiven::unknown;
  const PhotoPlanResult result = plan();
  EXPECT_TRUE(result.graph.is_connected(3));
}

TEST_F(PhotosOfABox, EndAtTheMaximumAndTheTargetShare) {
  const std::size_t all = default_plan().views.size();
  options_.repair_rounds = 10;
  options_.max_photos = 9;
  EXPECT_LE(plan().views.size(), 9U);
  options_.max_photos = 2000;
  options_.target_share = 0.6;
  const PhotoPlanResult part = plan();
  EXPECT_LT(part.views.size(), all);
  EXPECT_GE(part.figures.attainable_share(part.figures.satisfied), 0.55);
}

TEST_F(PhotosOfABox, FlyAPatternAsItIs) {
  options_.flown_pattern = Pattern::dome;
  const PhotoPlanResult result = plan();
  EXPECT_EQ(result.views.size(), result.patterns[0].views.size());
  EXPECT_DOUBLE_EQ(result.figures.completeness, result.patterns[0].figures.completeness);
}

TEST_F(PhotosOfABox, AreRejectedBelowStandOff) {
  options_.gsd = geometry::PhotoCamera(test_camera()).gsd(2.0);
  EXPECT_THAT(message(),
              HasSubstr("below limits.stand_off (3 m): at 3 m this camera has a GSD of 0.8 mm"));
}

TEST_F(PhotosOfABox, AreRejectedBelowTheNearestFocus) {
  site_.space.min_standoff = 0.1;
  options_.gsd = geometry::PhotoCamera(test_camera()).gsd(0.5);
  EXPECT_THAT(message(), HasSubstr("below the nearest focus of the camera (1 m)"));
}

TEST_F(PhotosOfABox, AreRejectedWhereNoPhotoIsFree) {
  site_.space.is_free = [](const Vector3d&) { return false; };
  EXPECT_THAT(message(), HasSubstr("no photo observes the target"));
}

TEST_F(PhotosOfABox, AreRejectedWithoutSurface) {
  site_.target = {};
  EXPECT_THAT(message(), HasSubstr("the target has no surface"));
  site_.target.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  site_.target.triangles = {{0, 1, 2}};
  EXPECT_THAT(message(), HasSubstr("the target has no surface"));
  site_.target.vertices[2] = {std::nan(""), 1, 0};
  EXPECT_THAT(message(), HasSubstr("the target has no surface"));
}

TEST_F(PhotosOfABox, AreRejectedForABuriedTarget) {
  site_.ground = [](const Eigen::Vector2d&) { return 10.0; };
  EXPECT_THAT(message(), HasSubstr("of the target's surface is exposed"));
}

TEST(ExposedSamples, OfAWallFaceBothItsSidesByWhatIsFree) {
  const geometry::Mesh target = wall(4.0, 1.0, 4.0);
  geometry::Mesh all = target;
  add_box(all, {-1, 0.2, 0}, {5, 6, 8});  // House behind the wall.
  const geometry::SightLines visible_targets(all, 1);
  SampleOptions options;
  options.count = 500;
  options.free_length = 10.0;
  const TargetSamples samples = sample_target(target, visible_targets, options);
  EXPECT_EQ(samples.size(), 500U);
  EXPECT_NEAR(samples.area(), 16.0, 1e-9);
  for (const Eigen::Vector3f& normal : samples.normals) EXPECT_NEAR(normal.y(), -1.0F, 1e-6F);
}

// In a grid of photos that face a wall, the spacing determines the number of observations of each
// point.
TEST(ObservedSamples, OfAFacadeGridAreThoseOfItsFootprints) {
  const geometry::Mesh target = wall(40.0, 5.0, 10.0);
  const geometry::SightLines visible_targets(target, 1);
  const geometry::PhotoCamera camera(test_camera());
  TargetSamples samples;
  for (double x = 12.0; x <= 28.0; x += 0.37) {
    samples.points.emplace_back(static_cast<float>(x), 0.0F, 10.0F);
    samples.normals.emplace_back(0.0F, -1.0F, 0.0F);
    samples.triangles.push_back(0);
  }
  StereoRule rule;
  rule.view_distance = 8.0;
  std::vector<geometry::View> photos;
  constexpr double spacing = 2.0;
  for (double x = 0.0; x <= 40.0; x += spacing) photos.push_back({{x, -8.0, 10.0}, {0, 1, 0}});
  const IndexLists observed =
      observed_samples(Observer(camera, rule, visible_targets, samples), photos, 1);
  const double half = 0.97 * 0.5 * camera.width() * 8.0 / camera.focal_length_px();
  const IndexLists observers = transposed(observed, samples.size());
  for (std::size_t s = 0; s < samples.size(); ++s) {
    const double x = samples.points[s].x();
    const auto expected = static_cast<std::size_t>(std::floor((x + half) / spacing) -
                                                   std::ceil((x - half) / spacing) + 1);
    EXPECT_EQ(observers[s].size(), expected) << x;
  }
}

}  // namespace
}  // namespace skycap::survey::photo
