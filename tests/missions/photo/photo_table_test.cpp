// Tables of planned photos and angles of OpenDroneMap.
#include "missions/photo/photo_table.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "flight/export/text.h"
#include "geometry/angle.h"
#include "geometry/io/file.h"
#include "tests/missions/photo/test_plan.h"

namespace skycap::missions::photo {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::ElementsAre;
using testing::SizeIs;

const flight::Site site{{51.753458, -1.254022, 111.5}, 46.7};

/// Returns viewing direction and top of an image in OpenDroneMap's convention, in the east-north-up
/// frame. The rotation in its photo.py (compute_opk) is in north-east-down, with an image frame of
/// x right, y up, z back.
struct Axes {
  Vector3d forward, up;
};
Axes odm_axes(const OdmAngles& angles) {
  const double y = angles.yaw_deg * geometry::radians_per_degree;
  const double p = angles.pitch_deg * geometry::radians_per_degree;
  const double r = angles.roll_deg * geometry::radians_per_degree;
  Matrix3d cnb;
  cnb << std::cos(y) * std::cos(p),
      std::cos(y) * std::sin(p) * std::sin(r) - std::sin(y) * std::cos(r),
      std::cos(y) * std::sin(p) * std::cos(r) + std::sin(y) * std::sin(r),
      std::sin(y) * std::cos(p),
      std::sin(y) * std::sin(p) * std::sin(r) + std::cos(y) * std::cos(r),
      std::sin(y) * std::sin(p) * std::cos(r) - std::cos(y) * std::sin(r), -std::sin(p),
      std::cos(p) * std::sin(r), std::cos(p) * std::cos(r);
  Matrix3d cbb;
  cbb << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  const Matrix3d ned_from_image = cnb * cbb;
  const auto enu = [](const Vector3d& ned) { return Vector3d(ned.y(), ned.x(), -ned.z()); };
  return {enu(-ned_from_image.col(2)), enu(ned_from_image.col(1))};
}

// Nadir is pitch -90 in Skycap and 0 in OpenDroneMap. The horizon is 0 and 90.
TEST(OdmAngles, CountPitchFromNadir) {
  const survey::photo::PhotoPlan plan = test_plan();
  EXPECT_NEAR(plan.photos[0].pitch * geometry::degrees_per_radian, -90.0, 1e-12);
  EXPECT_NEAR(odm_angles(plan.photos[0]).pitch_deg, 0.0, 1e-12);
  EXPECT_NEAR(odm_angles(plan.photos[1]).pitch_deg, 90.0, 1e-12);
  EXPECT_NEAR(odm_angles(plan.photos[1]).yaw_deg, 0.0, 1e-12);
}

// Property: OpenDroneMap's rotation with these angles gives the axes of the camera.
TEST(OdmAngles, GiveTheViewBack) {
  for (double yaw_deg = 0.0; yaw_deg < 360.0; yaw_deg += 30.0) {
    for (double pitch_deg = -85.0; pitch_deg <= 40.0; pitch_deg += 12.5) {
      const flight::Aim aim{yaw_deg * geometry::radians_per_degree,
                            pitch_deg * geometry::radians_per_degree};
      const geometry::View view{{1, 2, 3}, flight::compute_direction(aim)};
      const Axes axes = odm_axes(odm_angles(photo("p", view)));
      const Matrix3d camera = geometry::camera_pose(view).linear();
      EXPECT_NEAR((axes.forward - camera.col(2)).norm(), 0.0, 1e-9) << yaw_deg << " " << pitch_deg;
      EXPECT_NEAR((axes.up + camera.col(1)).norm(), 0.0, 1e-9) << yaw_deg << " " << pitch_deg;
    }
  }
  const survey::photo::PlannedPhoto nadir = test_plan().photos[0];
  const Axes axes = odm_axes(odm_angles(nadir));
  EXPECT_NEAR((axes.forward - Vector3d(0, 0, -1)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((axes.up - Vector3d(0, 1, 0)).norm(), 0.0, 1e-9);
}

TEST(PhotoTable, HasARowForEachPhoto) {
  const survey::photo::PhotoPlan plan = test_plan();
  const auto lines = flight::split_lines(photo_table(plan, site, {.position = 0.05}));
  ASSERT_THAT(lines, SizeIs(5));
  const auto names = flight::split(lines[0], ',');
  ASSERT_THAT(names, SizeIs(16));
  const auto nadir = flight::split(lines[1], ',');
  EXPECT_THAT(nadir, SizeIs(16));
  EXPECT_EQ(nadir[0], "photo_0004.jpg");
  EXPECT_EQ(nadir[5], "18.000");
  EXPECT_EQ(nadir[10], "-90.0000");
  EXPECT_EQ(nadir[12], "0.050");
  EXPECT_EQ(flight::split(lines[2], ',')[2], "62.50");
  // Events are counted per sortie, as cameras number their photos.
  std::vector<std::string> events, sorties;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    events.push_back(flight::split(lines[i], ',')[1]);
    sorties.push_back(flight::split(lines[i], ',')[15]);
  }
  EXPECT_THAT(events, ElementsAre("1", "2", "1", "2"));
  EXPECT_THAT(sorties, ElementsAre("1", "1", "2", "2"));
  // The geodetic columns correspond to the local coordinates.
  const flight::LocalFrame frame(site.origin);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto fields = flight::split(lines[i], ',');
    const Vector3d position =
        frame.to_local({*flight::to_number(fields[6]), *flight::to_number(fields[7]),
                        *flight::to_number(fields[8])});
    EXPECT_LT((position - plan.photos[i - 1].view.position).norm(), 0.002);
  }
}

TEST(PhotoTable, LeavesGeodeticColumnsEmptyWithoutASite) {
  const auto lines = flight::split_lines(photo_table(test_plan(), {}));
  const auto fields = flight::split(lines[1], ',');
  ASSERT_THAT(fields, SizeIs(16));
  EXPECT_EQ(fields[6] + fields[7] + fields[8], "");
}

TEST(OdmGeolocations, BeginWithTheirSystemAndHaveNineFields) {
  const auto lines = flight::split_lines(odm_geolocations(test_plan(), site));
  ASSERT_THAT(lines, SizeIs(5));
  EXPECT_EQ(lines[0], "EPSG:4326");
  const auto fields = flight::split(lines[1], ' ');
  ASSERT_THAT(fields, SizeIs(9));
  EXPECT_EQ(fields[0], "photo_0004.jpg");
  EXPECT_NEAR(*flight::to_number(fields[1]), site.origin.longitude_deg, 1e-6);
  EXPECT_NEAR(*flight::to_number(fields[2]), site.origin.latitude_deg, 1e-6);
  EXPECT_NEAR(*flight::to_number(fields[3]), 129.5, 1e-3);
  EXPECT_EQ(fields[5], "0.0000");
}

TEST(PhotoTable, IsStagedWithTheOdmFile) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "photo_table_test";
  {
    geometry::OutputFolder folder(path);
    stage_photo_tables(test_plan(), flight::Site{{51.75, -1.25, 111.5}, {}}, {}, folder);
    folder.commit();
  }
  EXPECT_THAT(geometry::read_file(path / "photos.csv"), testing::StartsWith("name,event,time_s,"));
  EXPECT_THAT(geometry::read_file(path / "geo.txt"), testing::StartsWith("EPSG:4326\n"));
  std::filesystem::remove_all(path);
}

}  // namespace
}  // namespace skycap::missions::photo
