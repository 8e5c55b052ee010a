#include "survey/inspection/flight_evaluation.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/random_numbers.h"
#include "survey/inspection/reachable_space.h"

namespace skycap::survey::inspection {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using geometry::radians_per_degree;

/// A vehicle that rests at a pose for some samples.
std::vector<FlightSample> resting_at(const Vector3d& position, double yaw_deg, double pitch_deg) {
  std::vector<FlightSample> flight;
  for (int i = 0; i < 5; ++i) {
    flight.push_back(
        {0.1 * i, position, yaw_deg * radians_per_degree, pitch_deg * radians_per_degree});
  }
  return flight;
}

StructureCloud single_point(const Vector3f& point) {
  StructureCloud cloud;
  cloud.points = {point};
  cloud.normals = {Vector3f::UnitX()};
  cloud.radii = {0.01F};
  return cloud;
}

/// Plane x = `x`, from -half to half in y and z.
std::vector<Vector3f> plane(float x, float half, float spacing) {
  std::vector<Vector3f> points;
  for (float y = -half; y <= half; y += spacing) {
    for (float z = -half; z <= half; z += spacing) points.push_back({x, y, z});
  }
  return points;
}

PerRule<double> shares(const std::vector<FlightSample>& flight, const StructureCloud& cloud,
                       const EvaluationOptions& options = {}) {
  const FlightEvaluation evaluation = evaluate_flight(flight, cloud, options);
  return {evaluation.share(0), evaluation.share(1), evaluation.share(2)};
}

TEST(EvaluateFlight, SeesAPointInsideTheImageOnly) {
  const StructureCloud cloud = single_point({5.0F, 0.0F, 0.0F});
  EXPECT_EQ(shares(resting_at(Vector3d::Zero(), 37.4, 0.0), cloud)[0], 1.0);
  EXPECT_EQ(shares(resting_at(Vector3d::Zero(), 37.6, 0.0), cloud)[0], 0.0);
  EXPECT_EQ(shares(resting_at(Vector3d::Zero(), 0.0, 27.4), cloud)[0], 1.0);
  EXPECT_EQ(shares(resting_at(Vector3d::Zero(), 0.0, 27.6), cloud)[0], 0.0);
  EXPECT_EQ(shares(resting_at(Vector3d::Zero(), 180.0, 0.0), cloud)[0], 0.0) << "behind";
}

TEST(EvaluateFlight, SeesAPointWithinTheRangeOnly) {
  EXPECT_EQ(shares(resting_at(Vector3d::Zero(), 0, 0), single_point({7.99F, 0, 0}))[0], 1.0);
  EXPECT_EQ(shares(resting_at(Vector3d::Zero(), 0, 0), single_point({8.01F, 0, 0}))[0], 0.0);
}

TEST(EvaluateFlight, SeesThroughAWallByPixelsButNotBySolidSurface) {
  std::vector<Vector3f> points = plane(5.0F, 2.0F, 0.2F);
  const std::size_t front = points.size();
  for (const Vector3f& point : plane(8.0F, 2.0F, 0.2F)) points.push_back(point);
  EvaluationOptions options;
  options.camera.range = 12.0;
  const FlightEvaluation evaluation =
      evaluate_flight(resting_at(Vector3d::Zero(), 0, 0), make_structure_cloud(points), options);
  EXPECT_GT(evaluation.share(0), 0.95);
  EXPECT_EQ(evaluation.seen[1], front);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ((evaluation.rules_seen[i] >> 1 & 1U) != 0, i < front) << "point " << i;
  }
}

TEST(EvaluateFlight, LimitsTheIncidence) {
  // A small plane at 5 m whose normal makes an angle with the line of sight.
  const auto tilted = [](double angle_deg) {
    const double angle = angle_deg * radians_per_degree;
    std::vector<Vector3f> points;
    for (double a = -0.06; a <= 0.06; a += 0.012) {
      for (double b = -0.06; b <= 0.06; b += 0.012) {
        points.push_back(Vector3d(5.0 + a * std::sin(angle), a * std::cos(angle), b).cast<float>());
      }
    }
    return make_structure_cloud(points);
  };
  EvaluationOptions options;
  options.cube_resolution = 1280;  // pixels must not be wider than the discs
  const auto eye = resting_at(Vector3d::Zero(), 0, 0);
  EXPECT_EQ(shares(eye, tilted(74.0), options)[2], shares(eye, tilted(74.0), options)[1]);
  EXPECT_GT(shares(eye, tilted(74.0), options)[1], 0.95);
  EXPECT_EQ(shares(eye, tilted(76.0), options)[2], 0.0);
}

TEST(EvaluateFlight, CountsViewsEveryHalfSecond) {
  std::vector<FlightSample> flight;
  for (int i = 0; i <= 50; ++i) flight.push_back({0.1 * i, Vector3d::Zero(), 0.0, 0.0});
  const FlightEvaluation evaluation =
      evaluate_flight(flight, make_structure_cloud(plane(5.0F, 0.5F, 0.1F)), {});
  EXPECT_EQ(evaluation.views.median, 11.0);  // 0.0, 0.5, ..., 5.0 s
}

TEST(EvaluateFlight, MeasuresDistancesBetweenSamples) {
  // Samples at x = -1 and 1, the point beside the middle of the segment.
  std::vector<FlightSample> flight;
  for (int i = 0; i < 5; ++i) flight.push_back({1.0 * i, {-3.0 + 2.0 * i, 0, 0}, 0.0, 0.0});
  const StructureCloud cloud = single_point({0.0F, 0.3F, 0.0F});
  const FlightEvaluation evaluation = evaluate_flight(flight, cloud, {});
  EXPECT_NEAR(evaluation.nearest, 0.3, 1e-6);
  EXPECT_NEAR(evaluation.nearest_time, 1.0, 1e-9);
}

TEST(EvaluateFlight, ReportsEveryExceededLimit) {
  std::vector<FlightSample> flight;
  for (int i = 0; i < 40; ++i) flight.push_back({0.1 * i, {0.3 * i, 0, 0}, 0.2 * i, -0.1 * i});
  const FlightEvaluation evaluation =
      evaluate_flight(flight, single_point({0.0F, 20.0F, 0.0F}), {});
  EXPECT_NEAR(evaluation.speed.max, 3.0, 1e-9);
  EXPECT_NEAR(evaluation.speed.share_above, 1.0, 1e-9);
  EXPECT_NEAR(evaluation.yaw_rate.max, 2.0, 1e-9);
  EXPECT_FALSE(evaluation.keeps_pitch);
  EXPECT_TRUE(evaluation.acceleration.is_kept());
  EXPECT_FALSE(evaluation.keeps_limits());
}

TEST(EvaluateFlight, DoesNotDependOnThreads) {
  const StructureCloud cloud = make_structure_cloud(plane(5.0F, 4.0F, 0.2F));
  std::vector<FlightSample> flight;
  for (int i = 0; i < 60; ++i) flight.push_back({0.1 * i, {0.0, 0.1 * i - 3.0, 0}, 0.0, 0.0});
  EvaluationOptions one, three;
  three.threads = 3;
  const FlightEvaluation a = evaluate_flight(flight, cloud, one);
  const FlightEvaluation b = evaluate_flight(flight, cloud, three);
  EXPECT_EQ(a.rules_seen, b.rules_seen);
  EXPECT_EQ(a.views.mean, b.views.mean);
  EXPECT_EQ(a.median_view_distance, b.median_view_distance);
}

TEST(EvaluateFlight, RejectsUnevenTimes) {
  std::vector<FlightSample> flight = resting_at(Vector3d::Zero(), 0, 0);
  flight[2].time += 0.02;
  EXPECT_THROW(evaluate_flight(flight, single_point({5, 0, 0}), {}), Error);
}

TEST(MakeStructureCloud, RemovesRepeatedPointsAndKeepsTheNormalOfAPlane) {
  std::vector<Vector3f> points = plane(5.0F, 1.0F, 0.1F);
  const std::size_t distinct = points.size();
  for (std::size_t i = 0; i < distinct; ++i) points.push_back(points[i]);
  const StructureCloud cloud = make_structure_cloud(points);
  EXPECT_EQ(cloud.size(), distinct);
  for (const Vector3f& normal : cloud.normals) EXPECT_NEAR(std::abs(normal.x()), 1.0F, 1e-4F);
  EXPECT_NEAR(cloud.median_radius, 0.1414F, 0.01F);
}

TEST(MakeStructureCloud, RejectsTooFewDistinctPoints) {
  const std::vector<Vector3f> points(100, Vector3f::Ones());
  try {
    make_structure_cloud(points);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "the structure has 1 distinct points, and at least 8 are required; use a complete "
              "point cloud");
  }
}

/// Points on the surface of a cube around the origin.
std::vector<Vector3f> cube_points(float half, float spacing) {
  std::vector<Vector3f> points;
  for (float a = -half; a <= half; a += spacing) {
    for (float b = -half; b <= half; b += spacing) {
      for (const float side : {-half, half}) {
        points.push_back({side, a, b});
        points.push_back({a, side, b});
        points.push_back({a, b, side});
      }
    }
  }
  return points;
}

// Twin: the nearest point by trying all.
TEST(ReachableSpace, InterpolatesTheDistanceOfTheNearestPoint) {
  const StructureCloud cloud = make_structure_cloud(cube_points(4.0F, 0.4F));
  SpaceOptions options;
  options.box = cloud.box();
  options.box.min().array() -= 8.0;
  options.box.max().array() += 8.0;
  const ReachableSpace space(cloud, options);
  geometry::RandomNumbers random(4);
  for (int i = 0; i < 10'000; ++i) {
    Vector3d position;
    for (int axis = 0; axis < 3; ++axis) position[axis] = random.between(-10.0, 10.0);
    double nearest = 1e9;
    for (const Vector3f& point : cloud.points) {
      nearest = std::min(nearest, (point.cast<double>() - position).norm());
    }
    if (nearest < 1.0 || nearest > 4.5) continue;
    EXPECT_LT(space.distance(position), nearest + 0.05) << "the margin of the required distance";
    // Inside, where distances from opposite sides meet, the field is lower.
    if (position.cwiseAbs().maxCoeff() > 4.0) {
      EXPECT_GT(space.distance(position), nearest - 0.1);
    }
  }
}

TEST(ReachableSpace, LeavesOutTheInsideOfAHollowStructure) {
  const StructureCloud cloud = make_structure_cloud(cube_points(8.0F, 0.4F));
  SpaceOptions options;
  options.box = cloud.box();
  options.box.min().array() -= 8.0;
  options.box.max().array() += 8.0;
  const ReachableSpace space(cloud, options);
  EXPECT_GT(space.distance(Vector3d::Zero()), 3.1) << "free, but enclosed";
  EXPECT_FALSE(space.is_reachable(Vector3d::Zero()));
  EXPECT_TRUE(space.is_reachable({12.0, 0.0, 0.0}));
  EXPECT_FALSE(space.is_reachable({10.0, 0.0, 0.0})) << "nearer than the clearance";
}

TEST(ReachableSpace, TakesAnyObstacleIntoAccount) {
  const StructureCloud cloud = make_structure_cloud(cube_points(2.0F, 0.4F));
  SpaceOptions options;
  options.box = cloud.box();
  options.box.min().array() -= 8.0;
  options.box.max().array() += 8.0;
  options.clearance = 1.0;
  const auto ground = [](const Vector3d& position, double up_to) {
    return std::clamp(position.z() + 3.0, 0.0, up_to);
  };
  options.distance = ground;
  const ReachableSpace space(cloud, options);
  EXPECT_FALSE(space.is_reachable({5.0, 5.0, -2.5}));
  EXPECT_TRUE(space.is_reachable({5.0, 5.0, -1.0}));
  EXPECT_NEAR(space.distance({1.3, 0.2, -1.1}), 1.9, 1e-4);
}

}  // namespace
}  // namespace skycap::survey::inspection
