// Files for COLMAP: projections with the written model equal those of the camera.
#include "missions/photo/colmap_model.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/text.h"
#include "geometry/io/file.h"
#include "geometry/pose/brown_distortion.h"
#include "tests/missions/photo/test_plan.h"

namespace skycap::missions::photo {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

std::vector<std::string> data_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (const std::string& line : flight::split_lines(text)) {
    if (!line.empty() && line[0] != '#') lines.push_back(line);
  }
  return lines;
}

/// Returns the projection with the text files, as defined in COLMAP's documentation.
Vector2d colmap_pixel(const std::string& cameras, const std::string& image_line,
                      const Vector3d& world) {
  std::istringstream camera(data_lines(cameras)[0]), image(image_line);
  int id = 0, width = 0, height = 0;
  std::string model;
  double fx = 0, fy = 0, cx = 0, cy = 0, k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  camera >> id >> model >> width >> height >> fx >> fy >> cx >> cy;
  if (model != "PINHOLE") camera >> k1 >> k2 >> p1 >> p2;
  if (model == "FULL_OPENCV") camera >> k3;
  double w = 0, x = 0, y = 0, z = 0, tx = 0, ty = 0, tz = 0;
  image >> id >> w >> x >> y >> z >> tx >> ty >> tz;
  const Vector3d local = Eigen::Quaterniond(w, x, y, z) * world + Vector3d(tx, ty, tz);
  const double u = local.x() / local.z(), v = local.y() / local.z(), r2 = u * u + v * v;
  const double radial = 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2;
  return {fx * (u * radial + 2 * p1 * u * v + p2 * (r2 + 2 * u * u)) + cx,
          fy * (v * radial + 2 * p2 * u * v + p1 * (r2 + 2 * v * v)) + cy};
}

// COLMAP's pixel origin is the corner of the image. Skycap's is the centre of the first pixel.
TEST(ColmapModel, ProjectsAsTheCameraDoes) {
  survey::photo::PhotoPlan plan = test_plan();
  const geometry::PhotoCamera camera(plan.camera);
  const auto images = data_lines(colmap_images(plan));
  ASSERT_THAT(images, SizeIs(4));
  const std::vector<std::size_t> photo_of{1, 2, 3,
                                          0};  // Photo of each image, in the order of names.
  std::size_t seen = 0;
  for (std::size_t i = 0; i < images.size(); ++i) {
    const survey::photo::PlannedPhoto& photo = plan.photos[photo_of[i]];
    EXPECT_THAT(images[i], HasSubstr(photo.name + ".jpg"));
    EXPECT_EQ(images[i].substr(0, 2), std::to_string(i + 1) + " ");
    for (const Vector3d& point : {Vector3d(0, 0, 2), Vector3d(1, -2, 3), Vector3d(-2, 1, 4)}) {
      const Vector3d local = geometry::camera_pose(photo.view).inverse() * point;
      const auto pixel = camera.project(local);
      if (!pixel) continue;
      ++seen;
      const Vector2d theirs = colmap_pixel(colmap_cameras(plan.camera), images[i], point);
      EXPECT_NEAR((theirs - *pixel - Vector2d(0.5, 0.5)).norm(), 0.0, 1e-4) << photo.name;
    }
  }
  EXPECT_GE(seen, 8U);
}

TEST(ColmapModel, HasTheDistortionOfTheLens) {
  geometry::PhotoCameraConfig camera = mavic_3e();
  EXPECT_EQ(colmap_camera_model(camera), "PINHOLE");
  camera.distortion = geometry::BrownDistortion{.k1 = -0.1, .k2 = 0.02, .p1 = 0.001, .p2 = 0.002};
  EXPECT_EQ(colmap_camera_model(camera), "OPENCV");
  EXPECT_THAT(flight::split(colmap_camera_parameters(camera), ','), SizeIs(8));
  camera.distortion->k3 = -0.005;
  EXPECT_EQ(colmap_camera_model(camera), "FULL_OPENCV");
  EXPECT_THAT(flight::split(colmap_camera_parameters(camera), ','), SizeIs(12));
  // For a camera at the origin that faces along z, world and camera frame are equal.
  const Vector2d slope(0.4, -0.3);
  const geometry::PhotoCamera intrinsics(camera);
  const Vector2d expected =
      intrinsics.focal_length_px() * geometry::distort(*camera.distortion, slope) +
      0.5 * Vector2d(camera.width, camera.height);
  const Vector2d theirs =
      colmap_pixel(colmap_cameras(camera), "1 1 0 0 0 0 0 0 1 a.jpg", {0.8, -0.6, 2.0});
  EXPECT_NEAR((theirs - expected).norm(), 0.0, 1e-4);
}

TEST(ColmapModel, ListsPairsByName) {
  const std::vector<survey::photo::PhotoPair> pairs{{0, 1, 0.5}, {2, 3, 0.2}};
  EXPECT_THAT(data_lines(colmap_pairs(test_plan(), pairs, ".png")),
              ElementsAre("photo_0004.png photo_0001.png", "photo_0002.png photo_0003.png"));
}

// Independent check: Debian's colmap reads the model, if it is installed.
TEST(ColmapModel, IsReadByColmap) {
  if (std::system("command -v colmap > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "colmap is not installed";
  }
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "skycap_colmap_model";
  const survey::photo::PhotoPlan plan = test_plan();
  write_colmap(plan, {}, {}, folder);
  const std::filesystem::path log = folder / "analysis.log";
  const std::string quoted = "'" + folder.string() + "'";
  ASSERT_EQ(
      std::system(
          ("colmap model_analyzer --path " + quoted + " > '" + log.string() + "' 2>&1").c_str()),
      0);
  EXPECT_THAT(geometry::read_file(log), HasSubstr("Cameras: 1"));
  EXPECT_THAT(geometry::read_file(log), HasSubstr("Images: 4"));
  EXPECT_THAT(geometry::read_file(log), HasSubstr("Registered images: 4"));
  // The poses are unchanged after COLMAP has read and written them.
  const std::filesystem::path again = folder / "again";
  std::filesystem::create_directories(again);
  ASSERT_EQ(std::system(("colmap model_converter --input_path " + quoted + " --output_path '" +
                         again.string() + "' --output_type TXT > /dev/null 2>&1")
                            .c_str()),
            0);
  const auto theirs = data_lines(geometry::read_file(again / "images.txt"));
  ASSERT_THAT(theirs, SizeIs(4));
  const std::string ours = colmap_images(plan);
  for (const std::string& line : theirs) {
    const std::string name = line.substr(line.rfind(' ') + 1);
    for (const std::string& own : data_lines(ours)) {
      if (!own.ends_with(name)) continue;
      const Vector3d point(0.5, 0.3, 2.5);
      const std::string cameras = colmap_cameras(plan.camera);
      EXPECT_NEAR((colmap_pixel(cameras, line, point) - colmap_pixel(cameras, own, point)).norm(),
                  0.0, 1e-4);
    }
  }
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace skycap::missions::photo
