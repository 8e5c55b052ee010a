#include "survey/patterns/patterns.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/random_numbers.h"
#include "survey/patterns/pattern_config.h"
#include "tests/support/complaint.h"

namespace skycap::survey::patterns {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using geometry::View;
using testing_support::thrown_message;

constexpr double d = 10.0;
constexpr double pi = std::numbers::pi;

/// Footprint of 6 m along the rows and 4 m across, at the view distance.
const Vector2d footprint(6.0, 4.0);

PatternOptions options() {
  return {.view_distance = d, .forward_overlap = 0.5, .side_overlap = 0.25, .min_height = 2.0};
}

std::vector<View> views_of(Pattern pattern, const PatternTarget& target,
                           const PatternOptions& chosen = options()) {
  return pattern_views(pattern, footprint, target, chosen).views;
}

PatternTarget box_target() {
  return target_of(Eigen::AlignedBox3d(Vector3d(-20, -5, 0), Vector3d(20, 5, 12)));
}

std::vector<View> level_views(const std::vector<View>& views) {
  std::vector<View> level;
  std::ranges::copy_if(views, std::back_inserter(level),
                       [](const View& view) { return std::abs(view.direction.z()) < 0.5; });
  return level;
}

std::set<long> millimetres(const std::vector<View>& views, int axis) {
  std::set<long> found;
  for (const View& view : views) found.insert(std::lround(1e3 * view.position[axis]));
  return found;
}

/// Returns the distance from a line by a search of each segment, along which it is convex.
double distance_to_segments(const Vector2d& point, const std::vector<Vector2d>& line) {
  double least = INFINITY;
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const auto at = [&](double share) {
      return (line[i] + share * (line[i + 1] - line[i]) - point).norm();
    };
    double low = 0.0, high = 1.0;
    for (int k = 0; k < 100; ++k) {
      const double a = low + (high - low) / 3.0, b = high - (high - low) / 3.0;
      (at(a) < at(b) ? high : low) = at(a) < at(b) ? b : a;
    }
    least = std::min({least, at(low), at(0.0), at(1.0)});
  }
  return least;
}

// Closed form: a grid with spacing s covers a length L with ceil(L / s) + 1 views.
TEST(Patterns, GridOfRectangleHasRowsAndViewsOfItsOverlaps) {
  const double along = 10.0 + 0.3 * d, across = 40.0 + 0.3 * d;
  const double forward = 0.5 * footprint.y(), side = 0.75 * footprint.x();
  const auto per_row = static_cast<std::size_t>(std::ceil(along / forward)) + 1;
  const auto rows = static_cast<std::size_t>(std::ceil(across / side)) + 1;
  const std::vector<View> nadir = views_of(Pattern::nadir, box_target());
  EXPECT_EQ(nadir.size(), rows * per_row);
  EXPECT_EQ(millimetres(nadir, 0).size(), rows);
  EXPECT_EQ(millimetres(nadir, 1).size(), per_row);
  for (std::size_t i = 1; i < per_row; ++i) {
    EXPECT_NEAR((nadir[i].position - nadir[i - 1].position).norm(), forward, 1e-9);
  }
}

TEST(Patterns, GridOfPolygonSkipsViewsThatDoNotSeeIt) {
  // An L of two arms of 10 m around an empty quarter.
  const std::vector<Vector2d> corners{{0, 0}, {60, 0}, {60, 10}, {10, 10}, {10, 60}, {0, 60}};
  const PatternTarget target = target_of_polygon(corners, 0.0, 5.0);
  EXPECT_NEAR(area_of(corners), 1100.0, 1e-9);
  const std::vector<View> grid = views_of(Pattern::nadir, target);
  const std::vector<View> box = views_of(Pattern::nadir, target_of(target.box));
  EXPECT_LT(grid.size(), box.size() * 2 / 3);
  const double reach = 0.5 * footprint.norm();
  for (const View& view : box) {
    const Vector2d at = view.position.head<2>();
    const bool is_inside = geometry::contains(corners, at);
    std::vector<Vector2d> closed = corners;
    closed.push_back(corners.front());
    const double distance = is_inside ? 0.0 : distance_to_segments(at, closed);
    if (std::abs(distance - reach) < 0.01) continue;
    const bool is_kept = std::ranges::any_of(
        grid, [&](const View& other) { return other.position == view.position; });
    EXPECT_EQ(is_kept, distance < reach) << at.transpose();
  }
}

TEST(Patterns, FacadeRowsHaveConstantDistanceFromConvexOutline) {
  geometry::RandomNumbers random(7);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<Vector2d> polygon;  // convex, because its corners are on a circle
    std::vector<double> angles;
    for (int i = 0; i < 7; ++i) angles.push_back(random.between(0.0, 2.0 * pi));
    std::ranges::sort(angles);
    for (const double angle : angles)
      polygon.push_back({15 * std::cos(angle), 15 * std::sin(angle)});
    const PatternTarget target = target_of_polygon(polygon, 0.0, 12.0);
    std::vector<Vector2d> closed = target.outline;
    closed.push_back(closed.front());
    const std::vector<View> rows = level_views(views_of(Pattern::facade, target));
    ASSERT_FALSE(rows.empty());
    std::set<long> heights;
    for (std::size_t i = 0; i < rows.size(); i += 7) {
      EXPECT_NEAR(distance_to_segments(rows[i].position.head<2>(), closed), d, 2e-3);
      EXPECT_FALSE(geometry::contains(target.outline, rows[i].position.head<2>()));
      heights.insert(std::lround(1e6 * rows[i].position.z()));
    }
    double perimeter = 2.0 * pi * d;
    for (std::size_t i = 0; i + 1 < closed.size(); ++i) {
      perimeter += (closed[i + 1] - closed[i]).norm();
    }
    const auto per_row = static_cast<std::size_t>(std::ceil(perimeter / (0.5 * footprint.x())));
    const auto levels =
        static_cast<std::size_t>(std::ceil((12.0 - 0.2 * d - 2.0) / (0.75 * footprint.y()))) + 1;
    EXPECT_EQ(rows.size(), per_row * levels);
  }
}

TEST(Patterns, PitchedFacadeKeepsDistanceAndHeightDifference) {
  PatternOptions tilted = options();
  tilted.pitch = -30.0 * geometry::radians_per_degree;
  const PatternTarget target = box_target();
  for (const View& view : views_of(Pattern::facade, target, tilted)) {
    if (view.direction.z() < -0.9) continue;  // nadir grid
    const Vector2d beyond = (view.position.head<2>().cwiseAbs() - Vector2d(20, 5)).cwiseMax(0.0);
    EXPECT_NEAR(beyond.norm(), d * std::cos(*tilted.pitch), 1e-9);
    EXPECT_NEAR(view.direction.z(), -0.5, 1e-12);
    EXPECT_NEAR(view.direction.norm(), 1.0, 1e-12);
    // What the view faces is on the target's walls.
    const double seen = view.position.z() - 0.5 * d;
    EXPECT_GE(seen, -1e-9);
    EXPECT_LE(seen, 12.0 + 1e-9);
  }
}

TEST(Patterns, RingsHaveRadiusHeightsAndSpacing) {
  const PatternTarget target = box_target();
  const double radius = std::hypot(20.0, 5.0) + d;
  const std::vector<View> rings = views_of(Pattern::rings, target);
  const auto count = static_cast<std::size_t>(std::ceil(2.0 * pi * radius / (0.5 * footprint.x())));
  const std::set<long> heights = millimetres(rings, 2);
  EXPECT_EQ(*heights.begin(), 2000);
  EXPECT_EQ(*heights.rbegin(), 10'000);  // 0.2 d below the top
  EXPECT_EQ(heights.size(), std::ceil(8.0 / (0.75 * footprint.y())) + 1);
  EXPECT_EQ(rings.size(), heights.size() * count);
  for (const View& view : rings) {
    EXPECT_NEAR(view.position.head<2>().norm(), radius, 1e-9);
    EXPECT_NEAR(view.direction.head<2>().dot(view.position.head<2>()), -radius, 1e-9);
  }
}

TEST(Patterns, CorridorIsAtOffsetOnBothSidesOfLine) {
  const std::vector<Vector2d> line{{0, 0}, {40, 0}, {60, 30}, {60, 80}};
  const PatternTarget target = target_of_line(line, 4.0, 0.0, 6.0);
  const std::vector<View> corridor = views_of(Pattern::corridor, target);
  const double offset = 2.0 + d * std::sqrt(0.5);
  std::size_t left = 0;
  for (const View& view : corridor) {
    EXPECT_NEAR(view.position.z(), 6.0 + d * std::sqrt(0.5), 1e-9);
    EXPECT_NEAR(distance_to_segments(view.position.head<2>(), line), offset, 2e-3);
    EXPECT_NEAR(view.direction.z(), -std::sqrt(0.5), 1e-12);
    left += view.position.y() > 0.0 && view.position.x() < 40.0 ? 1 : 0;
  }
  EXPECT_GT(left, 10U);
  EXPECT_GT(corridor.size(), 2 * left);
}

TEST(Patterns, StraightCorridorHasViewsOfItsOverlap) {
  const PatternTarget target = target_of_line({{0, 0}, {30, 0}}, 0.0, 0.0, 6.0);
  PatternOptions level = options();
  level.pitch = 0.0;
  const std::vector<View> corridor = views_of(Pattern::corridor, target, level);
  const std::size_t levels = static_cast<std::size_t>(std::ceil(2.0 / 3.0)) + 1;
  EXPECT_EQ(corridor.size(), 2 * levels * (30 / 3 + 1));
  EXPECT_EQ(millimetres(corridor, 1), (std::set<long>{-10'000, 10'000}));
  EXPECT_EQ(millimetres(corridor, 0).size(), 11U);
}

TEST(Patterns, CorridorStraightDownCoversWidth) {
  PatternOptions down = options();
  down.pitch = -0.5 * pi;
  const std::vector<View> single =
      views_of(Pattern::corridor, target_of_line({{0, 0}, {30, 0}}, 0.0, 0.0, 6.0), down);
  EXPECT_EQ(single.size(), 30 / 2 + 1);  // half of the shorter side, 4 m
  const std::vector<View> wide =
      views_of(Pattern::corridor, target_of_line({{0, 0}, {30, 0}}, 9.0, 0.0, 6.0), down);
  EXPECT_EQ(millimetres(wide, 1), (std::set<long>{-4500, -1500, 1500, 4500}));
  for (const View& view : wide) EXPECT_NEAR(view.position.z(), 6.0 + d, 1e-9);
}

TEST(Patterns, CorridorFollowsLongAxisOfOutline) {
  const double angle = 0.4;
  std::vector<Vector2d> corners;
  for (const Vector2d& corner :
       {Vector2d(-20, -5), Vector2d(20, -5), Vector2d(20, 5), Vector2d(-20, 5)}) {
    corners.push_back(Eigen::Rotation2Dd(angle) * corner);
  }
  for (const View& view : views_of(Pattern::corridor, target_of_polygon(corners, 0.0, 12.0))) {
    const Vector2d own = Eigen::Rotation2Dd(-angle) * view.position.head<2>();
    EXPECT_NEAR(std::abs(own.y()), 5.0 + d * std::sqrt(0.5), 1e-9);
    EXPECT_LE(std::abs(own.x()), 20.0 + 1e-9);
  }
}

TEST(Patterns, RotateGridRowsForScannerAcrossTheFlight) {
  PatternOptions swept = options();
  swept.is_swept = true;
  const std::vector<View> nadir = views_of(Pattern::nadir, box_target(), swept);
  const double along = 10.0 + 0.3 * d, across = 40.0 + 0.3 * d;
  const auto per_row = static_cast<std::size_t>(std::ceil(along / (0.5 * footprint.x()))) + 1;
  const auto rows = static_cast<std::size_t>(std::ceil(across / (0.75 * footprint.y()))) + 1;
  EXPECT_EQ(nadir.size(), rows * per_row);
  for (const View& view : nadir) EXPECT_LT(view.direction.x(), 0.0);  // the nose is to the north
  // Oblique rows are perpendicular to the viewing direction: only changes of row are not.
  const std::vector<View> oblique = views_of(Pattern::oblique, box_target(), swept);
  std::size_t beside = 0, others = 0;
  for (std::size_t i = nadir.size() + 1; i < oblique.size(); ++i) {
    if ((oblique[i].direction - oblique[i - 1].direction).norm() > 1e-9) continue;
    const Vector3d step = oblique[i].position - oblique[i - 1].position;
    ++(std::abs(step.dot(oblique[i].direction)) < 1e-9 * step.norm() ? beside : others);
  }
  EXPECT_GT(beside, 3 * others);
}

TEST(Patterns, LeaveOutOnlyViewsOnStraightLines) {
  const std::vector<View> nadir = views_of(Pattern::nadir, box_target());
  const std::vector<View> ends = without_passed_views(nadir, 0.1, 0.1);
  const std::size_t rows = millimetres(nadir, 0).size();
  EXPECT_EQ(ends.size(), 2 * rows);
  // Every removed view is on the straight line between its kept neighbours.
  for (const View& view : nadir) {
    double least = INFINITY;
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
      const Vector3d along = ends[i + 1].position - ends[i].position;
      const double share =
          std::clamp((view.position - ends[i].position).dot(along) / along.squaredNorm(), 0.0, 1.0);
      least = std::min(least, (view.position - ends[i].position - share * along).norm());
    }
    EXPECT_LT(least, 1e-9);
  }
  const std::vector<View> rings = views_of(Pattern::rings, box_target());
  const std::vector<View> stops = without_passed_views(rings, 0.5, 0.5);
  EXPECT_LT(stops.size(), rings.size());
  EXPECT_GT(stops.size(), 12U);
}

TEST(Patterns, HaveNames) {
  for (const Pattern pattern : {Pattern::nadir, Pattern::oblique, Pattern::dome, Pattern::facade,
                                Pattern::rings, Pattern::corridor}) {
    EXPECT_EQ(pattern_named(to_string(pattern)), pattern);
    EXPECT_NE(pattern_names().find(to_string(pattern)), std::string::npos);
  }
  EXPECT_FALSE(pattern_named("spiral"));
}

PatternConfig config_of(Pattern pattern) {
  PatternConfig config;
  config.pattern = pattern;
  config.view_distance = d;
  config.max_distance = 3.0 * d;
  config.footprint = footprint;
  config.target = box_target();
  return config;
}

TEST(PatternConfig, MovesViewsAwayAndDropsOthers) {
  PatternConfig config = config_of(Pattern::facade);
  config.limits.no_fly = {{"shed", {{-31, -40}, {31, -40}, {31, -14}, {-31, -14}}, -10.0, 50.0}};
  const PlannedPattern plan = plan_pattern(config);
  EXPECT_FALSE(plan.dropped.empty());
  for (const View& view : plan.dropped) EXPECT_LT(view.position.y(), -14.0);
  // A strip that is 2 m wide is avoided by a quarter of the view distance.
  config.limits.no_fly = {{"wire", {{-31, -16}, {31, -16}, {31, -14}, {-31, -14}}, -10.0, 50.0}};
  const PlannedPattern around = plan_pattern(config);
  EXPECT_TRUE(level_views(around.dropped).empty());
  for (const View& view : around.views) {
    const std::vector<View> choices = find_choices(config, view);
    ASSERT_FALSE(choices.empty());
    for (const View& choice : choices) EXPECT_TRUE(config.limits.allow(choice));
  }
}

TEST(PatternConfig, UsesNearestPitchThatTheGimbalAllows) {
  PatternConfig config = config_of(Pattern::facade);
  config.limits.max_pitch = -20.0 * geometry::radians_per_degree;
  for (const View& view : level_views(plan_pattern(config).views)) {
    EXPECT_NEAR(view.direction.z(), std::sin(config.limits.max_pitch), 1e-9);
  }
}

TEST(PatternConfig, RejectsPatternsThatCannotBeFlown) {
  PatternConfig low = config_of(Pattern::nadir);
  low.limits.max_height = 12.0;
  EXPECT_NE(thrown_message([&] { plan_pattern(low); }).find("none of the"), std::string::npos);
  PatternConfig large = config_of(Pattern::nadir);
  large.target = target_of(Eigen::AlignedBox3d(Vector3d(0, 0, 0), Vector3d(9e4, 9e4, 5)));
  EXPECT_NE(thrown_message([&] { plan_pattern(large); }).find("20,000"), std::string::npos);
  PatternConfig without = config_of(Pattern::nadir);
  without.target.reset();
  EXPECT_NE(thrown_message([&] { plan_pattern(without); }).find("requires a target"),
            std::string::npos);
  PatternConfig flat = config_of(Pattern::oblique);
  flat.settings.pitch = -5.0 * geometry::radians_per_degree;
  EXPECT_NE(thrown_message([&] { flat.validate(); }).find("pattern.pitch is -5"),
            std::string::npos);
  PatternConfig near = config_of(Pattern::rings);
  near.limits.min_standoff = d;
  EXPECT_NE(thrown_message([&] { near.validate(); }).find("stand_off"), std::string::npos);
}

// Random outlines, limits and settings: all views are within the limits, or one line says why none
// is. PATTERN_TARGETS in the environment sets the number of targets.
TEST(PatternConfig, PlansWithinLimitsOrSaysWhyForRandomTargets) {
  std::size_t planned = 0, rejected = 0;
  const char* const given = std::getenv("PATTERN_TARGETS");
  const std::uint64_t targets = given == nullptr ? 1000 : std::stoull(given);
  for (std::uint64_t seed = 1; seed <= targets; ++seed) {
    geometry::RandomNumbers random(seed);
    const auto draw = [&](double min, double max) { return random.between(min, max); };
    const auto size = [&](double min, double max) { return std::pow(10.0, draw(min, max)); };
    PatternConfig config;
    config.pattern = static_cast<Pattern>(seed % 6);
    config.view_distance = size(-0.5, 2.0);
    config.max_distance = config.view_distance * draw(0.5, 3.0);
    const double width = draw(0.1, 3.0);
    config.footprint = config.view_distance * Vector2d(width, draw(0.1, 3.0));
    config.settings.forward_overlap = draw(0.0, 0.95);
    config.settings.side_overlap = draw(0.0, 0.95);
    config.is_swept = draw(0.0, 1.0) < 0.2;
    if (draw(0.0, 1.0) < 0.3) config.frame_spacing = size(-2.0, 1.0);
    if (draw(0.0, 1.0) < 0.3) config.settings.pitch = draw(-0.5 * pi, 1.4);
    if (draw(0.0, 1.0) < 0.3) config.limits.max_height = size(-1.0, 2.0);
    if (draw(0.0, 1.0) < 0.3) config.limits.min_height = draw(-5.0, 20.0);
    if (draw(0.0, 1.0) < 0.3) config.limits.min_pitch = draw(-1.5, -0.2);
    if (draw(0.0, 1.0) < 0.3) config.limits.max_pitch = draw(-0.1, 1.5);
    if (draw(0.0, 1.0) < 0.3) {
      config.limits.geofence = {{-30, -30}, {draw(-20, 90), -20}, {40, draw(-10, 90)}};
    }
    std::vector<Vector2d> points;
    const auto count = static_cast<int>(draw(2.0, 9.0));
    const double extent = size(-1.0, 2.5);
    for (int i = 0; i < count; ++i) {
      const double x = draw(-extent, extent);
      points.push_back({x, draw(-extent, extent)});
    }
    const double top = size(-1.0, 2.0);
    config.target = seed % 2 == 0 || count < 3 ? target_of_line(points, draw(0.0, 5.0), 0.0, top)
                                               : target_of_polygon(points, 0.0, top);
    const std::string message = thrown_message([&] {
      config.validate();
      const PlannedPattern plan = plan_pattern(config);
      ASSERT_FALSE(plan.views.empty()) << seed;
      for (const View& view : plan.views) {
        const std::vector<View> choices = find_choices(config, view);
        ASSERT_FALSE(choices.empty()) << seed;
        for (const View& choice : choices) {
          ASSERT_TRUE(choice.position.allFinite()) << seed;
          ASSERT_NEAR(choice.direction.norm(), 1.0, 1e-9) << seed;
          ASSERT_TRUE(config.limits.allow(choice)) << seed;
        }
      }
      ++planned;
    });
    if (HasFatalFailure()) return;
    if (message.empty()) continue;
    ++rejected;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_GT(message.size(), 30U) << message;
  }
  EXPECT_EQ(planned + rejected, targets);
  EXPECT_GT(planned, targets / 2);
  EXPECT_GT(rejected, targets / 100);
}

}  // namespace
}  // namespace skycap::survey::patterns
