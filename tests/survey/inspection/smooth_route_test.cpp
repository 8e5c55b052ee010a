#include "survey/inspection/smooth_route.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "geometry/random_numbers.h"
#include "survey/inspection/flight_evaluation.h"

namespace skycap::survey::inspection {
namespace {

using Eigen::Vector3d;
using geometry::radians_per_degree;

Vertex at(double x, double y, double yaw_deg = 0.0) {
  Vertex vertex;
  vertex.position = {x, y, 0.0};
  vertex.yaw = yaw_deg * radians_per_degree;
  return vertex;
}

/// Largest norms of the derivatives of a flight, and its smallest distance from a position.
struct Peaks {
  double duration = 0.0, length = 0.0, speed = 0.0, acceleration = 0.0, jerk = 0.0;
  double yaw_rate = 0.0, yaw_acceleration = 0.0, nearest = 1e9;
};

Peaks peaks_of(const std::vector<Vertex>& vertices, const Smoothing& smoothing,
               const Vector3d& position = Vector3d::Zero()) {
  const std::vector<double> durations = leg_durations(vertices, smoothing);
  Peaks peaks;
  peaks.duration = flight_duration(durations, smoothing);
  IntervalCurve curve;
  constexpr double step = 0.001;
  for (std::size_t i = 0; i <= vertices.size(); ++i) {
    curve.set(vertices, durations, smoothing, i);
    for (double time = curve.begin(); time < curve.end(); time += step) {
      const Coordinates velocity = curve.velocity(time), acceleration = curve.acceleration(time);
      peaks.length += step * velocity.head<3>().norm();
      peaks.speed = std::max(peaks.speed, velocity.head<3>().norm());
      peaks.acceleration = std::max(peaks.acceleration, acceleration.head<3>().norm());
      peaks.jerk = std::max(peaks.jerk, curve.jerk(time).head<3>().norm());
      peaks.yaw_rate = std::max(peaks.yaw_rate, std::abs(velocity[3]));
      peaks.yaw_acceleration = std::max(peaks.yaw_acceleration, std::abs(acceleration[3]));
      peaks.nearest = std::min(peaks.nearest, (curve.position(time).head<3>() - position).norm());
    }
  }
  return peaks;
}

TEST(MakeSmoothing, GivesTheWindowsOfTheSpecification) {
  const Smoothing smoothing = make_smoothing({});
  EXPECT_NEAR(smoothing.shorter, 2.0, 1e-12);
  EXPECT_NEAR(smoothing.longer, 3.0, 1e-12);
  EXPECT_NEAR(smoothing.yaw_rate, 45.0 * radians_per_degree, 1e-12);
}

TEST(MakeSmoothing, UsesEqualWindowsWhenTheJerkIsTheStrictestLimit) {
  const Smoothing smoothing = make_smoothing({.speed = 1.0, .acceleration = 2.0, .jerk = 0.5});
  EXPECT_EQ(smoothing.shorter, smoothing.longer);
  // 97 degrees: the velocity changes by 1.5 m/s, over T1 T2.
  EXPECT_NEAR(1.5 / (smoothing.shorter * smoothing.longer), 0.5, 1e-12);
}

TEST(MakeSmoothing, NamesALimitThatIsNotPositive) {
  try {
    make_smoothing({.jerk = 0.0});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "jerk must be positive");
  }
}

// Analytic: 20 m at 2 m/s, plus T1 + T2. From rest, the velocity changes by 2 m/s.
TEST(SmoothRoute, FliesAStraightLine) {
  const Peaks peaks = peaks_of({at(0, 0), at(20, 0)}, {});
  EXPECT_NEAR(peaks.duration, 15.0, 1e-12);
  EXPECT_NEAR(peaks.length, 20.0, 0.01);
  EXPECT_NEAR(peaks.speed, 2.0, 1e-9);
  EXPECT_NEAR(peaks.acceleration, 2.0 / 3.0, 1e-9);
  EXPECT_NEAR(peaks.jerk, 1.0 / 3.0, 1e-9);
}

// Analytic: v E sin(45 degrees) with E = T2 / 4 + T1^2 / (12 T2).
TEST(SmoothRoute, RoundsACorner) {
  const Peaks peaks = peaks_of({at(0, 0), at(20, 0), at(20, 20)}, {}, {20, 0, 0});
  EXPECT_NEAR(peaks.duration, 25.0, 1e-12);
  EXPECT_NEAR(peaks.acceleration, 4.0 * std::sin(std::numbers::pi / 4.0) / 3.0, 1e-9);
  EXPECT_NEAR(peaks.jerk, 4.0 * std::sin(std::numbers::pi / 4.0) / 6.0, 1e-9);
  const double extent = 3.0 / 4.0 + 4.0 / 36.0;
  EXPECT_NEAR(peaks.nearest, 2.0 * extent * std::sin(std::numbers::pi / 4.0), 1e-3);
}

TEST(SmoothRoute, KeepsTheYawLimitsWhenTurningBack) {
  const Peaks peaks = peaks_of({at(0, 0, 0), at(0, 0, 180), at(0, 0, 0)}, {});
  EXPECT_LE(peaks.yaw_rate, 45.0 * radians_per_degree + 1e-9);
  EXPECT_LE(peaks.yaw_acceleration, 30.0 * radians_per_degree + 1e-9);
}

TEST(SmoothRoute, ReportsTheAccelerationOfAReversal) {
  const std::vector<Vertex> vertices{at(0, 0), at(20, 0), at(0, 0)};
  EXPECT_NEAR(peaks_of(vertices, {}).acceleration, 4.0 / 3.0, 1e-9);
  StructureCloud cloud;
  cloud.points = {{0.0F, 50.0F, 0.0F}};
  cloud.normals = {{0.0F, 1.0F, 0.0F}};
  cloud.radii = {0.1F};
  const FlightEvaluation evaluation = evaluate_flight(sample_flight(vertices, {}, 0.1), cloud, {});
  EXPECT_NEAR(evaluation.acceleration.max, 4.0 / 3.0, 0.05);
  EXPECT_GT(evaluation.acceleration.share_above, 0.0);
  EXPECT_FALSE(evaluation.keeps_limits());
}

TEST(SmoothRoute, KeepsLimitsOfVerticalSpeed) {
  Smoothing smoothing;
  smoothing.descent = 0.5;
  Vertex high = at(0, 0), low = at(0, 0);
  high.position.z() = 10.0;
  EXPECT_NEAR(leg_duration(high, low, smoothing), 20.0, 1e-12);
  EXPECT_NEAR(leg_duration(low, high, smoothing), 5.0, 1e-12);
}

std::vector<Vertex> random_route(std::size_t count, std::uint64_t seed) {
  geometry::RandomNumbers random(seed);
  std::vector<Vertex> vertices(count);
  for (Vertex& vertex : vertices) {
    for (int axis = 0; axis < 3; ++axis) vertex.position[axis] = random.between(-10.0, 10.0);
    vertex.yaw = random.between(-3.1, 3.1);
    vertex.pitch = random.between(-1.0, 1.0);
    vertex.delay = random.uniform() < 0.3 ? 0.7 : 0.0;
  }
  return vertices;
}

// Twin: a double moving average of the sampled polygon with steps of 1 ms.
TEST(SmoothRoute, EqualsANumericalDoubleMovingAverage) {
  const std::vector<Vertex> vertices = random_route(6, 5);
  const Smoothing smoothing;
  const std::vector<double> durations = leg_durations(vertices, smoothing);
  const double end = flight_duration(durations, smoothing);
  constexpr double step = 0.001;
  const auto polygon = [&](double time) {  // in flight time
    double begin = smoothing.reach();
    if (time <= begin) return vertices.front().position;
    for (std::size_t i = 0; i < durations.size(); ++i) {
      if (time < begin + durations[i]) {
        const double share = (time - begin) / durations[i];
        return Vector3d(vertices[i].position +
                        share * (vertices[i + 1].position - vertices[i].position));
      }
      begin += durations[i];
    }
    return vertices.back().position;
  };
  const auto average = [&](const std::vector<Vector3d>& series, double window) {
    const auto half = static_cast<std::ptrdiff_t>(std::lround(0.5 * window / step));
    const auto size = static_cast<std::ptrdiff_t>(series.size());
    std::vector<Vector3d> sums(series.size() + 1, Vector3d::Zero());
    for (std::size_t i = 0; i < series.size(); ++i) sums[i + 1] = sums[i] + series[i];
    std::vector<Vector3d> result(series.size());
    for (std::ptrdiff_t i = 0; i < size; ++i) {
      const std::ptrdiff_t from = std::max<std::ptrdiff_t>(0, i - half);
      const std::ptrdiff_t to = std::min(size - 1, i + half);
      result[static_cast<std::size_t>(i)] =
          (sums[static_cast<std::size_t>(to + 1)] - sums[static_cast<std::size_t>(from)]) /
          static_cast<double>(to - from + 1);
    }
    return result;
  };
  constexpr double margin = 5.0;
  std::vector<Vector3d> series;
  for (double time = -margin; time < end + margin; time += step) series.push_back(polygon(time));
  const auto smooth = average(average(series, smoothing.shorter), smoothing.longer);
  for (const FlightSample& sample : sample_flight(vertices, smoothing, 0.1)) {
    const auto index = static_cast<std::size_t>(std::lround((sample.time + margin) / step));
    EXPECT_LT((smooth[index] - sample.position).norm(), 1e-3) << "at " << sample.time << " s";
  }
}

// Property: derivatives in closed form are those of the closed form of the position.
TEST(SmoothRoute, DerivesItsVelocityAccelerationAndJerk) {
  const std::vector<Vertex> vertices = random_route(5, 9);
  const Smoothing smoothing;
  const std::vector<double> durations = leg_durations(vertices, smoothing);
  IntervalCurve curve;
  constexpr double h = 1e-4;
  for (std::size_t i = 0; i <= vertices.size(); ++i) {
    curve.set(vertices, durations, smoothing, i);
    for (std::size_t j = 1; j < curve.jumps().size(); ++j) {
      const double from = curve.jumps()[j - 1], to = curve.jumps()[j];
      if (to - from < 10.0 * h) continue;
      const double time = 0.5 * (from + to);
      const Coordinates velocity = (curve.position(time + h) - curve.position(time - h)) / (2 * h);
      EXPECT_LT((velocity - curve.velocity(time)).norm(), 1e-5);
      const Coordinates acceleration =
          (curve.velocity(time + h) - curve.velocity(time - h)) / (2 * h);
      EXPECT_LT((acceleration - curve.acceleration(time)).norm(), 1e-5);
      const Coordinates jerk =
          (curve.acceleration(time + h) - curve.acceleration(time - h)) / (2 * h);
      EXPECT_LT((jerk - curve.jerk(time)).norm(), 1e-5);
    }
  }
}

// Property: an interval depends on the vertices within its reach only, bit by bit, so that the
// search may keep what it has evaluated.
TEST(SmoothRoute, KeepsIntervalsThatAChangeDoesNotReach) {
  std::vector<Vertex> vertices = random_route(14, 3);
  const Smoothing smoothing;
  std::vector<double> durations = leg_durations(vertices, smoothing);
  IntervalCurve before, after;
  before.set(vertices, durations, smoothing, 12);
  vertices[1].position.x() += 3.0;
  durations = leg_durations(vertices, smoothing);
  after.set(vertices, durations, smoothing, 12);
  for (double time = before.begin(); time < before.end(); time += 0.1) {
    EXPECT_EQ(before.position(time), after.position(time));
    EXPECT_EQ(before.acceleration(time), after.acceleration(time));
  }
}

TEST(SampleFlight, BeginsAndEndsAtRest) {
  const std::vector<Vertex> vertices = random_route(5, 2);
  const auto flight = sample_flight(vertices, {}, 0.1);
  EXPECT_EQ(flight.front().time, 0.0);
  EXPECT_LT((flight.front().position - vertices.front().position).norm(), 1e-9);
  EXPECT_LT((flight.back().position - vertices.back().position).norm(), 1e-9);
  EXPECT_LT((flight[1].position - flight[0].position).norm(), 1e-3);
  for (std::size_t i = 1; i < flight.size(); ++i) {
    EXPECT_LT(std::abs(flight[i].yaw - flight[i - 1].yaw), 0.1) << "yaw is continuous";
  }
}

}  // namespace
}  // namespace skycap::survey::inspection
