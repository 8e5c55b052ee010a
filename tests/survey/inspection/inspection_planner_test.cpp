#include "survey/inspection/inspection_planner.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/interrupted.h"
#include "geometry/random_numbers.h"

namespace skycap::survey::inspection {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

/// Random points on the surface of a box around the origin.
std::vector<Vector3f> box_points(const Vector3d& half, std::size_t count, std::uint64_t seed) {
  geometry::RandomNumbers random(seed);
  const Vector3d areas(half.y() * half.z(), half.x() * half.z(), half.x() * half.y());
  std::vector<Vector3f> points;
  while (points.size() < count) {
    Vector3d point;
    for (int axis = 0; axis < 3; ++axis) point[axis] = random.between(-half[axis], half[axis]);
    double pick = random.uniform() * areas.sum();
    int axis = 0;
    while (axis < 2 && pick > areas[axis]) pick -= areas[axis++];
    point[axis] = random.uniform() < 0.5 ? half[axis] : -half[axis];
    points.push_back(point.cast<float>());
  }
  return points;
}

InspectionOptions quick_options() {
  InspectionOptions options;
  options.moves = 4000;
  options.searches = 2;
  options.candidates = 400;
  options.goal.shares = {0.0, 0.0, 0.97};
  return options;
}

InspectionSite cube_site() {
  InspectionSite site;
  site.points = box_points(Vector3d::Constant(2.0), 3000, 7);
  return site;
}

/// Smallest distance of a flight from points, by trying all pairs of samples and points.
double nearest_by_trying(const std::vector<FlightSample>& flight,
                         const std::vector<Vector3f>& points) {
  double nearest = 1e9;
  for (const FlightSample& sample : flight) {
    for (const Vector3f& point : points) {
      nearest = std::min(nearest, (point.cast<double>() - sample.position).norm());
    }
  }
  return nearest;
}

std::string error_of(const InspectionOptions& options, const InspectionSite& site) {
  try {
    plan_inspection(options, site, {});
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// One plan for the expectations below, because it takes seconds.
const InspectionPlan& cube_plan() {
  static const InspectionPlan plan = plan_inspection(quick_options(), cube_site(), {});
  return plan;
}

TEST(PlanInspection, SeesACubeWithinAllLimits) {
  const InspectionPlan& plan = cube_plan();
  EXPECT_TRUE(plan.meets_goal);
  EXPECT_GE(plan.evaluation.share(2), 0.97 * 0.97);
  EXPECT_TRUE(plan.evaluation.keeps_limits());
  EXPECT_LE(plan.evaluation.speed.max, 2.0 + 1e-6);
  EXPECT_LE(plan.evaluation.acceleration.max, 1.0);
  EXPECT_LE(plan.evaluation.jerk.max, 0.5);
  EXPECT_GE(nearest_by_trying(plan.samples, cube_site().points), 3.0);
  EXPECT_GE(plan.verified_clearance, 3.0);
  EXPECT_LT(plan.evaluation.duration, plan.first_duration);
}

TEST(PlanInspection, DoesNotDependOnThreads) {
  InspectionRun run;
  run.threads = 2;
  const InspectionPlan other = plan_inspection(quick_options(), cube_site(), run);
  EXPECT_EQ(other.vertices, cube_plan().vertices);
  EXPECT_EQ(other.evaluation.rules_seen, cube_plan().evaluation.rules_seen);
  EXPECT_EQ(other.verified_clearance, cube_plan().verified_clearance);
}

TEST(PlanInspection, GivesSimilarDurationsForOtherSeeds) {
  InspectionRun run;
  run.seed = 2;
  const InspectionPlan other = plan_inspection(quick_options(), cube_site(), run);
  EXPECT_NE(other.vertices, cube_plan().vertices);
  // Four thousand moves leave more spread than a full budget.
  EXPECT_NEAR(other.evaluation.duration / cube_plan().evaluation.duration, 1.0, 0.25);
}

TEST(PlanInspection, KeepsTheLimitsOfHeight) {
  InspectionSite site = cube_site();
  site.min_height = -1.0;
  const InspectionPlan plan = plan_inspection(quick_options(), site, {});
  for (const FlightSample& sample : plan.samples) EXPECT_GE(sample.position.z(), -1.0 - 1e-9);
  // The underside is attainable from below only.
  EXPECT_LT(plan.attainable[2], cube_plan().attainable[2]);
}

TEST(PlanInspection, SeesEveryPointSeveralTimesIfRequired) {
  InspectionOptions options = quick_options();
  options.goal.min_views = 3;
  const InspectionPlan plan = plan_inspection(options, cube_site(), {});
  EXPECT_TRUE(plan.meets_goal);
  EXPECT_GT(plan.evaluation.views.percentile_10, cube_plan().evaluation.views.percentile_10);
  EXPECT_GE(plan.evaluation.views.percentile_10,
            2.0);  // evaluated every 0.5 s, planned every 0.4 s
}

TEST(PlanInspection, KeepsOtherObstaclesAndTheirExactDistance) {
  InspectionSite site = cube_site();
  const std::vector<Vector3f> points = site.points;
  // A wall at y = 7 beside the cube.
  const auto distance = [points](const Vector3d& position, double up_to) {
    double nearest = std::min(up_to, std::max(0.0, 7.0 - position.y()));
    for (const Vector3f& point : points) {
      nearest = std::min(nearest, (point.cast<double>() - position).norm());
    }
    return nearest;
  };
  site.distance = distance;
  site.segment_distance = [distance](const Vector3d& from, const Vector3d& to, double up_to) {
    const double of_ends = std::min(distance(from, up_to + 1.0), distance(to, up_to + 1.0));
    return std::min(up_to, of_ends - 0.5 * (to - from).norm());  // a lower bound
  };
  InspectionOptions options = quick_options();
  options.clearance = 2.0;
  options.moves = 3000;
  options.candidates = 300;
  const InspectionPlan plan = plan_inspection(options, site, {});
  for (const FlightSample& sample : plan.samples) EXPECT_LE(sample.position.y(), 5.0);
}

TEST(PlanInspection, PlansForAPlaneAndForCloudsWithHolesAndRepeatedPoints) {
  InspectionOptions options = quick_options();
  options.moves = 2000;
  options.candidates = 300;
  InspectionSite site;
  for (const Vector3f& point : box_points({4.0, 0.01, 3.0}, 1500, 3)) {
    const bool is_in_hole = std::abs(point.x() - 1.0F) < 0.7F && std::abs(point.z()) < 0.7F;
    if (is_in_hole) continue;
    site.points.push_back({point.x(), 0.0F, point.z()});
    site.points.push_back({point.x(), 0.0F, point.z()});
  }
  const InspectionPlan plan = plan_inspection(options, site, {});
  EXPECT_TRUE(plan.evaluation.keeps_limits());
  EXPECT_GE(plan.verified_clearance, 3.0);
  EXPECT_LT(plan.cloud.size(), site.points.size());
}

TEST(PlanInspection, PlansOrRejectsTenPoints) {
  InspectionOptions options = quick_options();
  options.moves = 500;
  options.candidates = 100;
  InspectionSite site;
  site.points = box_points(Vector3d::Constant(0.5), 10, 2);
  const InspectionPlan plan = plan_inspection(options, site, {});
  EXPECT_GE(plan.verified_clearance, 3.0);
  site.points.resize(7);
  EXPECT_EQ(error_of(options, site),
            "the structure has 7 distinct points, and at least 8 are required; use a complete "
            "point cloud");
}

TEST(PlanInspection, RejectsImpossibleClearancesWithOneLine) {
  InspectionOptions options = quick_options();
  options.clearance = 8.0;
  EXPECT_EQ(error_of(options, cube_site()),
            "range (8 m) must be greater than the clearance (8 m); raise the range or lower the "
            "clearance");
  options.clearance = 3.0;
  InspectionSite site = cube_site();
  site.min_height = 3.0;
  site.max_height = 4.0;
  options.camera.range = 4.0;
  site.distance = [](const Vector3d&, double) { return 1.0; };
  EXPECT_EQ(error_of(options, site),
            "no position around the structure keeps the clearance within the height and airspace "
            "limits; lower the clearance or check the limits");
}

TEST(PlanInspection, RejectsImpossibleLimitsAndSizesWithOneLine) {
  const auto with = [](double MotionLimits::*limit, double value) {
    InspectionOptions options = quick_options();
    options.moves = 200;
    options.candidates = 100;
    options.limits.*limit = value;
    return error_of(options, cube_site());
  };
  const std::string too_slow =
      "the limits of motion allow no flight around the structure in a day; raise the limits of "
      "speed, acceleration, jerk or yaw";
  EXPECT_EQ(with(&MotionLimits::speed, 1e-6), too_slow);
  EXPECT_EQ(with(&MotionLimits::acceleration, 1e-9), too_slow);
  EXPECT_EQ(with(&MotionLimits::jerk, 1e-12), too_slow);
  EXPECT_EQ(with(&MotionLimits::yaw_rate, 1e-9), too_slow);
  EXPECT_EQ(with(&MotionLimits::yaw_acceleration, 0.0), "yaw_acceleration must be positive");

  InspectionSite site = cube_site();
  site.points.push_back({0.0F, 5e6F, 1.0F});  // an outlier
  EXPECT_THAT(error_of(quick_options(), site),
              testing::StartsWith("the structure with the range around it spans 24 x 5e+06 x "));
  InspectionOptions options = quick_options();
  options.camera.range = 900.0;
  EXPECT_THAT(error_of(options, cube_site()), testing::HasSubstr("which is too large; lower the"));
}

TEST(PlanInspection, KeepsTheDeviationOfTheFlownCurveInAddition) {
  InspectionOptions options = quick_options();
  options.moves = 2000;
  options.flown_deviation = 0.4;
  const InspectionPlan plan = plan_inspection(options, cube_site(), {});
  EXPECT_GE(nearest_by_trying(plan.samples, cube_site().points), 3.4);
}

// Points behind the front are in the image, but hidden in their pixels by the nearer points.
TEST(PlanInspection, SeesAllPointsByPixelsIfRequired) {
  InspectionOptions options = quick_options();
  options.goal.shares = {1.0, 0.0, 0.9};
  options.camera.width = 160;  // large pixels, so that nearer points often hide others
  options.camera.height = 120;
  const InspectionPlan plan = plan_inspection(options, cube_site(), {});
  EXPECT_TRUE(!plan.meets_goal || plan.evaluation.seen[0] == plan.attainable[0]);
  EXPECT_GE(plan.evaluation.seen[0] + 3, plan.attainable[0]);
}

TEST(FollowVertices, GivesThePlannedFlightForItsVertices) {
  const InspectionSite site = cube_site();
  const InspectionPlan plan = plan_inspection(quick_options(), site, {});
  const GivenPlan given = follow_vertices(quick_options(), site, plan.vertices, {});
  EXPECT_TRUE(given.problems.empty());
  EXPECT_EQ(given.slowed_legs, 0U);
  EXPECT_EQ(given.plan.vertices, plan.vertices);
  EXPECT_EQ(given.plan.evaluation.seen, plan.evaluation.seen);
  EXPECT_EQ(given.plan.verified_clearance, plan.verified_clearance);
  ASSERT_EQ(given.plan.samples.size(), plan.samples.size());
  EXPECT_EQ(given.plan.samples.back().position, plan.samples.back().position);
}

// A reversal at full speed needs twice the acceleration of the limit.
TEST(FollowVertices, SlowsLegsUntilTheMotionLimitsAreKept) {
  std::vector<Vertex> vertices(5);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    vertices[i].position = {i % 2 == 0 ? -9.0 : 9.0, -7.0, 0.5 * static_cast<double>(i)};
    vertices[i].yaw = 1.5;
  }
  const GivenPlan given = follow_vertices(quick_options(), cube_site(), vertices, {});
  EXPECT_TRUE(given.problems.empty());
  EXPECT_GT(given.slowed_legs, 0U);
  EXPECT_GT(given.added_delay, 0.0);
  EXPECT_TRUE(given.plan.evaluation.keeps_limits());
  EXPECT_GT(given.plan.evaluation.duration, 4 * 18.0 / quick_options().limits.speed);
}

TEST(FollowVertices, NamesTheLegsThatViolateTheClearance) {
  std::vector<Vertex> vertices(4);
  vertices[0].position = {-20, -20, 0};
  vertices[1].position = {20, -20, 0};
  vertices[2].position = {-20, 20, 0};  // through the cube
  vertices[3].position = {-40, 20, 0};
  const GivenPlan given = follow_vertices(quick_options(), cube_site(), vertices, {});
  ASSERT_EQ(given.problems.size(), 1U);
  EXPECT_EQ(given.problems[0].leg, 1U);
  EXPECT_THAT(given.problems[0].what, testing::HasSubstr(" m from the nearest obstacle at ("));
}

TEST(FollowVertices, RejectsHeightsAndPitchesOutsideTheLimits) {
  InspectionSite site = cube_site();
  site.max_height = 9.0;
  InspectionOptions options = quick_options();
  options.pitch.max = 0.5;
  std::vector<Vertex> vertices(3);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    vertices[i].position = {-20.0 + 20.0 * static_cast<double>(i), -20, 5};
  }
  vertices[1].pitch = 1.0;
  vertices[2].position.z() = 10;
  const GivenPlan given = follow_vertices(options, site, vertices, {});
  std::string all;
  for (const FlightProblem& problem : given.problems) all += problem.what + "\n";
  EXPECT_THAT(all, testing::HasSubstr("height 10 m is above the maximum of 9 m"));
  EXPECT_THAT(all, testing::HasSubstr("the gimbal pitch is outside of "));
  EXPECT_THROW(follow_vertices(options, site, {vertices[0]}, {}), Error);
}

TEST(PlanInspection, StopsOnRequest) {
  std::stop_source source;
  source.request_stop();
  InspectionRun run;
  run.stop = source.get_token();
  EXPECT_THROW(plan_inspection(quick_options(), cube_site(), run), skycap::Interrupted);
}

// Twin: all points seen by the final route, counted from the beginning.
TEST(SearchRoute, KeepsItsCountsOverManyMoves) {
  const StructureCloud cloud = make_structure_cloud(cube_site().points);
  SpaceOptions space_options;
  space_options.box = cloud.box();
  space_options.box.min().array() -= 10.0;
  space_options.box.max().array() += 10.0;
  const ReachableSpace space(cloud, space_options);
  const InspectionCamera camera;
  const SightCells cells(cloud, camera, space.box());
  geometry::RandomNumbers random(3);
  TourOptions tour;
  tour.candidates = 300;
  tour.targets = cloud.size();
  const ViewCandidates candidates = draw_candidates(space, cells, tour, random);
  SearchOptions options;
  options.goal.shares = {0.9, 0.9, 0.9};  // all three rules
  options.moves = 1500;
  options.first_phase_targets = cloud.size();
  const SearchResult result =
      search_route(space, cells, candidates, make_first_tour(space, cells, candidates, tour, {}),
                   options, random, {});
  EXPECT_GT(result.accepted, 100U);

  const Smoothing smoothing = make_smoothing(options.limits);
  const std::vector<Vertex>& vertices = result.last.vertices;
  const std::vector<double> durations = leg_durations(vertices, smoothing);
  PerRule<std::vector<char>> seen;
  for (auto& of_rule : seen) of_rule.assign(cloud.size(), 0);
  IntervalCurve curve;
  for (std::size_t i = 0; i <= vertices.size(); ++i) {
    curve.set(vertices, durations, smoothing, i);
    for (int j = 0; curve.begin() + 0.4 * j < curve.end(); ++j) {
      const Coordinates at = curve.position(curve.begin() + 0.4 * j);
      std::vector<PointSight> sights;
      cells.add_view(at.head<3>(), at[3], at[4], cloud.size(), 1, sights);
      for (const PointSight sight : sights) {
        for (std::size_t rule = 0; rule < sight.level(); ++rule) seen[rule][sight.point()] = 1;
      }
    }
  }
  for (std::size_t rule = 0; rule < sight_rules; ++rule) {
    const auto unseen = static_cast<std::size_t>(std::ranges::count(seen[rule], 0));
    EXPECT_EQ(result.last.unseen[rule], unseen) << "rule " << rule;
  }
  EXPECT_DOUBLE_EQ(result.last.duration, flight_duration(durations, smoothing));
}

TEST(RoutePenalty, IsZeroForAGentleFlightOnly) {
  const StructureCloud cloud = make_structure_cloud(cube_site().points);
  SpaceOptions options;
  options.box = cloud.box();
  options.box.min().array() -= 12.0;
  options.box.max().array() += 12.0;
  const ReachableSpace space(cloud, options);
  Vertex from, to, inside;
  from.position = {-8.0, 7.0, 0.0};
  to.position = {8.0, 7.0, 0.0};
  EXPECT_EQ(route_penalty(space, std::vector<Vertex>{from, to}, {}), 0.0);
  inside.position = {0.0, 3.0, 0.0};
  EXPECT_GT(route_penalty(space, std::vector<Vertex>{from, inside, to}, {}), 1.0) << "clearance";
  EXPECT_GT(route_penalty(space, std::vector<Vertex>{from, to, from}, {}), 1.0) << "reversal";
}

}  // namespace
}  // namespace skycap::survey::inspection
