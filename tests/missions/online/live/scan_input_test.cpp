#include "missions/online/live/scan_input.h"

#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/pose/camera.h"
#include "missions/config/resolve.h"
#include "missions/online/live/kept_scan.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::online {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::thrown_message;

/// Returns a mission with a camera of 64 x 48 pixels and 90-degree fields of view: f = 32 and 24.
config::MissionSetup make_setup(const std::string& more = "") {
  return config::parse_mission(
      "sensor: {width: 64, height: 48, horizontal_fov_deg: 90, vertical_fov_deg: 90,\n"
      "         max_range: 20}\n"
      "planner: {density: 5200, resolution_radius: 0.0525,\n"
      "          scene_box: {min: [-1, -1, -1], max: [1, 1, 1]}}\n"
      "evaluation: {coverage_distance: 0.03}\n" +
          more,
      "m.yaml");
}

ScanFound read(const ScanInput& input) {
  const config::MissionSetup setup = make_setup();
  return read_scan(input, setup.flight().capture, setup.live);
}

Isometry3d some_pose() {
  Isometry3d pose = Isometry3d::Identity();
  pose.translation() = Vector3d(1.0, -2.0, 3.0);
  pose.linear() = Eigen::AngleAxisd(0.7, Vector3d(0.6, 0.0, 0.8)).toRotationMatrix();
  return pose;
}

TEST(CameraIntrinsics, ComputesRaysThatDistortBackToPixels) {
  // Real camera: TUM RGB-D freiburg1, colour.
  const CameraIntrinsics intrinsics =
      parse_intrinsics("517.3 516.5 318.6 255.3 0.2624 -0.9531 -0.0054 0.0026 1.1633");
  for (int u = 0; u < 640; u += 71) {
    for (int v = 0; v < 480; v += 53) {
      const auto ray = intrinsics.ray({u, v});
      ASSERT_TRUE(ray) << u << ", " << v;
      // Formula from OpenCV's documentation of calib3d.
      const double x = ray->x(), y = ray->y(), r2 = x * x + y * y;
      const double radial = 1 + 0.2624 * r2 - 0.9531 * r2 * r2 + 1.1633 * r2 * r2 * r2;
      const double xd = x * radial + 2 * -0.0054 * x * y + 0.0026 * (r2 + 2 * x * x);
      const double yd = y * radial + -0.0054 * (r2 + 2 * y * y) + 2 * 0.0026 * x * y;
      EXPECT_NEAR(517.3 * xd + 318.6, u, 2e-3);
      EXPECT_NEAR(516.5 * yd + 255.3, v, 2e-3);
    }
  }
}

TEST(CameraIntrinsics, HasNoRayWhereDistortionIsNotInvertible) {
  EXPECT_FALSE(parse_intrinsics("500 500 320 240 -3 0 0 0 0").ray({0, 0}));
}

TEST(CameraIntrinsics, HasNoRayWhereItIsInfinite) {
  EXPECT_FALSE(parse_intrinsics("1e-320 1 0 0").ray({1, 0}));
  EXPECT_TRUE(parse_intrinsics("1e-320 1 0 0").ray({0, 1}));
}

TEST(PoseString, ReadsEveryLayout) {
  const Isometry3d pose = some_pose();
  const Eigen::Quaterniond q(pose.linear());
  std::ostringstream seven, twelve;
  seven.precision(17), twelve.precision(17);
  seven << "1 -2 3 " << q.x() << " " << q.y() << " " << q.z() << " " << q.w();
  for (int i = 0; i < 12; ++i) twelve << pose(i / 4, i % 4) << (i % 4 == 3 ? "\n" : "\t");
  for (const std::string& text :
       {seven.str(), "1305031102.17 " + seven.str(), twelve.str(), twelve.str() + "0 0 0 1\n"}) {
    EXPECT_TRUE(parse_pose_text(text, "pose").isApprox(pose, 1e-12)) << text;
  }
}

/// Pose as trackers write it, from the data set 7-Scenes.
TEST(PoseString, OrthonormalisesRotation) {
  const Isometry3d pose = parse_pose_text(
      "0.9093129 0.2726223 -0.3142243 -0.34\n-0.2724862 0.9610498 0.0452796 0.016\n"
      "0.3143392 0.0444496 0.9482094 0.297\n0 0 0 1\n",
      "pose");
  EXPECT_LT((pose.linear() * pose.linear().transpose() - Eigen::Matrix3d::Identity()).norm(),
            1e-14);
  EXPECT_NEAR(pose.linear()(0, 0), 0.9093, 1e-3);
  EXPECT_EQ(pose.translation(), Vector3d(-0.34, 0.016, 0.297));
}

TEST(PoseString, RejectsInvalidPoses) {
  for (const std::string text :
       {"", "1 2 3", "1 2 3 0 0 0 0", "1 2 3 0 0 0 2", "nan 0 0 0 0 0 1", "1e300 0 0 0 0 0 1",
        "1 2 3 4 5 6 x", "1 0 0 0 0 1 0 0 0 0 -1 0", "2 0 0 0 0 2 0 0 0 0 2 0",
        "1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18"}) {
    EXPECT_THAT(thrown_message([&] { parse_pose_text(text, "pose"); }), HasSubstr("pose")) << text;
  }
}

TEST(DepthImage, ConvertsPixelsToPointsAlongRays) {
  const testing_support::TemporaryFolder folder;
  geometry::DepthImage image{64, 48, std::vector<std::uint16_t>(64 * 48, 0)};
  image.values[10 * 64 + 20] = 1500;
  image.values[11 * 64 + 21] = 65535;
  image.values[47 * 64 + 63] = 4000;
  const auto file = folder.path() / "depth.png";
  geometry::write_depth_png(image, file);
  const ScanFound found = read({.file = file, .world_from_sensor = some_pose(), .intrinsics = {}});
  ASSERT_EQ(found.scan.points.size(), 2U);
  EXPECT_THAT(found.scan.pixels, ElementsAre(10 * 64 + 20, 47 * 64 + 63));
  EXPECT_EQ(found.without_return, 64U * 48U - 2U);
  const Vector3d expected =
      some_pose() * Vector3d((20 - 31.5) / 32 * 1.5, (10 - 23.5) / 24 * 1.5, 1.5);
  EXPECT_LT((found.scan.points[0].cast<double>() - expected).norm(), 1e-6);
}

// ICL-NUIM images have a negative focal length: the axis has the opposite direction.
TEST(CameraIntrinsics, FlipsAxisForNegativeFocalLength) {
  const auto up = parse_intrinsics("480 -480 319.5 239.5").ray({400, 100});
  const auto down = parse_intrinsics("480 480 319.5 239.5").ray({400, 100});
  ASSERT_TRUE(up && down);
  EXPECT_EQ(up->x(), down->x());
  EXPECT_EQ(up->y(), -down->y());
  EXPECT_THAT(thrown_message([] { parse_intrinsics("480 0 319.5 239.5"); }),
              HasSubstr("non-zero focal lengths"));
}

// A size that differs by a factor in both directions is rejected. Cropped images and shifted
// principal points are accepted.
TEST(DepthImage, RejectsSizeDifferentFromIntrinsics) {
  const testing_support::TemporaryFolder folder;
  const auto error_message = [&](int width, int height,
                                 const std::optional<CameraIntrinsics>& intrinsics) {
    const auto file = folder.path() / "size.png";
    const auto count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    geometry::write_depth_png({width, height, std::vector<std::uint16_t>(count, 1500)}, file);
    return thrown_message([&] { read({.file = file, .intrinsics = intrinsics}); });
  };
  EXPECT_THAT(
      error_message(320, 240, parse_intrinsics("145 145 80 60")),
      testing::AllOf(HasSubstr("size.png"),
                     HasSubstr("the intrinsics belong to an image of about 160 x 120 pixels"),
                     HasSubstr("the image has 320 x 240 pixels; multiply fx fy cx cy by 1.99")));
  EXPECT_THAT(error_message(160, 120, parse_intrinsics("517 517 318.6 255.3")),
              HasSubstr("multiply fx fy cx cy by 0.24"));
  EXPECT_THAT(error_message(160, 120, std::nullopt), HasSubstr("about 63 x 47 pixels"));
  EXPECT_EQ(error_message(64, 48, parse_intrinsics("40 40 30 25")), "");
  EXPECT_EQ(error_message(160, 120, parse_intrinsics("145 145 95 50")), "");
  EXPECT_EQ(error_message(160, 60, parse_intrinsics("145 145 80 60")), "");
}

/// The intrinsics differ from the mission's camera. Points remain correct, and they are assigned to
/// the corresponding pixels.
TEST(DepthImage, RemapsOtherIntrinsicsToMissionPixels) {
  const testing_support::TemporaryFolder folder;
  const geometry::DepthImage image{64, 48, std::vector<std::uint16_t>(64 * 48, 2000)};
  const auto file = folder.path() / "depth.png";
  geometry::write_depth_png(image, file);
  const CameraIntrinsics intrinsics = parse_intrinsics("40 40 30 25");
  const ScanFound found = read({.file = file, .intrinsics = intrinsics});
  const geometry::Camera camera(make_setup().flight().capture.camera);
  EXPECT_EQ(found.scan.points.size() + found.hidden + found.out_of_view, 64U * 48U);
  for (std::size_t i = 0; i < found.scan.points.size(); ++i) {
    const auto pixel = camera.project(found.scan.points[i].cast<double>());
    ASSERT_TRUE(pixel);
    EXPECT_EQ(std::lround(pixel->x()) + 64 * std::lround(pixel->y()), found.scan.pixels[i]);
  }
  EXPECT_NO_THROW(require_usable(found.scan, make_setup().flight()));
}

TEST(Cloud, ProjectsUnorderedPointsIntoCamera) {
  const testing_support::TemporaryFolder folder;
  const auto file = folder.path() / "cloud.ply";
  // Points behind the camera, outside the image, two in one pixel, and one in the centre.
  const std::vector<Eigen::Vector3f> points{
      {0, 0, -1}, {9, 0, 1}, {1, 0.5, 4}, {0.5, 0.25, 2}, {0, 0, 1}};
  geometry::write_cloud(file, {.positions = points, .normals = {}, .views = {}, .colours = {}});
  const ScanFound found = read({.file = file, .intrinsics = {}});
  EXPECT_EQ(found.out_of_view, 2U);
  EXPECT_EQ(found.hidden, 1U);
  EXPECT_THAT(found.scan.points, testing::UnorderedElementsAre(points[3], points[4]));
}

TEST(Cloud, KeepsWorldCoordinates) {
  const testing_support::TemporaryFolder folder;
  const auto file = folder.path() / "cloud.ply";
  const Vector3d in_view = some_pose() * Vector3d(0.1, 0.1, 2.0);
  const std::vector<Eigen::Vector3f> points{in_view.cast<float>()};
  geometry::write_cloud(file, {.positions = points, .normals = {}, .views = {}, .colours = {}});
  const ScanFound found =
      read({.file = file, .world_from_sensor = some_pose(), .is_in_world = true, .intrinsics = {}});
  ASSERT_EQ(found.scan.points.size(), 1U);
  EXPECT_LT((found.scan.points[0] - points[0]).norm(), 1e-6);
}

TEST(StoredScan, ReadsBackExactly) {
  geometry::Scan scan;
  scan.points = {{0.1F, -2e-30F, 3e7F}, {-0.0F, 1e-45F, 7.0F}};
  scan.pixels = {0, 4294967295U};
  for (const bool is_organised : {true, false}) {
    if (!is_organised) scan.pixels.clear();
    const geometry::Scan again = parse_kept_scan("scan", kept_scan(scan));
    EXPECT_TRUE(again.points == scan.points);
    EXPECT_EQ(again.pixels, scan.pixels);
  }
  EXPECT_THAT(parse_kept_scan("scan", kept_scan({})).points, IsEmpty());
}

TEST(RequireUsable, RejectsInvalidScans) {
  const auto message = [](const geometry::Scan& scan, const std::string& more = "") {
    return thrown_message([&] { require_usable(scan, make_setup(more).flight()); });
  };
  geometry::Scan scan;
  scan.points = {{0, 0, 1}, {0, 0, 2}};
  EXPECT_EQ(message(scan), "");
  scan.pixels = {5};
  EXPECT_THAT(message(scan), HasSubstr("1 pixels for 2 points"));
  scan.pixels = {5, 5};
  EXPECT_THAT(message(scan), HasSubstr("are not ascending"));
  scan.pixels = {5, 64 * 48};
  EXPECT_THAT(message(scan), HasSubstr("outside the mission's camera"));
  scan.pixels = {5, 6};
  scan.points[1].x() = NAN;
  EXPECT_THAT(message(scan), HasSubstr("invalid point (number 1)"));
  scan.points[1].x() = 20000;
  EXPECT_THAT(message(scan), HasSubstr("16384 m"));
}

}  // namespace
}  // namespace skycap::missions::online
