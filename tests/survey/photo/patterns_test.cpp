#include "survey/photo/patterns.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "tests/survey/photo/test_scenes.h"

namespace skycap::survey::photo {
namespace {

using Eigen::Vector3d;

constexpr double d = 8.0;

class PatternPhotosOfABox : public testing::Test {
 protected:
  PatternPhotosOfABox() { add_box(target_, {-6, -4, 0}, {6, 4, 5}); }

  PatternPhotos photos(Pattern pattern) const {
    PatternOptions options{.view_distance = d, .ground = 0.0, .min_height = 2.0};
    return pattern_photos(pattern, camera_, target_, options, space_);
  }
  Eigen::Vector2d footprint() const {
    return d / camera_.focal_length_px() * Eigen::Vector2d(camera_.width(), camera_.height());
  }

  geometry::PhotoCamera camera_{test_camera()};
  geometry::Mesh target_;
  PhotoSpace space_;
};

/// Returns the distinct values, rounded to a millimetre.
std::vector<double> distinct(std::vector<double> values) {
  std::set<long> found;
  for (const double value : values) found.insert(std::lround(1e3 * value));
  std::vector<double> result;
  for (const long value : found) result.push_back(1e-3 * static_cast<double>(value));
  return result;
}

TEST_F(PatternPhotosOfABox, NadirHasSpacingOfItsOverlaps) {
  const PatternPhotos nadir = photos(Pattern::nadir);
  std::vector<double> x, y;
  for (const geometry::View& view : nadir.views) {
    EXPECT_DOUBLE_EQ(view.position.z(), 5.0 + d);
    EXPECT_EQ(view.direction, -Vector3d::UnitZ());
    x.push_back(view.position.x());
    y.push_back(view.position.y());
  }
  const std::vector<double> columns = distinct(x), rows = distinct(y);
  EXPECT_EQ(columns.size() * rows.size(), nadir.views.size());
  EXPECT_NEAR(columns[1] - columns[0], 0.3 * footprint().x(), 2e-3);
  EXPECT_NEAR(rows[1] - rows[0], 0.2 * footprint().y(), 2e-3);
  // The grid covers the box and 0.15 d on each side.
  EXPECT_LE(columns.front(), -6.0 - 0.15 * d + 1e-3);
  EXPECT_GE(columns.back(), 6.0 + 0.15 * d - 1e-3);
  EXPECT_LT(columns.front(), -columns[columns.size() - 2] + 1e-3);
}

TEST_F(PatternPhotosOfABox, ObliqueLooksDownInFourDirectionsAndStraight) {
  const PatternPhotos oblique = photos(Pattern::oblique);
  std::set<std::pair<int, int>> headings;
  std::size_t tilted = 0;
  for (const geometry::View& view : oblique.views) {
    if (view.direction.head<2>().norm() < 1e-9) continue;
    ++tilted;
    EXPECT_NEAR(view.direction.z(), -std::sqrt(0.5), 1e-12);
    EXPECT_NEAR(view.position.z(), 5.0 + d * std::sqrt(0.5), 1e-12);
    headings.insert({static_cast<int>(std::lround(2 * view.direction.x())),
                     static_cast<int>(std::lround(2 * view.direction.y()))});
  }
  EXPECT_EQ(headings.size(), 4U);
  EXPECT_EQ(oblique.views.size() - tilted, photos(Pattern::nadir).views.size());
}

TEST_F(PatternPhotosOfABox, DomeLooksAtTheMiddleFromItsRadius) {
  const double radius = 0.75 * 0.5 * std::hypot(12.0, 8.0) + d;
  const PatternPhotos dome = photos(Pattern::dome);
  std::size_t level = 0, inclined = 0;
  for (const geometry::View& view : dome.views) {
    const Vector3d from_axis(view.position.x(), view.position.y(), 0.0);
    if (std::abs(view.direction.z()) < 1e-12) {
      ++level;
      EXPECT_NEAR(from_axis.norm(), radius, 1e-9);
    } else {
      ++inclined;
      EXPECT_NEAR((view.position - Vector3d(0, 0, 2.5)).norm(), radius, 1e-9);
      EXPECT_LT((view.position + radius * view.direction - Vector3d(0, 0, 2.5)).norm(), 1e-9);
    }
  }
  EXPECT_EQ(level, 48U);                      // Two orbits in steps of 15 degrees.
  EXPECT_EQ(inclined, 21U + 17U + 12U + 7U);  // 360 cos(elevation) / 15, rounded up
}

TEST_F(PatternPhotosOfABox, FacadeStandsOffTheHull) {
  const PatternPhotos facade = photos(Pattern::facade);
  std::vector<double> heights;
  std::vector<geometry::View> min_height;
  for (const geometry::View& view : facade.views) {
    if (view.direction.z() < -0.5) continue;  // Photos of the nadir grid.
    const Eigen::Vector2d at = view.position.head<2>().cwiseAbs() - Eigen::Vector2d(6.0, 4.0);
    EXPECT_NEAR(at.cwiseMax(0.0).norm(), d, 1e-9);
    heights.push_back(view.position.z());
    if (view.position.z() < 2.0 + 1e-9) min_height.push_back(view);
  }
  const std::vector<double> rows = distinct(heights);
  EXPECT_NEAR(rows.front(), 2.0, 1e-3);
  EXPECT_NEAR(rows.back(), 5.0 - 0.2 * d, 1e-3);
  const double perimeter = 2.0 * (12.0 + 8.0) + 2.0 * 3.14159265358979 * d;
  EXPECT_EQ(min_height.size(), std::ceil(perimeter / (0.2 * footprint().x())));
}

TEST_F(PatternPhotosOfABox, DropsPhotosThatAreNotFree) {
  space_.limits.max_height = 12.0;
  const PatternPhotos nadir = photos(Pattern::nadir);
  EXPECT_TRUE(nadir.views.empty());
  EXPECT_GT(nadir.dropped, 0U);
}

TEST_F(PatternPhotosOfABox, AreNotMadeAboveTheLimit) {
  add_box(target_, {0, 0, 0}, {50000, 40000, 30});
  for (const Pattern pattern : {Pattern::nadir, Pattern::oblique, Pattern::facade}) {
    const PatternPhotos large = photos(pattern);
    EXPECT_TRUE(large.is_too_large) << to_string(pattern);
    EXPECT_TRUE(large.views.empty()) << to_string(pattern);
  }
  EXPECT_FALSE(photos(Pattern::dome).is_too_large);
}

}  // namespace
}  // namespace skycap::survey::photo
