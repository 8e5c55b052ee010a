#include "survey/see/see.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/pose/pose.h"
#include "survey/see/frontier.h"
#include "tests/support/sphere_sensor.h"
#include "tests/support/stopped_planner.h"

namespace skycap::survey {
namespace {

using Eigen::Vector3d;
using geometry::View;
using testing::HasSubstr;

/// A D435 with a sixteenth of its pixels. The density is reduced by the same factor, so that
/// distances remain the published ones.
const geometry::Camera small_camera(geometry::CameraConfig{.width = 212, .height = 120});

see::SeeConfig small_config() {
  return {.density = 146'000.0 / 16, .resolution_radius = 0.017 * std::cbrt(16.0)};
}

struct Outcome {
  std::vector<View> views;
  std::vector<Eigen::Vector3f> cloud;
  std::size_t frontiers_resolved = 0;
  bool ended = false;
};

/// Surveys spheres until the planner has finished, with at most `max_views` views.
Outcome survey(const see::SeeConfig& config, double sigma, std::size_t max_views = 200,
               const std::vector<tests::Sphere>& spheres = {{}}, std::uint64_t seed = 1) {
  see::SeePlanner planner(config, small_camera);
  Outcome run;
  std::optional<View> next = geometry::look_at({2.4, 0.3, 0.2}, {0, 0, 0});
  while (next && run.views.size() < max_views) {
    run.views.push_back(*next);
    next = planner.next_view(
        tests::scan_spheres(spheres, small_camera, *next, sigma, 1000 * seed + run.views.size()));
    run.frontiers_resolved += planner.last_step().frontiers_resolved;
  }
  run.ended = !next;
  run.cloud = planner.cloud().positions;
  return run;
}

/// Returns the fraction of 1,000 directions from the origin in which a sphere of radius 0.5 has a
/// point nearby.
double coverage(const std::vector<Eigen::Vector3f>& cloud, double distance) {
  int covered = 0;
  for (int i = 0; i < 1000; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / 1000, azimuth = 2.399963229728653 * i;
    const double across = std::sqrt(1.0 - z * z);
    const Eigen::Vector3f sample =
        (0.5 * Vector3d(across * std::cos(azimuth), across * std::sin(azimuth), z)).cast<float>();
    for (const Eigen::Vector3f& p : cloud) {
      if ((p - sample).norm() > distance) continue;
      ++covered;
      break;
    }
  }
  return covered / 1000.0;
}

std::vector<Vector3d> collect_positions(const std::vector<View>& views) {
  std::vector<Vector3d> positions;
  for (const View& view : views) positions.push_back(view.position);
  return positions;
}

TEST(SeePlanner, SurveysNoisySphereAndEnds) {
  for (const bool plus_plus : {false, true}) {
    see::SeeConfig config = small_config();
    config.optimise_views = config.visibility_graph = plus_plus;
    const Outcome run = survey(config, 0.02);
    EXPECT_TRUE(run.ended) << run.views.size() << " views";
    EXPECT_GT(run.views.size(), 4U);
    EXPECT_GT(coverage(run.cloud, 0.03), 0.97);
  }
}

// Trap T1: noise creates frontiers. With the published settings and clean data, the survey of a
// sphere correctly ends after a few views. A threshold for clean data surveys the whole sphere.
TEST(SeePlanner, RequiresNoiseOrLargerThreshold) {
  const geometry::Camera d435(geometry::CameraConfig{});
  see::SeePlanner published(see::SeeConfig{}, d435);
  std::optional<View> next = geometry::look_at({2.4, 0.3, 0.2}, {0, 0, 0});
  for (int view = 0; next && view < 10; ++view) {
    next = published.next_view(tests::scan_spheres({{}}, d435, *next));
  }
  EXPECT_FALSE(next);

  see::SeeConfig config = small_config();
  config.core_threshold = config.half_disc_threshold();
  const Outcome larger_threshold = survey(config, 0.0);
  EXPECT_TRUE(larger_threshold.ended);
  EXPECT_GT(coverage(larger_threshold.cloud, 0.03), 0.99);
}

// Trap T2 and its error message.
TEST(SeePlanner, RejectsParametersThatAdmitNoFrontier) {
  const auto error_message = [](const see::SeeConfig& config) -> std::string {
    try {
      config.validate();
      return "";
    } catch (const Error& error) {
      return error.what();
    }
  };
  EXPECT_EQ(error_message(see::SeeConfig{}), "");
  EXPECT_EQ(see::SeeConfig{}.effective_core_threshold(), 4);  // the paper's 3.0046, rounded up
  EXPECT_THAT(error_message({.resolution_radius = 0.01}), HasSubstr("no point can be a frontier"));
  EXPECT_THAT(error_message({.core_threshold = 3}), HasSubstr("core_threshold"));
  EXPECT_THAT(error_message({.spacing = 0.02}), HasSubstr("spacing"));
  EXPECT_THAT(error_message({.density = NAN}), HasSubstr("density"));
}

// SEE selects the nearest proposal. Rejecting one view after another lists all of them in order of
// distance. Without the frontier spacing, there is one for each frontier.
TEST(SeePlanner, SelectsNearestViewWithoutOptimiserAndGraph) {
  see::SeeConfig config = small_config();
  config.optimise_views = config.visibility_graph = false;
  see::SeePlanner planner(config, small_camera);
  const View start = geometry::look_at({2.4, 0.3, 0.2}, {0, 0, 0});
  std::optional<View> next =
      planner.next_view(tests::scan_spheres({{}}, small_camera, start, 0.02));
  std::size_t proposals = 0;
  double last = 0.0;
  for (; next; next = planner.next_alternative_view(), ++proposals) {
    const double distance = (next->position - start.position).norm();
    // The first view decides between equal distances.
    EXPECT_GE(distance, last - 1e-8) << "proposal " << proposals;
    last = distance;
  }
  EXPECT_EQ(proposals, planner.last_step().frontiers);
  EXPECT_GT(proposals, 20U);
}

// Requirement: without optimiser and graph, SEE++ equals SEE, view by view.
TEST(SeePlanner, EqualsSeeWithoutOptimiserAndGraph) {
  see::SeeConfig config = small_config();
  config.optimise_views = config.visibility_graph = false;
  const Outcome exact = survey(config, 0.02, 12);
  config.occlusion_search_distance = 0.3;  // parameters of SEE++ only have no effect
  config.visibility_update_limit = 3;
  config.still_occluded = see::StillOccluded::keep;
  const Outcome same = survey(config, 0.02, 12);
  ASSERT_EQ(exact.views.size(), same.views.size());
  for (std::size_t i = 0; i < exact.views.size(); ++i) {
    EXPECT_EQ(exact.views[i].position, same.views[i].position);
  }
  EXPECT_EQ(exact.cloud, same.cloud);
}

TEST(SeePlanner, IsDeterministic) {
  const Outcome first = survey(small_config(), 0.02, 15), second = survey(small_config(), 0.02, 15);
  ASSERT_EQ(first.views.size(), second.views.size());
  for (std::size_t i = 0; i < first.views.size(); ++i) {
    EXPECT_EQ(first.views[i].position, second.views[i].position);
    EXPECT_EQ(first.views[i].direction, second.views[i].direction);
  }
}

// Trap T6: each proposal is outside at the view distance from the surface and looks at it.
TEST(SeePlanner, ProposesViewsFromOutsideAtViewDistance) {
  const Outcome run = survey(small_config(), 0.02, 15);
  ASSERT_GT(run.views.size(), 1U);
  for (std::size_t i = 1; i < run.views.size(); ++i) {
    const Vector3d target = run.views[i].position + 1.98 * run.views[i].direction;
    EXPECT_NEAR(target.norm(), 0.5, 0.15) << "view " << i;  // the frontier is within the noise
    EXPECT_GT(run.views[i].position.norm(), 1.4) << "view " << i;
  }
}

// Trap T9: the first scan must not be empty. A later empty scan only discards the target.
TEST(SeePlanner, RejectsEmptyFirstScan) {
  see::SeePlanner planner(small_config(), small_camera);
  try {
    planner.next_view(geometry::Scan{});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::bad_geometry);
    EXPECT_THAT(error.what(), HasSubstr("first scan"));
  }
}

TEST(SeePlanner, EndsWhenAllLaterScansAreEmpty) {
  see::SeePlanner planner(small_config(), small_camera);
  const View first = geometry::look_at({2.4, 0.3, 0.2}, {0, 0, 0});
  std::optional<View> next =
      planner.next_view(tests::scan_spheres({{}}, small_camera, first, 0.02));
  std::size_t views = 0;
  const std::size_t frontiers = planner.last_step().frontiers;
  ASSERT_GT(frontiers, 0U);
  for (; next && views <= frontiers; ++views) {
    geometry::Scan nothing;
    nothing.world_from_sensor = geometry::camera_pose(*next);
    next = planner.next_view(nothing);
  }
  EXPECT_FALSE(next);  // each empty scan discarded its frontier
}

TEST(SeePlanner, StopsWhilePlanningView) {
  see::SeePlanner planner(small_config(), small_camera);
  const View first = geometry::look_at({2.4, 0.3, 0.2}, {0, 0, 0});
  const auto scan = tests::scan_spheres({{}}, small_camera, first, 0.02);
  tests::expect_stop_while_planning(planner, scan);
}

TEST(SeePlanner, ProposesEveryFrontierWhenViewsAreRejected) {
  see::SeePlanner planner(small_config(), small_camera);
  const View first = geometry::look_at({2.4, 0.3, 0.2}, {0, 0, 0});
  std::optional<View> next =
      planner.next_view(tests::scan_spheres({{}}, small_camera, first, 0.02));
  const std::size_t frontiers = planner.last_step().frontiers;
  std::vector<Vector3d> offered;
  while (next && offered.size() <= frontiers) {
    EXPECT_THAT(offered, testing::Not(testing::Contains(next->position)));
    offered.push_back(next->position);
    next = planner.next_alternative_view();
  }
  EXPECT_FALSE(next);
  EXPECT_EQ(offered.size(), frontiers);
}

TEST(SeePlanner, ReobservesFromViewDistanceOrNearerOrHigherOrigin) {
  see::Frontier frontier{};
  frontier.position = {1, 0, 0};
  const auto again = [&](const Vector3d& seen_from, std::optional<double> min_height) {
    frontier.observed_from = seen_from;
    const View view = see::reobserve_view(frontier, {.distance = 2.0, .min_height = min_height});
    EXPECT_NEAR((view.direction + (seen_from - frontier.position).normalized()).norm(), 0, 1e-12);
    return view.position;
  };
  const auto is_at = [](const Vector3d& at, const Vector3d& expected) {
    return (at - expected).norm() < 1e-12;
  };
  EXPECT_TRUE(is_at(again({6, 0, 0}, {}), {3, 0, 0}));
  EXPECT_TRUE(is_at(again({2, 0, 0}, {}), {2, 0, 0}));
  EXPECT_TRUE(is_at(again({7, 0, 8}, 1.0), {1 + 1.2, 0, 1.6}));
  EXPECT_TRUE(is_at(again({7, 0, 8}, 4.0), {4, 0, 4}));
  EXPECT_TRUE(is_at(again({7, 0, 8}, 9.0), {7, 0, 8}));
}

// Deferred frontiers are proposed again when nothing else is left, along the line of their
// observation.
TEST(SeePlanner, ProposesRejectedFrontiersAgainAlongTheirObservation) {
  see::SeeConfig config = small_config();
  config.still_occluded = see::StillOccluded::deferred;
  see::SeePlanner planner(config, small_camera);
  const View first = geometry::look_at({2.4, 0.3, 0.2}, {0, 0, 0});  // closer than d to some points
  std::optional<View> next =
      planner.next_view(tests::scan_spheres({{}}, small_camera, first, 0.02));
  const std::size_t frontiers = planner.last_step().frontiers;
  std::vector<View> offered;
  for (; next && offered.size() <= 2 * frontiers; next = planner.next_alternative_view()) {
    offered.push_back(*next);
  }
  EXPECT_FALSE(next);
  ASSERT_GT(offered.size(), frontiers);
  for (std::size_t i = offered.size() - frontiers; i < offered.size(); ++i) {
    // On the line from the first view to the frontier, and not farther away than that view.
    const Vector3d to_view = offered[i].position - first.position;
    EXPECT_NEAR(to_view.cross(offered[i].direction).norm(), 0.0, 1e-6);
    EXPECT_GE(to_view.dot(offered[i].direction), -1e-6);
  }
}

TEST(SeePlanner, IgnoresMeasurementsOutsideSceneBox) {
  see::SeeConfig config = small_config();
  config.scene_box = Eigen::AlignedBox3d(Vector3d(-1, -1, 0), Vector3d(1, 1, 1));
  const Outcome run = survey(config, 0.02, 3);
  ASSERT_FALSE(run.cloud.empty());
  for (const Eigen::Vector3f& p : run.cloud) EXPECT_GE(p.z(), 0.0F);
}

TEST(SeePlanner, KeepsViewsAboveMinHeight) {
  see::SeeConfig config = small_config();
  config.min_height = -0.2;
  const Outcome run = survey(config, 0.02, 40);
  ASSERT_GT(run.views.size(), 1U);
  for (std::size_t i = 1; i < run.views.size(); ++i) {
    EXPECT_GE(run.views[i].position.z(), -0.2 - 1e-9);
  }
}

// Each interpretation of the paper that a mission file can select surveys the complete sphere, with
// different views.
TEST(SeePlanner, CompletesSurveyWithEveryAlternativeConfiguration) {
  const std::vector<std::pair<const char*, void (*)(see::SeeConfig&)>> alternatives = {
      {"frame_neighbours", [](see::SeeConfig& c) { c.frame_neighbours = 16; }},
      {"free_space_normals", [](see::SeeConfig& c) { c.free_space_normals = true; }},
      {"offset_line", [](see::SeeConfig& c) { c.offset_line = see::OffsetLine::normal; }},
      {"occlusion_radius", [](see::SeeConfig& c) { c.occlusion_radius = 0.02; }},
      {"march_end",
       [](see::SeeConfig& c) { c.march_end = see::MarchEnd::search_distance_from_offset; }},
      {"cap global", [](see::SeeConfig& c) { c.cap.policy = geometry::CapPolicy::global; }},
      {"cap program",
       [](see::SeeConfig& c) { c.cap.policy = geometry::CapPolicy::nonlinear_program; }},
      {"observing_direction",
       [](see::SeeConfig& c) { c.observing_direction = see::ObservingDirection::image_axis; }},
      {"keep if still occluded",
       [](see::SeeConfig& c) { c.still_occluded = see::StillOccluded::keep; }},
      {"put off if still occluded",
       [](see::SeeConfig& c) { c.still_occluded = see::StillOccluded::deferred; }},
      {"facing and field of view",
       [](see::SeeConfig& c) { c.facing_test = c.field_of_view_test = true; }},
      {"octree", [](see::SeeConfig& c) { c.nearest = see::NearestSearch::octree; }},
      {"shift", [](see::SeeConfig& c) { c.adjustment = see::Adjustment::shift; }},
      {"accepted points",
       [](see::SeeConfig& c) { c.adjustment_centroid = see::ScanCentroid::accepted_points; }},
      {"stay_on_target", [](see::SeeConfig& c) { c.stay_on_target = true; }},
      {"frontier_spacing", [](see::SeeConfig& c) { c.frontier_spacing = 0.1; }},
  };
  // Three spheres that hide parts of each other, with noise that leaves frontiers unresolved.
  const auto collect_views = [](const see::SeeConfig& config) {
    return collect_positions(
        survey(config, 0.03, 60, {{}, {{0.8, 0.3, 0}, 0.3}, {{-0.2, 0.75, 0.1}, 0.25}}).views);
  };
  const std::vector<Vector3d> published = collect_views(small_config());
  for (const auto& [name, choose] : alternatives) {
    see::SeeConfig config = small_config();
    choose(config);
    const Outcome run = survey(config, 0.02);
    EXPECT_TRUE(run.ended) << name;
    EXPECT_GT(coverage(run.cloud, 0.03), 0.9) << name;
    // Deferred frontiers are only observed when nothing else is left, long after these views.
    if (config.still_occluded == see::StillOccluded::deferred) continue;
    EXPECT_NE(collect_views(config), published) << name << " changes nothing";
  }
}

}  // namespace
}  // namespace skycap::survey
