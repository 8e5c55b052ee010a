#include "survey/surfel/view_selector.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/not_empty.h"
#include "tests/support/sphere_sensor.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;

const geometry::Camera camera{geometry::CameraConfig{.width = 424, .height = 240}};
const std::vector<tests::Sphere> ball = {{}};
constexpr float spacing = 0.03F;
const geometry::View from = geometry::look_at({2, 0, 0}, {0, 0, 0});
constexpr double infinity = std::numeric_limits<double>::infinity();
const surfel::Admission anywhere = [](const geometry::View&) { return true; };

/// Known surface after one noisy scan from `viewpoint`.
struct Known {
  explicit Known(const Vector3d& viewpoint) : coverage_model(0.005, {.isotropic = 0.01}) {
    const surfel::BlockImage image = surfel::make_block_image(
        tests::scan_spheres(ball, camera, geometry::look_at(viewpoint, {0, 0, 0}), 0.01), camera,
        {.block_px = 4, .jump = 0.1F});
    space.add(image, 0.01F);
    map.add(image, coverage_model, 0.1F, std::nullopt);
    predicted.predict(map, space, std::nullopt);
  }
  surfel::GainField field() const {
    return {map, predicted.patches(), camera, coverage_model, {.view_distance = 2.0}};
  }

  surfel::CoverageModel coverage_model;
  surfel::SurfelMap map{spacing};
  surfel::FreeSpaceHistory space{0.6F * spacing, true};
  surfel::PredictedSurface predicted{{}};
};

TEST(GainField, SeesOnlyTargetsThatFaceTheView) {
  const Known known({2, 0, 0});
  const surfel::GainField field = known.field();
  const geometry::View front = geometry::look_at({2, 0, 0}, {0, 0, 0});
  int surfels = 0;
  for (const surfel::VisibleTarget& visible_target : field.visible_targets(front)) {
    const auto& target = field.targets()[visible_target.target];
    EXPECT_GT(target.normal.dot(Eigen::Vector3f(2, 0, 0) - target.position), 0.0F);
    EXPECT_GT(visible_target.covered_share, 0.0F);
    EXPECT_LT(visible_target.covered_share, 1.0F);
    surfels += field.is_patch(visible_target.target) ? 0 : 1;
  }
  EXPECT_GT(surfels, 100);
  // From behind, the measured half of the ball faces away.
  for (const surfel::VisibleTarget& visible_target :
       field.visible_targets(geometry::look_at({-2, 0, 0}, {0, 0, 0}))) {
    EXPECT_TRUE(field.is_patch(visible_target.target) ||
                field.targets()[visible_target.target].normal.x() < 0.0F);
  }
}

TEST(GainField, SeesNoTargetsBeyondMaxIncidence) {
  const Known known({2, 0, 0});
  const surfel::GainField field(known.map, known.predicted.patches(), camera, known.coverage_model,
                                {.view_distance = 2.0, .max_incidence = 0.7F});
  const Eigen::Vector3f eye(2, 0, 0);
  const auto visible_targets = field.visible_targets(geometry::look_at({2, 0, 0}, {0, 0, 0}));
  EXPECT_GT(visible_targets.size(), 50U);
  for (const surfel::VisibleTarget& visible_target : visible_targets) {
    const auto& target = field.targets()[visible_target.target];
    const float cosine = target.normal.dot((eye - target.position).normalized());
    EXPECT_GT(cosine, std::cos(0.7F) - 1e-5F);
  }
}

// From 2 m, slightly less than half of a ball of radius 0.5 m is visible: 1.2 m^2, whether it is
// new or known.
TEST(GainField, HasAreaOfAllObservedSurface) {
  for (const bool is_news : {true, false}) {
    const surfel::BlockImage image = surfel::make_block_image(
        tests::scan_spheres(ball, camera, from, 0.0), camera, {.block_px = 4, .jump = 0.1F});
    surfel::SurfelMap map{spacing};
    const surfel::CoverageModel coverage_model(0.005, {});
    map.add(image, coverage_model, 0.1F, std::nullopt,
            [is_news](const Eigen::Vector3f&) { return !is_news; });
    const auto field = surfel::GainField::from_known_surface(map, camera, coverage_model,
                                                             {.view_distance = 2.0}, 100'000);
    double area = 0.0;
    for (const auto& target : field.targets()) area += target.weight;
    EXPECT_NEAR(area, 1.2, 0.4) << is_news;
  }
}

TEST(GainField, HasGainEqualToSumOfVisibleTargets) {
  const Known known({2, 0, 0});
  const surfel::GainField field = known.field();
  const geometry::View view = geometry::look_at({1, 1.6, 0.4}, {0, 0, 0});
  double sum = 0.0;
  for (const surfel::VisibleTarget& visible_target : field.visible_targets(view)) {
    sum += field.targets()[visible_target.target].weight * visible_target.covered_share;
  }
  EXPECT_GT(sum, 0.0);
  EXPECT_NEAR(field.gain(view).area, sum, 1e-5 * sum);  // summed in single and double precision
}

// Relative to an empty cloud, measured surface counts in full. Predictions do not count.
TEST(GainField, WeighsKnownSurfaceInFull) {
  const Known known({2, 0, 0});
  const surfel::GainSettings settings{.view_distance = 2.0};
  const double area = known.map.area();
  for (const std::size_t max : {std::size_t{100}, std::size_t{1000000}}) {
    const auto field = surfel::GainField::from_known_surface(known.map, camera,
                                                             known.coverage_model, settings, max);
    EXPECT_LE(field.targets().size(), max);
    EXPECT_GT(field.targets().size(), max == 100 ? 50U : known.map.surfels().size() - 1);
    double weight = 0.0;
    for (const auto& target : field.targets()) weight += double{target.weight};
    EXPECT_NEAR(weight, area, 1e-4 * area);  // no weights have been reduced
  }
}

TEST(GainField, HasObservationHazardsOfCoveredFractions) {
  const Known known({2, 0, 0});
  const surfel::GainField field = known.field();
  const geometry::View view = geometry::look_at({1, 1.6, 0.4}, {0, 0, 0});
  const auto visible_targets = field.visible_targets(view);
  const auto observations = field.observations(view);
  ASSERT_EQ(observations.size(), visible_targets.size());
  for (std::size_t i = 0; i < observations.size(); ++i) {
    EXPECT_EQ(observations[i].target, visible_targets[i].target);
    EXPECT_NEAR(1.0 - std::exp(-double{observations[i].hazard}),
                double{visible_targets[i].covered_share}, 1e-6);
  }
}

// Surface that unknown space may hide counts for less. Known surface counts in full.
TEST(GainField, WeighsPredictionsByLineOfSightConfidence) {
  const Known known({2, 0, 0});
  surfel::LineOfSightModel line_of_sight_probability(0.3F);
  line_of_sight_probability.update(known.predicted.patches(), known.space);
  const surfel::GainField careful(known.map, known.predicted.patches(), camera,
                                  known.coverage_model, {.view_distance = 2.0}, {},
                                  &line_of_sight_probability);
  const surfel::GainField hopeful = known.field();
  for (const Vector3d& eye : {Vector3d(2, 0, 0), Vector3d(0, 2, 0), Vector3d(-2, 0, 0)}) {
    const geometry::View view = geometry::look_at(eye, {0, 0, 0});
    const auto visible_targets = careful.visible_targets(view), all = hopeful.visible_targets(view);
    ASSERT_EQ(visible_targets.size(), all.size());
    double expected = 0.0;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const surfel::VisibleTarget& visible_target = visible_targets[i];
      EXPECT_FLOAT_EQ(visible_target.covered_share,
                      visible_target.line_of_sight_probability * all[i].covered_share);
      EXPECT_TRUE(careful.is_patch(visible_target.target) ||
                  visible_target.line_of_sight_probability == 1.0F);
      expected += double{careful.targets()[visible_target.target].weight} *
                  double{visible_target.covered_share};
    }
    EXPECT_NEAR(careful.gain(view).area, expected, 1e-4 * expected);
  }
  const geometry::View behind = geometry::look_at({-2, 0, 0}, {0, 0, 0});
  EXPECT_LT(careful.gain(behind).predicted, 0.8 * hopeful.gain(behind).predicted);
}

// A small ball in front hides part of a large one. Hidden surfels must not be visible.
TEST(GainField, OccludesFarSurfaceBehindNearSurface) {
  const std::vector<tests::Sphere> two = {{{0, 0, 0}, 0.5}, {{1.2, 0, 0}, 0.2}};
  const surfel::CoverageModel coverage_model(0.005, {.isotropic = 0.01});
  surfel::SurfelMap map(spacing);
  for (const Vector3d& viewpoint : {Vector3d(1, 1.7, 0), Vector3d(1, -1.7, 0), Vector3d(3, 0, 0)}) {
    map.add(surfel::make_block_image(
                tests::scan_spheres(two, camera, geometry::look_at(viewpoint, {0, 0, 0})), camera,
                {.block_px = 4, .jump = 0.1F}),
            coverage_model, 0.1F, std::nullopt);
  }
  const surfel::GainField field(map, {}, camera, coverage_model, {.view_distance = 2.0});
  const Vector3d eye(3, 0, 0);
  int seen = 0;
  for (const surfel::VisibleTarget& visible_target :
       testing_support::not_empty(field.visible_targets(geometry::look_at(eye, {0, 0, 0})))) {
    const Vector3d p = field.targets()[visible_target.target].position.cast<double>();
    if (p.x() > 0.8) continue;  // the small ball
    ++seen;
    // Rays at less than 0.2 / 1.8 from the axis hit the small ball. The tolerance is two splats.
    EXPECT_GT(std::hypot(p.y(), p.z()) / (eye.x() - p.x()), 0.111 - 2.0 * spacing / 2.5);
  }
  EXPECT_GT(seen, 50);
}

// Close to a surface, its surfels are many pixels apart, but no ray passes between them.
TEST(GainField, OccludesPatchesBehindSurfaceAtShortDistance) {
  const Known known({2, 0, 0});
  std::vector<surfel::PredictedPatch> inside;
  for (float y = -0.2F; y <= 0.2F; y += 0.02F) {
    for (float z = -0.2F; z <= 0.2F; z += 0.02F) {
      inside.push_back({{0.2F, y, z}, {1, 0, 0}, spacing, 1.0F, 0, inside.size()});
    }
  }
  const surfel::GainField field(known.map, inside, camera, known.coverage_model,
                                {.view_distance = 2.0});
  for (const double height : {1.5, 0.7, 0.3, 0.15, 0.08}) {
    int surfels = 0;
    for (const surfel::VisibleTarget& visible_target :
         field.visible_targets(geometry::look_at({0.5 + height, 0, 0}, {0, 0, 0}))) {
      EXPECT_FALSE(field.is_patch(visible_target.target)) << "from a height of " << height;
      surfels += field.is_patch(visible_target.target) ? 0 : 1;
    }
    EXPECT_GT(surfels, 0) << "from a height of " << height;
  }
}

std::optional<surfel::Choice> choose(const surfel::GainField& field,
                                     const surfel::Admission& admits, double max_path_length,
                                     const surfel::ViewSelectorSettings& settings) {
  surfel::ViewGainCache nothing;
  return surfel::choose_view(field, {}, admits, from, max_path_length, settings, nothing);
}

TEST(ViewSelector, ApproachesTargetsThatAreClosedAtTheViewDistance) {
  const Known known({2, 0, 0});
  const surfel::GainField field = known.field();
  const surfel::Admission near_only = [](const geometry::View& view) {
    return view.position.norm() < 1.4;
  };
  surfel::ViewSelectorSettings settings{.view_distance = 2.0};
  for (const std::vector<double>& distances : {std::vector{1.0}, std::vector{1.0, 0.7, 0.4}}) {
    settings.distances = distances;
    surfel::ViewGainCache cache;
    const auto choice = surfel::choose_view(field, {}, near_only, from, infinity, settings, cache);
    EXPECT_EQ(choice.has_value(), distances.size() > 1);
    if (choice) {
      EXPECT_LT(choice->view.position.norm(), 1.4);
    }
  }
}

TEST(ViewSelector, SelectsViewOfMissingSurface) {
  const Known known({2, 0, 0});
  const surfel::GainField field = known.field();
  const auto choice = choose(field, anywhere, infinity, {});
  ASSERT_TRUE(choice);
  EXPECT_NEAR(field.gain(choice->view).area, choice->gain, 1e-9);
  // For the stopping rule, predictions count for less and undersampled surface counts in full.
  const surfel::Gain gain = field.gain(choice->view);
  EXPECT_GE(choice->best_gain, gain.area - gain.predicted);
  // Better than observing the same half again from the same distance, 2 m in front of the surface.
  EXPECT_GT(choice->best_gain, field.gain(geometry::look_at({2.5, 0, 0}, {0, 0, 0})).area);
  EXPECT_EQ(choice->chances.size(), field.targets().size());
}

// With the same candidates and no expected yield of predictions, the selected view covers most of
// the known surface.
TEST(ViewSelector, PrefersKnownSurfaceAtZeroPredictionYield) {
  const Known known({2, 0, 0});
  const surfel::GainField field = known.field();
  const auto gain_at = [&](double yield) {
    const auto choice =
        choose(field, anywhere, infinity,
               {.view_price = 1e6, .refinements = 0, .batch = 1, .prediction_yield = yield});
    return field.gain(choice.value().view);
  };
  const surfel::Gain hopeful = gain_at(1.0), sober = gain_at(0.0), lucky = gain_at(6.0);
  EXPECT_GT(sober.area - sober.predicted, 1.02 * (hopeful.area - hopeful.predicted));
  EXPECT_GT(hopeful.area, 1.02 * sober.area);
  EXPECT_EQ(lucky.area, hopeful.area);
}

TEST(ViewSelector, DoesNotDependOnThreadCount) {
  const Known known({2, 0, 0});
  const surfel::GainField field = known.field();
  const auto one = choose(field, anywhere, infinity, {.threads = 1});
  const auto four = choose(field, anywhere, infinity, {.threads = 4});
  ASSERT_TRUE(one && four);
  EXPECT_EQ(one->view.position, four->view.position);
  EXPECT_EQ(one->gain, four->gain);
}

// Each view is rejected as soon as it is selected, until there are none. With and without a cache
// of all previous selections, views and values are equal.
TEST(ViewSelector, SelectsSameViewWithAndWithoutCache) {
  const Known known({2, 0, 0});
  const surfel::GainField field = known.field();
  surfel::ViewSelectorSettings settings;
  for (const double frame_spacing : {0.0, 0.4}) {
    settings.frame_spacing = frame_spacing;
    std::vector<Vector3d> rejected;
    const surfel::Admission admits = [&](const geometry::View& view) {
      return std::ranges::none_of(
          rejected, [&](const Vector3d& other) { return (view.position - other).norm() < 0.4; });
    };
    surfel::ViewGainCache cache;
    for (;;) {
      const auto replanned = choose(field, admits, infinity, settings);
      const auto again = surfel::choose_view(field, {}, admits, from, infinity, settings, cache);
      ASSERT_EQ(replanned.has_value(), again.has_value());
      if (!replanned) break;
      EXPECT_EQ(replanned->view.position, again->view.position);
      EXPECT_EQ(replanned->view.direction, again->view.direction);
      EXPECT_EQ(replanned->gain, again->gain);
      EXPECT_EQ(replanned->best_gain, again->best_gain);
      EXPECT_EQ(replanned->chances, again->chances);
      EXPECT_EQ(replanned->with_leg.size(), again->with_leg.size());
      rejected.push_back(replanned->view.position);
    }
    EXPECT_GT(rejected.size(), 10U);
  }
}

TEST(ViewSelector, SelectsOnlyViewsInReachAndAdmitted) {
  const Known known({2, 0, 0});
  const surfel::GainField field = known.field();
  const auto near = choose(field, anywhere, 0.7, {});
  ASSERT_TRUE(near);
  EXPECT_LE((near->view.position - Vector3d(2, 0, 0)).norm(), 0.7);
  const surfel::Admission above = [](const geometry::View& view) {
    return view.position.z() > 0.5;
  };
  const auto high = choose(field, above, infinity, {});
  ASSERT_TRUE(high);
  EXPECT_GT(high->view.position.z(), 0.5);
  EXPECT_FALSE(choose(field, [](const geometry::View&) { return false; }, infinity, {}));
}

TEST(ViewSelector, InterpolatesViewsEvenlyAlongLeg) {
  const geometry::View east_down{{0, 0, 10}, Vector3d(1, 0, -1).normalized()};
  const geometry::View north{{6, 3, 4}, {0, 1, 0}};
  const auto frames = surfel::views_between(east_down, north, 3);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_TRUE(frames[1].position.isApprox(Vector3d(3, 1.5, 7)));
  EXPECT_NEAR(frames[1].direction.z(), -std::sin(std::numbers::pi / 8.0), 1e-12);
  EXPECT_NEAR(frames[1].direction.x(), frames[1].direction.y(), 1e-12);
  EXPECT_NEAR(frames[0].direction.norm(), 1.0, 1e-12);
  EXPECT_TRUE((frames[0].position + frames[2].position).isApprox(2.0 * frames[1].position));
}

TEST(ViewSelector, CombinesCoverageOfEnRouteFrames) {
  const Known known({2, 0, 0});
  const surfel::GainField field = known.field();
  const geometry::View to = geometry::look_at({0.5, 2, 0.3}, {0, 0, 0});
  const double distance = (to.position - from.position).norm();
  const auto alone = surfel::visible_with_leg(field, from, to, 0.0);
  EXPECT_EQ(alone.size(), field.visible_targets(to).size());
  std::vector<double> uncovered(field.targets().size(), 1.0);
  const auto add = [&](const std::vector<surfel::VisibleTarget>& visible_targets) {
    for (const auto& visible_target : visible_targets)
      uncovered[visible_target.target] *= 1.0 - visible_target.covered_share;
  };
  add(field.visible_targets(to));
  for (const geometry::View& frame : surfel::views_between(from, to, 2))
    add(field.visible_targets(frame));
  const auto with_leg = surfel::visible_with_leg(field, from, to, distance / 2.0 - 1e-9);
  EXPECT_GT(with_leg.size(), alone.size());
  for (const surfel::VisibleTarget& visible_target : with_leg) {
    EXPECT_NEAR(visible_target.covered_share, std::min(1.0 - uncovered[visible_target.target], 1.0),
                1e-5);
  }
}

// Among the best views, the selection takes the one with the highest gain including its path.
TEST(ViewSelector, IncludesGainOfEnRouteFrames) {
  const Known known({2, 0, 0});
  const surfel::GainField field = known.field();
  surfel::ViewSelectorSettings settings{.view_price = 0.5, .batch = 1};
  const auto yield = [&](const geometry::View& view, double frame_spacing) {
    double gain = 0.0;
    for (const auto& visible_target : surfel::visible_with_leg(field, from, view, frame_spacing)) {
      gain += field.targets()[visible_target.target].weight * visible_target.covered_share;
    }
    return gain / (settings.view_price + (view.position - from.position).norm());
  };
  const auto ends_alone = choose(field, anywhere, infinity, settings);
  for (const double frame_spacing : {0.1, 0.4}) {
    settings.frame_spacing = frame_spacing;
    const auto with_legs = choose(field, anywhere, infinity, settings);
    ASSERT_TRUE(ends_alone && with_legs);
    EXPECT_GE(yield(with_legs->view, frame_spacing),
              (1.0 - 1e-5) * yield(ends_alone->view, frame_spacing));
    EXPECT_LE(yield(with_legs->view, 0.0), (1.0 + 1e-5) * yield(ends_alone->view, 0.0));
  }
}

// Known cases: a line that moves along itself sweeps no area. Moving across itself in either
// direction sweeps the same area. Rotating in place sweeps the angle times d.
TEST(ViewSelector, ComputesCoverageOfSweptLines) {
  const Known known({2, 0, 0});
  const surfel::GainField field = known.field();
  constexpr double frame_spacing = 0.05, d = 2.0;
  const auto gain = [&](const geometry::View& begin, const geometry::View& end) {
    double sum = 0.0;
    for (const auto& visible_target :
         surfel::visible_along_lines(field, begin, end, frame_spacing, d)) {
      sum += field.targets()[visible_target.target].weight * visible_target.covered_share;
    }
    return sum;
  };
  const Vector3d ahead(-1, 0, 0), aside(0, 1, 0);
  const geometry::View begin{from.position, ahead};
  EXPECT_EQ(gain(begin, {from.position + 0.5 * ahead, ahead}), 0.0);
  const double across = gain(begin, {from.position + 0.5 * aside, ahead});
  EXPECT_GT(across, 0.0);
  EXPECT_NEAR(gain({from.position + 0.5 * aside, ahead}, begin), across, 1e-6 * across);
  // Combined motion: when moving to the right, a rotation to the left reduces the swept area.
  constexpr double turn = 0.25;
  const Vector3d turned(-std::cos(turn), -std::sin(turn), 0);
  EXPECT_LT(gain(begin, {from.position + d * turn * aside, turned}), 0.2 * across);
}

}  // namespace
}  // namespace skycap::survey
