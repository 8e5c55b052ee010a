#include "survey/surfel/surfel_planner.h"

#include <cmath>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/points/point_grid.h"
#include "tests/support/sphere_sensor.h"
#include "tests/support/stopped_planner.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using geometry::View;
using testing::HasSubstr;

// A quarter of the depth camera's pixels and a corresponding coverage radius, so that tests take 1
// s.
const geometry::Camera camera{geometry::CameraConfig{.width = 212, .height = 120}};
const std::vector<tests::Sphere> ball = {{}};
const std::vector<tests::Sphere> two_balls = {{{0, 0, 0}, 0.4}, {{0.75, 0, 0.2}, 0.3}};
const View start = geometry::look_at({2.2, 0.3, 0.4}, {0, 0, 0});

surfel::SurfelConfig small_config() {
  return {.coverage_radius = 0.02, .view_distance = 2.0, .scene_box = std::nullopt};
}

struct Flight {
  std::vector<View> views;
  double length = 0.0;
};

/// Flies until the planner stops or `max_views` views have been taken.
Flight fly(surfel::SurfelPlanner& planner, const std::vector<tests::Sphere>& scene, double sigma,
           std::size_t max_views = 40, bool is_organised = true,
           const geometry::Camera& sensor = camera, const View& first = start) {
  Flight flight{{first}};
  for (std::optional<View> next = first; next;) {
    geometry::Scan scan =
        tests::scan_spheres(scene, sensor, *next, sigma, 100 + flight.views.size());
    if (!is_organised) scan.pixels.clear();
    next = planner.next_view(scan);
    if (!next || flight.views.size() == max_views) break;
    flight.length += (next->position - flight.views.back().position).norm();
    flight.views.push_back(*next);
  }
  return flight;
}

/// Returns the fraction of the spheres' outer surface with a measurement within the coverage
/// radius.
double true_coverage(const surfel::SurfelPlanner& planner, const std::vector<tests::Sphere>& scene,
                     double radius) {
  geometry::PointGrid grid(radius);
  for (const Vector3f& p : planner.cloud().positions) grid.insert(p);
  int covered = 0, all = 0;
  for (const tests::Sphere& sphere : scene) {
    constexpr int count = 4000;  // Fibonacci lattice
    for (int i = 0; i < count; ++i) {
      const double z = 1.0 - 2.0 * (i + 0.5) / count, azimuth = 2.399963229728653 * i;
      const double level = std::sqrt(1.0 - z * z);
      const Vector3d p = sphere.centre + sphere.radius * Vector3d(level * std::cos(azimuth),
                                                                  level * std::sin(azimuth), z);
      bool is_outside = true;
      for (const tests::Sphere& other : scene) {
        is_outside = is_outside && (p - other.centre).norm() > other.radius - 1e-9;
      }
      if (!is_outside) continue;
      ++all;
      covered += grid.any_within(p.cast<float>(), radius) ? 1 : 0;
    }
  }
  return static_cast<double>(covered) / all;
}

class SurfelPlannerWithNoise : public testing::TestWithParam<double> {};

TEST_P(SurfelPlannerWithNoise, CoversSceneAndStops) {
  for (const auto& scene : {ball, two_balls}) {
    surfel::SurfelPlanner planner(small_config(), camera);
    const Flight flight = fly(planner, scene, GetParam());
    EXPECT_LT(flight.views.size(), 20U);
    EXPECT_EQ(planner.stop(), surfel::SurfelStop::little_gain);
    const double coverage = true_coverage(planner, scene, 0.02);
    EXPECT_GT(coverage, 0.97);
    // The estimate comes from a model. It must be accurate to five percentage points to be useful
    // for a pilot.
    EXPECT_NEAR(planner.predicted_coverage(), coverage, 0.05);
  }
}

INSTANTIATE_TEST_SUITE_P(Sigmas, SurfelPlannerWithNoise, testing::Values(0.0, 0.01, 0.03));

// A ray without a return says nothing about surface beyond the range of the sensor.
TEST(SurfelPlanner, CoversSceneLargerThanTheRange) {
  const std::vector<tests::Sphere> large_ball = {{.radius = 1.5}};
  const geometry::Camera sensor({.width = 212, .height = 120, .max_range = 2.06});
  surfel::SurfelPlanner planner(small_config(), sensor);
  const Flight flight =
      fly(planner, large_ball, 0.0, 80, true, sensor, geometry::look_at({3.5, 0, 0}, {0, 0, 0}));
  EXPECT_EQ(planner.stop(), surfel::SurfelStop::little_gain);
  const double coverage = true_coverage(planner, large_ball, 0.02);
  EXPECT_GT(coverage, 0.95);
  EXPECT_NEAR(planner.predicted_coverage(), coverage, 0.05);
}

// All views at the view distance are inside the box of the scene, where no return verifies free
// space: the survey must not be called complete.
TEST(SurfelPlanner, ReportsSurfaceThatOnlyUnverifiedPositionsShow) {
  const std::vector<tests::Sphere> large_ball = {{.radius = 1.5}};
  const geometry::Camera sensor({.width = 212, .height = 120, .max_range = 2.06});
  surfel::SurfelConfig config = small_config();
  config.scene_box = Eigen::AlignedBox3d(Vector3d(-4.5, -4.5, -4.5), Vector3d(4.5, 4.5, 4.5));
  config.limits.min_standoff = 0.2;
  surfel::SurfelPlanner planner(config, sensor);
  const Flight flight =
      fly(planner, large_ball, 0.0, 200, true, sensor, geometry::look_at({3.5, 0, 0}, {0, 0, 0}));
  EXPECT_LT(true_coverage(planner, large_ball, 0.02), 0.5);
  EXPECT_LT(planner.predicted_coverage(), 0.5);
  EXPECT_EQ(planner.stop_reason(), StopReason::nowhere_to_go);
  for (const View& view : flight.views) EXPECT_GT(view.position.norm(), 1.5 + 0.2 - 0.01);
}

// No permitted view shows the back of the ball.
TEST(SurfelPlanner, NamesRemainingSurfaceOutOfReach) {
  const std::vector<tests::Sphere> large_ball = {{.radius = 1.5}};
  const geometry::Camera sensor({.width = 212, .height = 120, .max_range = 2.06});
  surfel::SurfelPlanner planner(small_config(), sensor);
  planner.keep_to([](const Vector3d& position) { return position.x() > 1.0; });
  fly(planner, large_ball, 0.0, 80, true, sensor, geometry::look_at({3.5, 0, 0}, {0, 0, 0}));
  const double coverage = true_coverage(planner, large_ball, 0.02);
  EXPECT_LT(coverage, 0.8);
  EXPECT_EQ(planner.stop_reason(), StopReason::nowhere_to_go);
  EXPECT_EQ(planner.stop_rule(), "no_reachable_view");
  EXPECT_GT(planner.estimate().unreachable, 0.05);
  EXPECT_LT(planner.predicted_coverage(), 0.95);
}

// Surface observed en route need not be observed again.
TEST(SurfelPlanner, UsesEnRouteScans) {
  surfel::SurfelPlanner standing(small_config(), camera), moving(small_config(), camera);
  const Flight stops = fly(standing, two_balls, 0.01);
  std::size_t views = 0;
  View last = start;
  for (std::optional<View> next = start; next && views < 40; ++views) {
    for (double share = 0.25; views > 0 && share < 1.0; share += 0.25) {
      Vector3d position = (1.0 - share) * last.position + share * next->position;
      if (position.norm() < 1.5) position *= 1.5 / position.norm();  // detour around the balls
      moving.pass(tests::scan_spheres(two_balls, camera, geometry::look_at(position, {0.3, 0, 0}),
                                      0.01, 1000 * views + static_cast<unsigned>(4 * share)));
    }
    last = *next;
    next = moving.next_view(tests::scan_spheres(two_balls, camera, *next, 0.01, 100 + views));
    for (const PartTime& time : moving.last_step().times) EXPECT_GE(time.seconds, 0.0);
  }
  EXPECT_LT(views, stops.views.size());
  const double coverage = true_coverage(moving, two_balls, 0.02);
  EXPECT_GT(coverage, 0.97);
  EXPECT_NEAR(moving.predicted_coverage(), coverage, 0.05);
}

TEST(SurfelPlanner, DoesNotDependOnThreadCount) {
  surfel::SurfelConfig config = small_config();
  surfel::SurfelPlanner one(config, camera);
  config.threads = 3;
  surfel::SurfelPlanner three(config, camera);
  const Flight first = fly(one, two_balls, 0.01, 6), second = fly(three, two_balls, 0.01, 6);
  ASSERT_EQ(first.views.size(), second.views.size());
  for (std::size_t i = 0; i < first.views.size(); ++i) {
    EXPECT_EQ(first.views[i].position, second.views[i].position) << i;
    EXPECT_EQ(first.views[i].direction, second.views[i].direction) << i;
  }
  EXPECT_EQ(one.cloud().positions, three.cloud().positions);
  EXPECT_EQ(one.predicted_coverage(), three.predicted_coverage());
}

TEST(SurfelPlanner, KeepsPointSpacing) {
  surfel::SurfelConfig config = small_config();
  config.spacing = 0.015;
  surfel::SurfelPlanner planner(config, camera);
  fly(planner, ball, 0.01, 3);
  geometry::PointGrid grid(*config.spacing);
  for (const Vector3f& p : planner.cloud().positions) {
    ASSERT_FALSE(grid.any_within(p, *config.spacing));
    grid.insert(p);
  }
  EXPECT_EQ(planner.cloud().views.size(), planner.cloud().size());
}

TEST(SurfelPlanner, KeepsViewLimits) {
  surfel::SurfelConfig config = small_config();
  config.limits.min_height = -0.3;
  config.limits.max_height = 1.9;
  config.limits.min_pitch = -1.2;
  config.limits.max_pitch = 0.1;
  config.limits.min_standoff = 0.5;
  config.limits.geofence = {{-3, -3}, {3, -3}, {3, 3}, {-3, 3}};
  config.limits.no_fly = {{"", {{-3, 0.5}, {-0.5, 0.5}, {-0.5, 3}, {-3, 3}}, -1, 3}};
  surfel::SurfelPlanner planner(config, camera);
  const Flight flight = fly(planner, two_balls, 0.01);
  ASSERT_GT(flight.views.size(), 4U);
  for (std::size_t i = 1; i < flight.views.size(); ++i) {
    EXPECT_TRUE(config.limits.allow(flight.views[i])) << flight.views[i].position.transpose();
    for (const tests::Sphere& sphere : two_balls) {
      // Measured points scatter around the surface by three standard deviations.
      EXPECT_GT((flight.views[i].position - sphere.centre).norm(), sphere.radius + 0.5 - 0.03);
    }
  }
}

TEST(SurfelPlanner, StopsAtConfiguredBudgets) {
  surfel::SurfelConfig config = small_config();
  config.stop.max_length = 4.0;
  surfel::SurfelPlanner brief(config, camera);
  EXPECT_LE(fly(brief, ball, 0.01).length, 4.0);
  EXPECT_EQ(brief.stop(), surfel::SurfelStop::max_length);

  config = small_config();
  config.stop.max_time = 20.0;
  config.stop.speed = 1.0;
  config.stop.time_per_view = 5.0;
  surfel::SurfelPlanner quick(config, camera);
  const Flight flight = fly(quick, ball, 0.01);
  EXPECT_LE(flight.length + 5.0 * static_cast<double>(flight.views.size()), 20.0 + 1e-9);
  EXPECT_EQ(quick.stop(), surfel::SurfelStop::max_time);

  config = small_config();
  config.stop.target_coverage = 0.7;
  surfel::SurfelPlanner content(config, camera);
  fly(content, ball, 0.01);
  EXPECT_EQ(content.stop(), surfel::SurfelStop::target_coverage);
  EXPECT_GE(content.predicted_coverage(), 0.7);
  EXPECT_NEAR(content.estimate().coverage, content.predicted_coverage(), 1e-12);
}

TEST(SurfelPlanner, ProposesAlternativesToUnreachableViews) {
  surfel::SurfelPlanner planner(small_config(), camera);
  const auto first = planner.next_view(tests::scan_spheres(ball, camera, start, 0.01));
  ASSERT_TRUE(first);
  std::vector<View> proposed = {*first};
  for (int i = 0; i < 5; ++i) {
    const auto other = planner.next_alternative_view();
    ASSERT_TRUE(other);
    for (const View& view : proposed) {
      EXPECT_GE((other->position - view.position).norm(), 0.19);  // a tenth of the view distance
    }
    proposed.push_back(*other);
  }
}

TEST(SurfelPlanner, StopsWhilePlanningView) {
  surfel::SurfelPlanner planner(small_config(), camera);
  const geometry::Scan scan = tests::scan_spheres(ball, camera, start, 0.01);
  tests::expect_stop_while_planning(planner, scan);
}

TEST(SurfelPlanner, ProposesOnlyViewsInPermittedRegion) {
  surfel::SurfelPlanner planner(small_config(), camera);
  planner.keep_to(
      [](const Vector3d& position) { return position.x() > 0.0 && position.z() > 0.2; });
  const Flight flight = fly(planner, ball, 0.01, 10);
  ASSERT_GE(flight.views.size(), 3U);
  for (const View& view : flight.views) {
    EXPECT_GT(view.position.x(), 0.0);
    EXPECT_GT(view.position.z(), 0.2);
  }
}

TEST(SurfelPlanner, ReportsMissingSurfaceWithReason) {
  surfel::SurfelConfig config = small_config();
  config.limits.min_height = 0.3;
  config.limits.max_pitch = -0.5;  // the camera only looks down: the lower half is not visible
  surfel::SurfelPlanner planner(config, camera);
  fly(planner, ball, 0.0);
  const surfel::SurveyEstimate estimate = planner.estimate();
  double area = 0.0;
  for (const surfel::EstimatedPatch& patch : estimate.patches) {
    area += patch.area;
    EXPECT_GE(patch.covered_share, 0.0F);
    EXPECT_LE(patch.covered_share, 1.0F);
  }
  EXPECT_NEAR(estimate.area, area, 1e-9 * area);
  // The covered and missing fractions sum to the whole surface.
  double covered = 0.0;
  for (const surfel::EstimatedPatch& patch : estimate.patches)
    covered += patch.area * patch.covered_share;
  EXPECT_NEAR(covered / estimate.area + estimate.seen_too_thinly + estimate.never_seen +
                  estimate.unreachable,
              1.0, 1e-6);
}

// The first scan is from a position outside the fence. It undersamples surface that is not visible
// from allowed views. Surface that is visible from them is not reported.
TEST(SurfelPlanner, ReportsUnreachableSurface) {
  surfel::SurfelConfig config = small_config();
  config.coverage_radius = 0.005;  // much smaller than the noise: one observation covers little
  config.limits.geofence = {{-9, -9}, {-1, -9}, {-1, 9}, {-9, 9}};
  surfel::SurfelPlanner planner(config, camera);
  fly(planner, ball, 0.03, 10);
  const surfel::SurveyEstimate estimate = planner.estimate();
  EXPECT_GT(estimate.unreachable, 0.05);
  for (const surfel::EstimatedPatch& patch : estimate.patches) {
    if (patch.reason == surfel::MissingReason::unreachable) {
      EXPECT_GT(patch.position.x(), 0.0F);
    }
  }
  // Without the fence the whole ball is reachable.
  config.limits.geofence.clear();
  surfel::SurfelPlanner free(config, camera);
  fly(free, ball, 0.03, 10);
  EXPECT_LT(free.estimate().unreachable, 0.01);
}

// With a sensor without returns from slanted surfaces, a view covers less of a ball.
TEST(SurfelPlanner, PredictsNoCoverageBeyondMaxIncidence) {
  const geometry::Scan scan = tests::scan_spheres(ball, camera, start, 0.01);
  const auto next_gain = [&](double max_incidence) {
    surfel::SurfelConfig config = small_config();
    config.max_incidence = max_incidence;
    surfel::SurfelPlanner planner(config, camera);
    planner.next_view(scan);
    return planner.estimate().next_gain;
  };
  EXPECT_LT(next_gain(0.5), 0.9 * next_gain(1.5707));
  EXPECT_EQ(next_gain(1.4), next_gain(1.5707));  // at such angles nothing is expected anyway
}

TEST(SurfelPlanner, PlansFromSweepsWithoutPixels) {
  surfel::SurfelPlanner planner(small_config(), camera);
  fly(planner, ball, 0.01, 15, false);
  EXPECT_GT(true_coverage(planner, ball, 0.02), 0.95);
}

TEST(SurfelPlanner, RejectsFirstScanWithoutPoints) {
  surfel::SurfelPlanner planner(small_config(), camera);
  try {
    planner.next_view(tests::scan_spheres({}, camera, start));
    FAIL() << "accepted a first scan without a point";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_geometry);
    EXPECT_THAT(error.what(), HasSubstr("first scan"));
  }
}

TEST(SurfelPlanner, AcceptsLaterScanWithoutPoints) {
  surfel::SurfelPlanner planner(small_config(), camera);
  ASSERT_TRUE(planner.next_view(tests::scan_spheres(ball, camera, start, 0.01)));
  const std::size_t points = planner.cloud().size();
  EXPECT_TRUE(planner.next_view(tests::scan_spheres({}, camera, start)));
  EXPECT_EQ(planner.cloud().size(), points);
}

// A switch without effect would leave the flight unchanged.
TEST(SurfelPlanner, ChangesPlanWithEveryAblationSwitch) {
  const auto executed_positions = [](const surfel::SurfelConfig& config) {
    surfel::SurfelPlanner planner(config, camera);
    std::vector<Vector3d> positions;
    for (const View& view : fly(planner, two_balls, 0.01, 12).views)
      positions.push_back(view.position);
    return positions;
  };
  const std::vector<Vector3d> with_all = executed_positions(small_config());
  using Switches = surfel::AblationSwitches;
  for (const auto& [name, ablation_switch] : {std::pair{"dose", &Switches::coverage_model},
                                              {"unseen_surface", &Switches::surface_prediction},
                                              {"free_space", &Switches::free_space},
                                              {"learned_rates", &Switches::learned_rates},
                                              {"targeted_views", &Switches::targeted_views},
                                              {"refinement", &Switches::refinement},
                                              {"batch", &Switches::batch}}) {
    SCOPED_TRACE(name);
    surfel::SurfelConfig config = small_config();
    config.ablation.*ablation_switch = false;
    const std::vector<Vector3d> without = executed_positions(config);
    EXPECT_GE(without.size(), 2U);
    EXPECT_NE(without, with_all);
  }
}

TEST(SurfelConfig, ReportsTheInvalidField) {
  const auto validation_error =
      [](const std::function<void(surfel::SurfelConfig&)>& change) -> std::string {
    surfel::SurfelConfig config;
    change(config);
    try {
      surfel::SurfelPlanner planner(config, camera);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::bad_config);
      return error.what();
    }
    return "accepted";
  };
  EXPECT_THAT(validation_error([](surfel::SurfelConfig& c) { c.coverage_radius = 0.0; }),
              HasSubstr("coverage_radius"));
  EXPECT_THAT(validation_error([](surfel::SurfelConfig& c) { c.view_distance = -1.0; }),
              HasSubstr("view_distance"));
  EXPECT_THAT(validation_error([](surfel::SurfelConfig& c) { c.stop.target_coverage = 97.0; }),
              HasSubstr("target_coverage"));
  EXPECT_THAT(validation_error([](surfel::SurfelConfig& c) { c.continuation_steps = 9; }),
              HasSubstr("continuation_steps"));
  EXPECT_THAT(validation_error([](surfel::SurfelConfig& c) { c.max_incidence = 2.0; }),
              HasSubstr("max_incidence"));
  EXPECT_THAT(validation_error([](surfel::SurfelConfig& c) { c.limits.min_standoff = -2.0; }),
              HasSubstr("stand_off"));
}

}  // namespace
}  // namespace skycap::survey
