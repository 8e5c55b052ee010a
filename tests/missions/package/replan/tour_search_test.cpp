// Tour search in small worlds with known results. The targets are on a plane, each view observes
// all targets within a radius of the point below it, and the vehicle flies at 1 m/s.

#include "missions/package/replan/tour_search.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace skycap::missions::package {
namespace {

using Eigen::Vector3d;
using geometry::View;
using survey::surfel::GainField;
using survey::surfel::Observation;
using testing::SizeIs;

constexpr double rest = 2.0;  ///< stop time for each view [s]
constexpr float certain = 7.0F;

View down_at(double x, double y, double z = 1.0) { return {{x, y, z}, -Vector3d::UnitZ()}; }

/// Views observe all targets within `radius` of the point below them.
struct PlaneWorld {
  explicit PlaneWorld(double radius) {
    problem.observations = [this, radius](const View& view) {
      ++asked;
      std::vector<Observation> observations;
      for (std::uint32_t t = 0; t < targets.size(); ++t) {
        const Vector3d offset = targets[t].position.cast<double>() - view.position;
        if (offset.head<2>().norm() <= radius) observations.push_back({t, certain});
      }
      return observations;
    };
    problem.find_view = [](const Vector3d& target, const Vector3d& towards, double distance) {
      return View{target + distance * towards, -towards};
    };
    problem.is_allowed = [](const View&) { return true; };
    problem.is_in_free_space = problem.has_return_path = [](const View&) { return true; };
    problem.straight_time = [](const View* from, const View* to) {
      return (random_coordinate(to) - random_coordinate(from)).norm();
    };
    problem.is_free = problem.has_returns = [](const View*, const View*) { return true; };
    problem.time_per_view = rest;
    problem.view_distance = 3.0;
  }
  PlaneWorld(const PlaneWorld&) = delete;
  PlaneWorld& operator=(const PlaneWorld&) = delete;

  /// Adds a target and eight more on a circle around it.
  void add_cluster(double x, double y, double radius) {
    add_target(x, y);
    for (int i = 0; i < 8; ++i) {
      const double angle = i * std::numbers::pi / 4.0;
      add_target(x + radius * std::cos(angle), y + radius * std::sin(angle));
    }
  }

  void add_target(double x, double y) {
    targets.push_back({Vector3d(x, y, 0.0).cast<float>(), Eigen::Vector3f::UnitZ(), 1.0F});
    problem.targets = targets;
  }

  static Vector3d random_coordinate(const View* view) {
    return view == nullptr ? Vector3d::Zero() : view->position;
  }

  /// Returns the time of a tour with straight paths.
  static double time(const std::vector<View>& tour) {
    double sum = rest * static_cast<double>(tour.size());
    Vector3d at = Vector3d::Zero();
    for (const View& view : tour) {
      sum += (view.position - at).norm();
      at = view.position;
    }
    return sum + at.norm();
  }

  std::vector<GainField::Target> targets;
  TourProblem problem;
  int asked = 0;
};

TEST(RemoveViews, RemovesDuplicates) {
  PlaneWorld world(1.0);
  world.add_cluster(10, 0, 0.5);
  world.add_cluster(20, 0, 0.5);
  const View a = down_at(10, 0), b = down_at(20, 0);
  const FoundTour found = remove_views(world.problem, {a, a, b, a, b}, 0.999);
  ASSERT_THAT(found.views, SizeIs(2));
  EXPECT_EQ(found.views[0].position, a.position);
  EXPECT_EQ(found.views[1].position, b.position);
  EXPECT_DOUBLE_EQ(found.time, PlaneWorld::time({a, b}));
}

TEST(RemoveViews, KeepsNeededViews) {
  PlaneWorld world(1.0);
  world.add_cluster(10, 0, 0.5);
  world.add_cluster(20, 0, 0.5);
  const std::vector<View> tour = {down_at(20, 0), down_at(10, 0)};
  const FoundTour found = remove_views(world.problem, tour, covered_by(world.problem, tour));
  EXPECT_THAT(found.views, SizeIs(2));
  EXPECT_EQ(found.covered, covered_by(world.problem, tour));
}

// Clusters of radius 0.5 on a line from home, each observed completely from within 0.5 of its
// centre. The optimum is three views and the path to the nearest position that observes the last
// cluster, and back, at ground level.
TEST(Anneal, FindsNearOptimalToursInKnownWorld) {
  PlaneWorld world(1.0);
  for (const double x : {10.0, 20.0, 30.0}) world.add_cluster(x, 0, 0.5);
  std::vector<View> start;
  for (const double x : {10.0, 20.0, 30.0}) {
    start.push_back(down_at(x - 0.3, 0.9));
    start.push_back(down_at(x + 0.6, -0.3));
    start.push_back(down_at(x - 0.4, -0.5));
  }
  const double target_coverage = 0.999;
  ASSERT_GE(covered_by(world.problem, start), target_coverage);
  constexpr double min = 2.0 * 29.5 + 3.0 * rest;
  for (const std::uint64_t seed : {1, 2, 3}) {
    const FoundTour found = anneal(world.problem, start, target_coverage, {.seed = seed});
    EXPECT_THAT(found.views, SizeIs(3)) << seed;
    EXPECT_GE(found.covered, target_coverage);
    EXPECT_NEAR(found.time, PlaneWorld::time(found.views), 1e-9);
    EXPECT_GE(found.time, min - 1e-9);
    EXPECT_LE(found.time, min + 1.5) << seed;
  }
}

/// Observations are made only en route, within 1 m of each leg.
void measure_en_route(PlaneWorld& world) {
  world.problem.observations = [](const View&) { return std::vector<Observation>(); };
  world.problem.leg_observations = [&world](const View* from, const View* to) {
    const Vector3d a = PlaneWorld::random_coordinate(from),
                   displacement = PlaneWorld::random_coordinate(to) - a;
    std::vector<Observation> observations;
    for (std::uint32_t t = 0; t < world.targets.size(); ++t) {
      const Vector3d offset = world.targets[t].position.cast<double>() - a;
      const double share = std::clamp(
          offset.dot(displacement) / std::max(displacement.squaredNorm(), 1e-12), 0.0, 1.0);
      if ((offset - share * displacement).norm() <= 1.0) observations.push_back({t, certain});
    }
    return observations;
  };
}

// Targets on a line from home. With observations en route, the optimum is to fly until the last
// target is visible, and back.
TEST(Anneal, CountsEnRouteMeasurements) {
  PlaneWorld world(1.0);
  for (int i = 1; i <= 20; ++i) world.add_target(i, 0.0);
  measure_en_route(world);
  const std::vector<View> whole = {down_at(7, 3, 0), down_at(22, 0, 0)};
  ASSERT_GE(covered_by(world.problem, whole), 0.999);
  for (const std::uint64_t seed : {1, 2, 3}) {
    const FoundTour found = anneal(world.problem, whole, 0.999, {.seed = seed});
    EXPECT_THAT(found.views, SizeIs(1)) << seed;
    EXPECT_EQ(found.covered, covered_by(world.problem, found.views)) << seed;
    EXPECT_GE(found.time, 2.0 * 19.0 + rest - 1e-9);
    EXPECT_LE(found.time, 2.0 * 19.0 + rest + 1.5) << seed;
  }
}

// A stop that is not needed for its leg is removed. A stop that bends the path to a target is kept.
TEST(RemoveViews, CountsEnRouteCoverageOfRemainingLegs) {
  PlaneWorld world(1.0);
  world.add_target(5, 0);
  world.add_target(10, 0);
  world.add_target(10, 10);
  measure_en_route(world);
  const FoundTour found =
      remove_views(world.problem, {down_at(5, 0, 0), down_at(10, 0, 0), down_at(10, 10, 0)}, 0.999);
  ASSERT_THAT(found.views, SizeIs(2));
  EXPECT_EQ(found.views[0].position, Vector3d(10, 0, 0));
  EXPECT_EQ(found.covered, covered_by(world.problem, found.views));
}

// Three clusters are visible from a straight line and from positions next to it. If bends cost
// time, the line is faster although it needs more views.
TEST(Anneal, AccountsForTimeInBends) {
  PlaneWorld world(1.0);
  for (const double x : {10.0, 20.0, 30.0}) world.add_cluster(x, 0, 0.5);
  world.problem.time_per_view = 0.1;
  world.problem.bend_time = [](const View* before, const View& at, const View* after) {
    const Vector3d in = at.position - PlaneWorld::random_coordinate(before);
    const Vector3d out = PlaneWorld::random_coordinate(after) - at.position;
    if (in.norm() == 0.0 || out.norm() == 0.0) return 0.0;
    return 4.0 * (1.0 - in.normalized().dot(out.normalized()));
  };
  const std::vector<View> zigzag = {down_at(10, 0.45), down_at(20, -0.45), down_at(30, 0.45)};
  ASSERT_GE(covered_by(world.problem, zigzag), 0.999);
  const auto bends = [&](const std::vector<View>& views) {
    double sum = 0.0;
    for (std::size_t i = 0; i < views.size(); ++i) {
      sum += world.problem.bend_time(i == 0 ? nullptr : &views[i - 1], views[i],
                                     i + 1 == views.size() ? nullptr : &views[i + 1]);
    }
    return sum;
  };
  for (const std::uint64_t seed : {1, 2, 3}) {
    const FoundTour found = anneal(world.problem, zigzag, 0.999, {.seed = seed});
    EXPECT_GE(found.covered, 0.999);
    const double rests = rest * static_cast<double>(found.views.size());
    const double own_rests = 0.1 * static_cast<double>(found.views.size());
    const double travel_time = PlaneWorld::time(found.views) - rests;
    EXPECT_NEAR(found.time, travel_time + own_rests + bends(found.views), 1e-9) << seed;
    // Out and back on a line: one turn.
    EXPECT_LE(found.time, 2.0 * 29.5 + 8.0 + 1.5) << seed;
  }
}

// Two views each observe half of the cluster. One view between them observes all of it.
TEST(Anneal, ReplacesTwoViewsByOne) {
  PlaneWorld world(2.0);
  world.add_cluster(15, 0, 1.5);
  const std::vector<View> start = {down_at(14, 0.3), down_at(16, -0.3)};
  ASSERT_LT(covered_by(world.problem, {start[0]}), 0.95);
  const double target_coverage = covered_by(world.problem, start) - 1e-3;
  EXPECT_THAT(anneal(world.problem, start, target_coverage, {}).views, SizeIs(1));
}

// Property: from any initial tour, the result has at least the same coverage and takes at most the
// same time.
TEST(Anneal, NeverReturnsSlowerOrLessCoveringTour) {
  std::mt19937_64 random(7);
  const auto random_coordinate = [&] {
    return static_cast<double>(random() % 4000) / 100.0 - 20.0;
  };
  for (int world_number = 0; world_number < 8; ++world_number) {
    PlaneWorld world(4.0);
    for (int i = 0; i < 40; ++i) world.add_target(random_coordinate(), random_coordinate());
    std::vector<View> start;
    for (int i = 0; i < 12; ++i) start.push_back(down_at(random_coordinate(), random_coordinate()));
    const double target_coverage = covered_by(world.problem, start);
    const FoundTour found =
        anneal(world.problem, start, target_coverage, {.moves_per_view = 200, .seed = 3});
    EXPECT_GE(found.covered, target_coverage);
    EXPECT_EQ(found.covered, covered_by(world.problem, found.views));
    EXPECT_LE(found.time, PlaneWorld::time(start) + 1e-9);
  }
}

TEST(Anneal, IsDeterministic) {
  PlaneWorld world(3.0);
  for (const double x : {8.0, 16.0, 24.0}) world.add_cluster(x, x / 2.0, 1.0);
  const std::vector<View> start = {down_at(8, 4), down_at(16, 8), down_at(24, 12), down_at(9, 5)};
  const double target_coverage = covered_by(world.problem, start);
  const SearchSettings settings{.moves_per_view = 300, .seed = 11};
  const FoundTour one = anneal(world.problem, start, target_coverage, settings);
  const FoundTour two = anneal(world.problem, start, target_coverage, settings);
  ASSERT_EQ(one.views.size(), two.views.size());
  for (std::size_t i = 0; i < one.views.size(); ++i) {
    EXPECT_EQ(one.views[i].position, two.views[i].position);
    EXPECT_EQ(one.views[i].direction, two.views[i].direction);
  }
  EXPECT_EQ(one.time, two.time);
}

// Views below 5 m are not allowed, and space east of 12 m is not free.
TEST(Anneal, RespectsLimitsAndFreeSpace) {
  PlaneWorld world(4.0);
  for (const double x : {4.0, 9.0, 14.0}) world.add_cluster(x, 0, 1.0);
  world.problem.is_allowed = [](const View& view) { return view.position.z() >= 5.0; };
  world.problem.is_in_free_space = [](const View& view) { return view.position.x() <= 12.0; };
  const std::vector<View> start = {down_at(4, 0, 6), down_at(9, 0, 6), down_at(11.5, 0, 6),
                                   down_at(11, 1, 7)};
  const FoundTour found = anneal(world.problem, start, covered_by(world.problem, start) - 1e-3, {});
  EXPECT_LT(found.views.size(), start.size());
  for (const View& view : found.views) {
    EXPECT_GE(view.position.z(), 5.0);
    EXPECT_LE(view.position.x(), 12.0);
  }
}

// Views north and south of a wall with a costly path around its western end. Each side should be
// visited once, so the wall is passed at most twice.
TEST(Anneal, CrossesWallOnlyOnceEachDirection) {
  PlaneWorld world(1.0);
  std::vector<View> start;
  for (const double x : {6.0, 12.0, 18.0}) {
    for (const double y : {1.5, -1.5}) {
      world.add_cluster(x, y, 0.3);
      start.push_back(down_at(x, y));
    }
  }
  const auto is_fly_through = [](const View* from, const View* to) {
    const double a = PlaneWorld::random_coordinate(from).y(),
                 b = PlaneWorld::random_coordinate(to).y();
    return a * b < 0.0;
  };
  world.problem.is_free = [&](const View* from, const View* to) {
    return !is_fly_through(from, to);
  };
  const FoundTour found = anneal(world.problem, start, 0.999, {});
  int passed = 0;
  for (std::size_t i = 1; i < found.views.size(); ++i) {
    passed += is_fly_through(&found.views[i - 1], &found.views[i]) ? 1 : 0;
  }
  EXPECT_EQ(passed, 1);
  EXPECT_GT(found.time, PlaneWorld::time(found.views)) << "a blocked way is not free of charge";
}

// There are no return paths east of 20 m. Targets there are also visible from the west.
TEST(Anneal, AvoidsPositionsWithoutReturnPath) {
  PlaneWorld world(3.0);
  world.add_cluster(10, 0, 0.5);
  world.add_cluster(20, 0, 0.5);
  world.problem.has_returns = [](const View* from, const View* to) {
    return PlaneWorld::random_coordinate(from).x() <= 20.0 &&
           PlaneWorld::random_coordinate(to).x() <= 20.0;
  };
  const std::vector<View> start = {down_at(10, 0), down_at(20.5, 0)};
  const FoundTour found = anneal(world.problem, start, 0.999, {});
  EXPECT_THAT(found.views, SizeIs(2));
  for (const View& view : found.views) EXPECT_LE(view.position.x(), 20.0);
  EXPECT_NEAR(found.time, PlaneWorld::time(found.views), 1e-9) << "nothing is charged";
}

// Surface that the survey observed from a position without a return path is observed from another
// position.
TEST(Anneal, ReplacesViewsWithoutReturnPath) {
  PlaneWorld world(3.0);
  world.add_cluster(10, 0, 0.5);
  world.add_cluster(20, 0, 0.5);
  const auto has_none = [](const View& view) {
    return view.position.x() > 15.0 && view.position.x() < 20.5;
  };
  world.problem.has_return_path = std::not_fn(has_none);
  const FoundTour found = anneal(world.problem, {down_at(10, 0)}, 0.999, {});
  EXPECT_THAT(found.views, SizeIs(2));
  EXPECT_GT(found.covered, 0.999);
  EXPECT_TRUE(std::ranges::none_of(found.views, has_none));
}

TEST(Anneal, EndsWhenAStopIsRequested) {
  PlaneWorld world(1.0);
  world.add_cluster(10, 0, 0.5);
  const std::vector<View> start = {down_at(10, 0)};
  std::stop_source source;
  source.request_stop();
  const FoundTour found = anneal(world.problem, start, 0.9, {}, source.get_token());
  EXPECT_EQ(found.views[0].position, start[0].position);
  EXPECT_EQ(world.asked, 1);
}

}  // namespace
}  // namespace skycap::missions::package
