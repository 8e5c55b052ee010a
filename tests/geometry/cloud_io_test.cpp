#include "geometry/cloud_io.h"

#include <string>

#include <CGAL/IO/read_ply_points.h>
#include <CGAL/Simple_cartesian.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/support/temporary_folder.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3f;
using testing::HasSubstr;
using testing_support::TemporaryFolder;

CloudFile three_points() {
  return {{{1.5F, 2, -3}, {0.1F, 0, 0}, {4, 5, 6}},
          {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}},
          {0, 7, 4294967295U},
          {{255, 0, 1}, {2, 3, 4}, {5, 6, 7}}};
}

TEST(CloudIo, RoundTripKeepsEveryAttribute) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.ply";
  const CloudFile cloud = three_points();
  write_cloud(path, cloud);
  const CloudFile again = read_cloud(path);
  EXPECT_EQ(again.positions, cloud.positions);
  EXPECT_EQ(again.normals, cloud.normals);
  EXPECT_EQ(again.views, cloud.views);
  EXPECT_EQ(again.colours, cloud.colours);
}

TEST(CloudIo, AbsentAttributesStayAbsent) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.ply";
  write_cloud(path, {three_points().positions, {}, {}, {}});
  const CloudFile again = read_cloud(path);
  EXPECT_EQ(again.positions, three_points().positions);
  EXPECT_TRUE(again.normals.empty() && again.views.empty() && again.colours.empty());
}

// What we write is read by an independent reader, CGAL's.
TEST(CloudIo, IsReadByCgal) {
  using Kernel = CGAL::Simple_cartesian<float>;
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.ply";
  const CloudFile cloud = three_points();
  write_cloud(path, cloud);
  using Read = std::tuple<Kernel::Point_3, Kernel::Vector_3, std::uint32_t, std::uint8_t>;
  std::vector<Read> points;
  std::ifstream stream(path, std::ios::binary);
  ASSERT_TRUE(CGAL::IO::read_PLY_with_properties(
      stream, std::back_inserter(points),
      CGAL::make_ply_point_reader(CGAL::Nth_of_tuple_property_map<0, Read>()),
      CGAL::make_ply_normal_reader(CGAL::Nth_of_tuple_property_map<1, Read>()),
      std::make_pair(CGAL::Nth_of_tuple_property_map<2, Read>(),
                     CGAL::PLY_property<std::uint32_t>("view")),
      std::make_pair(CGAL::Nth_of_tuple_property_map<3, Read>(),
                     CGAL::PLY_property<std::uint8_t>("green"))));
  ASSERT_EQ(points.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto& [point, normal, view, green] = points[i];
    EXPECT_EQ(Vector3f(point.x(), point.y(), point.z()), cloud.positions[i]);
    EXPECT_EQ(Vector3f(normal.x(), normal.y(), normal.z()), cloud.normals[i]);
    EXPECT_EQ(view, cloud.views[i]);
    EXPECT_EQ(green, cloud.colours[i][1]);
  }
}

TEST(CloudIo, ReadsOtherPropertyOrdersTypesAndTheVerticesOfAMesh) {
  const TemporaryFolder folder;
  const CloudFile cloud = read_cloud(
      folder.file("a.ply",
                  "ply\nformat ascii 1.0\nelement vertex 2\nproperty double z\nproperty int x\n"
                  "property float y\nproperty uchar intensity\nelement face 1\n"
                  "property list uchar int vertex_indices\nend_header\n3 1 2 9\n6 4 5 9\n2 0 1\n"));
  EXPECT_THAT(cloud.positions, testing::ElementsAre(Vector3f(1, 2, 3), Vector3f(4, 5, 6)));
}

TEST(CloudIo, ReadsTextColumns) {
  const TemporaryFolder folder;
  const CloudFile cloud =
      read_cloud(folder.file("a.xyz", "# x y z i\n1 2 3 99\r\n\n  4\t5 6\n-1e1 +2 .5"));
  EXPECT_THAT(cloud.positions,
              testing::ElementsAre(Vector3f(1, 2, 3), Vector3f(4, 5, 6), Vector3f(-10, 2, 0.5F)));
}

TEST(CloudIo, SaysWhatIsWrongWithAFile) {
  const TemporaryFolder folder;
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\n"
      "property double y\nproperty double z\n";
  const struct {
    std::string name, bytes, message;
  } cases[] = {
      {"empty.xyz", "", "holds no points"},
      {"empty.ply",
       "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
       "property float z\nend_header\n",
       "holds no points"},
      {"word.xyz", "1 2 3\n1 two 3\n", "line 2: 'two' stands where a coordinate is expected"},
      {"short.xyz", "1 2\n", "line 1: ends where a coordinate is expected"},
      {"nan.ply", head + "end_header\n0 nan 0\n", "point 0 has a coordinate that is not a finite"},
      {"far.ply", head + "end_header\n0 4512345.5 0\n", "coordinates must be local"},
      {"view.ply", head + "property float view\nend_header\n0 0 0 1.5\n",
       "point 0 has the view 1.5"},
      {"faces.ply", "ply\nformat ascii 1.0\nelement face 0\nproperty int a\nend_header\n",
       "there is no element 'vertex'"},
      {"cloud.las", "LASF", "a cloud file must end in .ply, .xyz, .txt or .asc"},
  };
  for (const auto& broken : cases) {
    EXPECT_THAT([&] { read_cloud(folder.file(broken.name, broken.bytes)); },
                testing::ThrowsMessage<Error>(HasSubstr(broken.message)))
        << broken.name;
  }
}

}  // namespace
}  // namespace skycap::geometry
