#include "geometry/io/cloud_io.h"

#include <cstring>
#include <limits>
#include <string>

#include <CGAL/IO/read_ply_points.h>
#include <CGAL/Simple_cartesian.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/cloud_sample.h"
#include "geometry/io/file.h"
#include "tests/support/temporary_folder.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3f;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::TemporaryFolder;

AttributedCloud three_points() {
  return {{{1.5F, 2, -3}, {0.1F, 0, 0}, {4, 5, 6}},
          {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}},
          {0, 7, 4294967295U},
          {{255, 0, 1}, {2, 3, 4}, {5, 6, 7}}};
}

TEST(CloudIo, RoundTripsAllAttributes) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.ply";
  const AttributedCloud cloud = three_points();
  write_cloud(path, make_columns(cloud));
  const AttributedCloud again = read_cloud(path);
  EXPECT_EQ(again.positions, cloud.positions);
  EXPECT_EQ(again.normals, cloud.normals);
  EXPECT_EQ(again.views, cloud.views);
  EXPECT_EQ(again.colours, cloud.colours);
}

TEST(CloudIo, DetectsFormatByExtensionInAnyCase) {
  const TemporaryFolder folder;
  const AttributedCloud cloud = three_points();
  write_cloud(folder.path() / "cloud.ply", make_columns(cloud));
  std::filesystem::rename(folder.path() / "cloud.ply", folder.path() / "CLOUD.PLY");
  EXPECT_EQ(read_cloud(folder.path() / "CLOUD.PLY").positions, cloud.positions);
  EXPECT_EQ(lower_extension("A.B.Las"), ".las");
  EXPECT_EQ(lower_extension("a.LAZ.GZ"), ".laz");
  EXPECT_EQ(lower_extension("folder.d/a"), "");
}

TEST(CloudIo, KeepsAbsentAttributesAbsent) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.ply";
  const AttributedCloud cloud = three_points();
  write_cloud(path, {.positions = cloud.positions});
  const AttributedCloud again = read_cloud(path);
  EXPECT_EQ(again.positions, three_points().positions);
  EXPECT_TRUE(again.normals.empty() && again.views.empty() && again.colours.empty());
}

// CGAL, an independent reader, reads the written files.
TEST(CloudIo, WritesFilesThatCgalReads) {
  using Kernel = CGAL::Simple_cartesian<float>;
  const TemporaryFolder folder;
  const auto path = folder.path() / "cloud.ply";
  const AttributedCloud cloud = three_points();
  write_cloud(path, make_columns(cloud));
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

TEST(CloudIo, ReadsAnyPropertyOrderAndTypeAndMeshVertices) {
  const TemporaryFolder folder;
  const AttributedCloud cloud = read_cloud(
      folder.file("a.ply",
                  "ply\nformat ascii 1.0\nelement vertex 2\nproperty double z\nproperty int x\n"
                  "property float y\nproperty uchar intensity\nelement face 1\n"
                  "property list uchar int vertex_indices\nend_header\n3 1 2 9\n6 4 5 9\n2 0 1\n"));
  EXPECT_THAT(cloud.positions, testing::ElementsAre(Vector3f(1, 2, 3), Vector3f(4, 5, 6)));
}

TEST(CloudIo, ReadsTextColumns) {
  const TemporaryFolder folder;
  const AttributedCloud cloud =
      read_cloud(folder.file("a.xyz", "# x y z i\n1 2 3 99\r\n\n  4\t5 6\n-1e1 +2 .5"));
  EXPECT_THAT(cloud.positions,
              testing::ElementsAre(Vector3f(1, 2, 3), Vector3f(4, 5, 6), Vector3f(-10, 2, 0.5F)));
}

TEST(CloudIo, ReadsPcdTextWithFieldsInAnyOrder) {
  const TemporaryFolder folder;
  const AttributedCloud cloud = read_cloud(folder.file(
      "a.pcd",
      "# .PCD v0.7\nVERSION 0.7\nFIELDS z rgb y x histogram normal_x normal_y normal_z\n"
      "SIZE 4 4 8 4 4 4 4 4\nTYPE F U F I F F F F\nCOUNT 1 1 1 1 2 1 1 1\nWIDTH 3\nHEIGHT 1\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA ascii\n3 77 2 1 9 9 0 0 1\n"
      "nan 77 2 1 9 9 0 0 1\n-6.5 77 5 4 9 9 1 0 0\n"));
  EXPECT_THAT(cloud.positions, testing::ElementsAre(Vector3f(1, 2, 3), Vector3f(4, 5, -6.5F)));
  EXPECT_THAT(cloud.normals, testing::ElementsAre(Vector3f(0, 0, 1), Vector3f(1, 0, 0)));
}

/// Returns the bytes of a LAS 1.4 file with this point format. All points are at (1.5, -2, 3).
std::string las_bytes(int format, std::size_t points, std::size_t declared) {
  const std::size_t point_size = format == 7 ? 36 : 30;
  std::string bytes(375 + points * point_size, '\0');
  const auto put = [&](std::size_t offset, auto value) {
    std::memcpy(bytes.data() + offset, &value, sizeof value);
  };
  bytes.replace(0, 4, "LASF");
  put(24, std::uint8_t{1});
  put(25, std::uint8_t{4});
  put(96, std::uint32_t{375});
  put(104, static_cast<std::uint8_t>(format));
  put(105, static_cast<std::uint16_t>(point_size));
  for (std::size_t axis = 0; axis < 3; ++axis) put(131 + 8 * axis, 0.5);
  put(155, 1.0);  // x offset
  put(247, static_cast<std::uint64_t>(declared));
  for (std::size_t i = 0; i < points; ++i) {
    const std::size_t offset = 375 + i * point_size;
    put(offset, std::int32_t{1});
    put(offset + 4, std::int32_t{-4});
    put(offset + 8, std::int32_t{6});
    if (format == 7) put(offset + 32, std::uint16_t{0xAB12});
  }
  return bytes;
}

TEST(CloudIo, ReadsLasPointsWithScaleAndOffset) {
  const TemporaryFolder folder;
  std::string bytes = las_bytes(7, 3, 3);
  bytes[375 + 36 + 15] = 4;  // the second point has the withheld flag
  const AttributedCloud cloud = read_cloud(folder.file("a.las", bytes));
  EXPECT_THAT(cloud.positions, testing::ElementsAre(Vector3f(1.5F, -2, 3), Vector3f(1.5F, -2, 3)));
  ASSERT_EQ(cloud.colours.size(), 2U);
  EXPECT_THAT(cloud.colours[0], testing::ElementsAre(0, 0xAB, 0));
  EXPECT_TRUE(read_cloud(folder.file("b.las", las_bytes(6, 1, 1))).colours.empty());
}

TEST(CloudIo, SamplesLasPointsWithLargeCoordinates) {
  const TemporaryFolder folder;
  std::string bytes = las_bytes(6, 9000, 9000);
  constexpr double offset = 691'000.0;
  std::memcpy(bytes.data() + 155, &offset, sizeof offset);
  const auto path = folder.file("a.las", bytes);
  EXPECT_THROW(read_cloud(path), Error);
  const CloudSample sample = sample_las_cloud(path, 900);
  EXPECT_EQ(sample.of, 9000U);
  EXPECT_NEAR(static_cast<double>(sample.cloud.positions.size()), 900.0, 3.0);
  for (const Vector3f& position : sample.cloud.positions) {
    ASSERT_EQ(position.cast<double>() + sample.offset, Eigen::Vector3d(691'000.5, -2.0, 3.0));
  }
  EXPECT_LT(sample.cloud.positions.front().norm(), 1500.0F);
}

TEST(CloudIo, ReadsAllLasVersionsAndPointFormats) {
  const TemporaryFolder folder;
  const struct {
    int minor, format;
    std::size_t point_size, colours;
  } cases[] = {{0, 0, 20, 0},  {1, 1, 28, 0},  {2, 2, 26, 20}, {2, 3, 34, 28}, {3, 4, 57, 0},
               {3, 5, 63, 28}, {4, 8, 38, 30}, {4, 9, 59, 0},  {4, 10, 67, 30}};
  for (const auto& old : cases) {
    SCOPED_TRACE(old.format);
    const std::size_t header = old.minor == 4 ? 375 : 227;
    std::string bytes = las_bytes(6, 0, 0).substr(0, header) + std::string(old.point_size, '\0');
    const auto put = [&](std::size_t offset, auto value) {
      std::memcpy(bytes.data() + offset, &value, sizeof value);
    };
    put(25, static_cast<std::uint8_t>(old.minor));
    put(96, static_cast<std::uint32_t>(header));
    put(104, static_cast<std::uint8_t>(old.format));
    put(105, static_cast<std::uint16_t>(old.point_size));
    put(107, std::uint32_t{1});
    if (old.minor == 4) put(247, std::uint64_t{1});
    put(header, std::int32_t{1});
    put(header + 4, std::int32_t{-4});
    put(header + 8, std::int32_t{6});
    if (old.colours != 0) put(header + old.colours + 2, std::uint16_t{0xAB12});
    const AttributedCloud cloud = read_cloud(folder.file("a.las", bytes));
    EXPECT_THAT(cloud.positions, testing::ElementsAre(Vector3f(1.5F, -2, 3)));
    ASSERT_EQ(cloud.colours.size(), old.colours == 0 ? 0U : 1U);
    if (old.colours == 0) continue;
    EXPECT_THAT(cloud.colours[0], testing::ElementsAre(0, 0xAB, 0));
  }
}

TEST(CloudIo, ReportsCauseForInvalidLasFiles) {
  const TemporaryFolder folder;
  const auto with = [](std::size_t offset, int value) {
    std::string bytes = las_bytes(6, 2, 2);
    bytes[offset] = static_cast<char>(value);
    return bytes;
  };
  const struct {
    std::string bytes, message;
  } cases[] = {
      {"LASF", "is not a LAS file"},
      {std::string(500, 'x'), "is not a LAS file"},
      {with(25, 5), "is LAS 1.5 with points of format 6; supported: LAS 1.0 to 1.4"},
      {with(104, 11), "is LAS 1.4 with points of format 11; supported: LAS 1.0 to 1.4"},
      {with(104, 0x86), "is compressed (LAZ), but the LAZ record is missing"},
      {with(105, 20), "has points of 20 bytes; those of format 6 have 30"},
      {with(96, 0), "has a point offset inside its header"},
      {with(138, -1), "a coordinate scale or offset"},  // sign and exponent of the x scale
      {las_bytes(6, 2, 5), "ends after 2 of its 5 points"},
      {las_bytes(6, 0, std::size_t{1} << 62), "ends after 0 of its 4611686018427387904 points"},
      {las_bytes(6, 1, 1).substr(0, 200), "ends within the header"},
      {las_bytes(6, 0, 0), "contains no points"},
  };
  for (const auto& broken : cases) {
    EXPECT_THAT([&] { read_cloud(folder.file("cloud.las", broken.bytes)); },
                testing::ThrowsMessage<Error>(
                    testing::AllOf(HasSubstr("cloud.las: "), HasSubstr(broken.message))));
  }
}

TEST(CloudIo, ReportsCauseForInvalidPcdFiles) {
  const TemporaryFolder folder;
  const std::string fields = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n";
  const std::string head = fields + "WIDTH 2\nHEIGHT 1\nPOINTS 2\n";
  const std::string sizes(8, '\1');
  const struct {
    std::string bytes, message;
  } cases[] = {
      {"", "its header has no DATA"},
      {"ply\n", "line 1: 'ply' is not a PCD header keyword"},
      {"FIELDS x y z\nSIZE 4 4\n", "line 2: SIZE has 2 entries for 3 fields"},
      {"FIELDS x y z\nSIZE 4 four 4\n", "line 2: expected a number of SIZE"},
      {"FIELDS x y\nSIZE 4 4\nTYPE F F\nPOINTS 1\nDATA ascii\n1 2\n", "the fields x, y and z"},
      {"FIELDS x\nSIZE 3\nTYPE F\nDATA ascii\n", "'x' has a combination of SIZE, TYPE and COUNT"},
      {fields + "DATA ascii\n1 2 3\n", "neither POINTS nor WIDTH and HEIGHT"},
      {head + "DATA zipped\n", "DATA is 'zipped'; it must be ascii, binary or"},
      {head + "DATA ascii\n1 2 3\n", "ends after 1 of its 2 points"},
      {head + "DATA ascii\n1 2 3\n1 2\n", "line 10: ends where z is expected"},
      {head + "DATA ascii\n1 nan 3\n1 2 inf\n",
       "contains no valid points; 2 points are NaN or infinite"},
      {head + "DATA ascii\n1 2 3\n1 2 1e9\n", "coordinates must be local"},
      {head + "DATA binary\n" + std::string(13, '\0'), "ends after 1 of its 2 points"},
      {head + "DATA binary_compressed\n1234", "ends before its compressed data"},
      {head + "DATA binary_compressed\n" + sizes, "ends within its compressed data"},
      {head + "DATA binary_compressed\n" + std::string("\2\0\0\0\30\0\0\0\40\5", 10),
       "damaged compressed data"},  // a copy from before the beginning of the output
  };
  for (const auto& broken : cases) {
    EXPECT_THAT([&] { read_cloud(folder.file("cloud.pcd", broken.bytes)); },
                testing::ThrowsMessage<Error>(
                    testing::AllOf(HasSubstr("cloud.pcd: "), HasSubstr(broken.message))));
  }
}

TEST(CloudIo, ReportsCauseForInvalidPlyAndTextFiles) {
  const TemporaryFolder folder;
  const std::string head =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty double x\n"
      "property double y\nproperty double z\n";
  const struct {
    std::string name, bytes, message;
  } cases[] = {
      {"empty.xyz", "", "contains no points"},
      {"empty.ply",
       "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
       "property float z\nend_header\n",
       "contains no points"},
      {"word.xyz", "1 2 3\n1 two 3\n", "line 2: expected a coordinate, found 'two'"},
      {"short.xyz", "1 2\n", "line 1: ends where a coordinate is expected"},
      {"zero.xyz", std::string(50, '\0'),
       "line 1: expected a coordinate, found '" + std::string(40, ' ') + "'"},
      {"long.xyz", std::string(100'000, '1'), "line 1: is longer than 64 KiB"},
      {"nan.ply", head + "end_header\n0 nan 0\n",
       "contains no valid points; 1 points are NaN or infinite"},
      {"far.ply", head + "end_header\n0 4512345.5 0\n", "coordinates must be local"},
      {"view.ply", head + "property float view\nend_header\n0 0 0 1.5\n",
       "point 0 has the view 1.5"},
      {"faces.ply", "ply\nformat ascii 1.0\nelement face 0\nproperty int a\nend_header\n",
       "missing element 'vertex'"},
      {"cloud.doc", "ASTM",
       "a cloud file must end in .ply, .pcd, .las, .laz, .e57, .xyz, .txt, .asc, .pts or "
       ".csv"},
  };
  for (const auto& broken : cases) {
    EXPECT_THAT([&] { read_cloud(folder.file(broken.name, broken.bytes)); },
                testing::ThrowsMessage<Error>(HasSubstr(broken.message)))
        << broken.name;
  }
}

// Both readers skip withheld points.
TEST(ReadPositions, MatchesReadCloudForLasFiles) {
  const TemporaryFolder folder;
  std::string bytes = las_bytes(6, 5, 5);
  bytes[375 + 2 * 30 + 15] = 4;
  const auto path = folder.file("a.las", bytes);
  std::vector<Eigen::Vector3f> positions;
  read_positions(path, [&](std::span<const Eigen::Vector3f> chunk, double share) {
    positions.insert(positions.end(), chunk.begin(), chunk.end());
    EXPECT_EQ(share, 1.0);
  });
  EXPECT_EQ(positions.size(), 4U);
  EXPECT_EQ(positions, read_cloud(path).positions);
}

// The cloud arrives in two chunks, in order. The reported fraction of the file grows to 1.
TEST(ReadPositions, PassesCloudInChunks) {
  const TemporaryFolder folder;
  AttributedCloud cloud;
  for (int i = 0; i < 1'200'000; ++i) cloud.positions.emplace_back(0.001F * float(i), 0.0F, 1.0F);
  write_cloud(folder.path() / "long.ply", make_columns(cloud));
  std::vector<Eigen::Vector3f> positions;
  std::vector<double> shares;
  read_positions(folder.path() / "long.ply",
                 [&](std::span<const Eigen::Vector3f> chunk, double share) {
                   positions.insert(positions.end(), chunk.begin(), chunk.end());
                   shares.push_back(share);
                 });
  EXPECT_EQ(positions, cloud.positions);
  ASSERT_EQ(shares.size(), 2U);
  EXPECT_NEAR(shares[0], 1.0 / 1.2, 1e-12);
  EXPECT_EQ(shares[1], 1.0);
}

TEST(ReadPositions, PassesTextInChunks) {
  const TemporaryFolder folder;
  std::string text = "# x y z\n";
  for (int i = 0; i < 1'200'000; ++i) text += "1 2 3\n";
  std::vector<std::size_t> sizes;
  std::vector<double> shares;
  read_positions(folder.file("long.xyz", text),
                 [&](std::span<const Eigen::Vector3f> chunk, double share) {
                   EXPECT_EQ(chunk.back(), Eigen::Vector3f(1, 2, 3));
                   sizes.push_back(chunk.size());
                   shares.push_back(share);
                 });
  EXPECT_THAT(sizes, ElementsAre(1'000'000, 200'000));
  EXPECT_NEAR(shares[0], 1.0 / 1.2, 1e-5);  // except for the comment
  EXPECT_EQ(shares[1], 1.0);
}

TEST(ReadPositions, CountsPointsAcrossChunks) {
  const TemporaryFolder folder;
  AttributedCloud cloud;
  cloud.positions.assign(1'200'000, Vector3f::Zero());
  cloud.positions[5].x() = std::numeric_limits<float>::infinity();
  cloud.positions[1'100'000].y() = std::numeric_limits<float>::quiet_NaN();
  write_cloud(folder.path() / "long.ply", make_columns(cloud));
  EXPECT_EQ(read_positions(folder.path() / "long.ply", [](auto&&...) {}), 2U);
  cloud.positions[1'100'001].y() = 20'000.0F;
  write_cloud(folder.path() / "far.ply", make_columns(cloud));
  EXPECT_THAT([&] { read_positions(folder.path() / "far.ply", [](auto&&...) {}); },
              testing::ThrowsMessage<Error>(HasSubstr("point 1100001 is 20000")));
}

}  // namespace
}  // namespace skycap::geometry
