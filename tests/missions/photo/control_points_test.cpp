#include "missions/photo/control_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/pose/brown_distortion.h"
#include "tests/missions/photo/test_plan.h"
#include "tests/support/complaint.h"

namespace skycap::missions::photo {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const flight::Site site{{51.753458, -1.254022, 111.5}, {}};

bool nothing_is_blocked(const Vector3d&, const Vector3d&) { return false; }

TEST(ControlPoints, AreReadInEitherSystem) {
  const auto local = read_control_points("name,x,y,z\nP1, 1.5,-2,0.25\n\nP2,0,0,0\n", {});
  ASSERT_THAT(local, SizeIs(2));
  EXPECT_EQ(local[0].name, "P1");
  EXPECT_EQ(local[0].position, Vector3d(1.5, -2, 0.25));
  const auto geodetic =
      read_control_points("name,latitude,longitude,height\nO,51.753458,-1.254022,113.5\n", site);
  EXPECT_LT((geodetic.at(0).position - Vector3d(0, 0, 2)).norm(), 1e-6);
}

TEST(ControlPoints, NameTheLineThatIsWrong) {
  const auto error_message = [](const std::string& text, const std::optional<flight::Site>& where) {
    return testing_support::thrown_message([&] { read_control_points(text, where); });
  };
  EXPECT_THAT(error_message("x,y,z\n", {}), HasSubstr("line 1 must be"));
  EXPECT_THAT(error_message("name,x,y,z\nP,1,2\n", {}), HasSubstr("line 2 has 3 fields"));
  EXPECT_THAT(error_message("name,x,y,z\nP,1,2,three\n", {}), HasSubstr("line 2 has \"three\""));
  EXPECT_THAT(error_message("name,x,y,z\nP,1,2,-1e8\n", {}),
              HasSubstr("line 2 is more than 10,000 km from the origin"));
  EXPECT_THAT(error_message("name,x,y,z\nP,1,2,3\nP,1,2,3\n", {}),
              HasSubstr("line 3 lists \"P\" again"));
  EXPECT_THAT(error_message("name,x,y,z\n,1,2,3\n", {}), HasSubstr("line 2 has no name"));
  EXPECT_THAT(error_message("name,x,y,z\n", {}),
              HasSubstr("line 1 must be followed by at least one point"));
  EXPECT_THAT(error_message("name,latitude,longitude,height\nP,51,-1,100\n", {}),
              HasSubstr("require site.latitude_deg"));
  EXPECT_THAT(error_message("name,latitude,longitude,height\nP,510,-1,100\n", site),
              HasSubstr("line 2 has a latitude"));
}

// Calculated by hand for a point below the first photo, which faces straight down with its top to
// the north.
TEST(ControlPoints, AreWhereThePhotoShowsThem) {
  const survey::photo::PhotoPlan plan = test_plan();
  const double focal = geometry::PhotoCamera(plan.camera).focal_length_px();
  const ControlPoint point{"P", {3.0, 2.0, 0.0}};
  const auto observations = find_observations(point, plan, nothing_is_blocked);
  ASSERT_FALSE(observations.empty());
  EXPECT_EQ(observations[0].photo, 0U);
  const Vector2d expected = Vector2d(2640, 1978) + focal / 18.0 * Vector2d(3.0, -2.0);
  EXPECT_NEAR((observations[0].pixel - expected).norm(), 0.0, 1e-6);
  EXPECT_NEAR(observations[0].distance, Vector3d(3, 2, 18).norm(), 1e-9);
}

TEST(ControlPoints, AreHiddenByWhatIsInTheWay) {
  const survey::photo::PhotoPlan plan = test_plan();
  const ControlPoint point{"P", {0.0, 0.0, 2.0}};
  const auto photos = [&](const Blocked& is_blocked) {
    std::vector<std::uint32_t> found;
    for (const auto& observation : find_observations(point, plan, is_blocked)) {
      found.push_back(observation.photo);
    }
    return found;
  };
  EXPECT_THAT(photos(nothing_is_blocked), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(photos([](const Vector3d& from, const Vector3d&) { return from.z() < 5.0; }),
              ElementsAre(0, 2));
  const ControlPoint far{"far", {0.0, 0.0, -40.0}};
  EXPECT_THAT(find_observations(far, plan, nothing_is_blocked), IsEmpty());
  EXPECT_THAT(control_warnings({point, far}, plan, nothing_is_blocked),
              ElementsAre(HasSubstr("\"far\" is visible in 0 photos")));
  const std::string table = control_table({point}, plan, nothing_is_blocked);
  EXPECT_THAT(table, HasSubstr("P,photo_0004.jpg,2640.0,1978.0,16.000,"));
}

TEST(ControlPoints, AreMovedByTheLens) {
  survey::photo::PhotoPlan plan = test_plan();
  plan.camera.distortion = geometry::BrownDistortion{.k1 = -0.1};
  const geometry::PhotoCamera camera(plan.camera);
  const auto seen = find_observations({"P", {3.0, 2.0, 0.0}}, plan, nothing_is_blocked);
  const Vector2d slope = geometry::distort(*plan.camera.distortion, Vector2d(3.0, -2.0) / 18.0);
  EXPECT_NEAR((seen.at(0).pixel - Vector2d(2640, 1978) - camera.focal_length_px() * slope).norm(),
              0.0, 1e-6);
}

}  // namespace
}  // namespace skycap::missions::photo
