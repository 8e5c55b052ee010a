// Conversions between cloud formats keep all attributes that the target format has.

#include "geometry/io/column_cloud.h"

#include <cmath>
#include <fstream>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::geometry {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing_support::TemporaryFolder;
using testing_support::thrown_message;

constexpr std::array all_columns = {CloudColumn::normal_x,      CloudColumn::normal_y,
                                    CloudColumn::normal_z,      CloudColumn::red,
                                    CloudColumn::green,         CloudColumn::blue,
                                    CloudColumn::intensity,     CloudColumn::classification,
                                    CloudColumn::return_number, CloudColumn::returns};

/// Cloud in UTM coordinates, which need double precision, with all attributes.
ColumnCloud make_cloud(std::size_t count) {
  std::mt19937_64 random(5);
  const auto whole = [&](std::uint64_t below) { return static_cast<float>(random() % below); };
  ColumnCloud cloud;
  cloud.crs_wkt = R"(PROJCRS["test & <more>"])";
  for (std::size_t i = 0; i < count; ++i) {
    const auto tenth = [&](std::uint64_t below) {  // multiples of the finest scale
      return 1e-4 * static_cast<double>(random() % below);
    };
    const double x = tenth(1'000'000), y = tenth(1'000'000), z = tenth(100'000);
    cloud.positions.emplace_back(412'000.0 + x, 5'655'000.0 + y, 300.0 + z);
    cloud.times.push_back(3.2e8 + 1e-6 * static_cast<double>(i));
    for (const CloudColumn name : all_columns) {
      cloud.column(name).push_back(name <= CloudColumn::normal_z    ? whole(2001) / 1000.0F - 1.0F
                                   : name <= CloudColumn::blue      ? 257.0F * whole(256)
                                   : name == CloudColumn::intensity ? whole(65536)
                                   : name == CloudColumn::classification ? whole(256)
                                                                         : 1.0F + whole(15));
    }
  }
  return cloud;
}

void expect_same(const ColumnCloud& found, const ColumnCloud& expected, double tolerance,
                 const std::vector<CloudColumn>& missing) {
  ASSERT_EQ(found.positions.size(), expected.positions.size());
  for (std::size_t i = 0; i < found.positions.size(); ++i) {
    ASSERT_LE((found.positions[i] - expected.positions[i]).cwiseAbs().maxCoeff(), tolerance) << i;
  }
  EXPECT_EQ(found.times, expected.times);
  for (const CloudColumn name : all_columns) {
    SCOPED_TRACE(static_cast<int>(name));
    if (testing::Value(missing, testing::Contains(name))) {
      EXPECT_THAT(found.column(name), IsEmpty());
    } else {
      EXPECT_EQ(found.column(name), expected.column(name));
    }
  }
}

struct FormatCase {
  const char* extension;
  double tolerance;  // of coordinates [m]
  std::vector<CloudColumn> missing;
  bool has_crs;
  std::vector<std::string> lost;
};

class CloudFormat : public testing::TestWithParam<FormatCase> {};

const std::vector<CloudColumn> normals = {CloudColumn::normal_x, CloudColumn::normal_y,
                                          CloudColumn::normal_z};

TEST_P(CloudFormat, KeepsAttributesOfFormat) {
  const auto& [extension, tolerance, missing, has_crs, lost] = GetParam();
  const TemporaryFolder folder;
  for (const std::size_t count : {1U, 2U, 5000U}) {
    SCOPED_TRACE(count);
    const ColumnCloud cloud = make_cloud(count);
    const std::filesystem::path path = folder.path() / ("cloud" + std::string(extension));
    EXPECT_EQ(write_column_cloud(path, cloud), lost);
    const ColumnCloud found = read_column_cloud(path);
    expect_same(found, cloud, tolerance, missing);
    EXPECT_EQ(found.crs_wkt, has_crs ? cloud.crs_wkt : "");
    EXPECT_EQ(found.skipped, 0U);
  }
}

TEST_P(CloudFormat, WritesPlainClouds) {
  const TemporaryFolder folder;
  ColumnCloud cloud;
  cloud.positions = {{0.5, -1.25, 2.0}, {100.0, 0.0, 3.5}};
  const std::filesystem::path path = folder.path() / ("cloud" + std::string(GetParam().extension));
  EXPECT_THAT(write_column_cloud(path, cloud), IsEmpty());
  const ColumnCloud found = read_column_cloud(path);
  ASSERT_EQ(found.positions.size(), 2U);
  EXPECT_LT((found.positions[1] - cloud.positions[1]).norm(), 1e-9);
  EXPECT_FALSE(found.has_normals() || found.has_colours());
  // The readers of the other commands accept the file, too.
  EXPECT_EQ(read_cloud(path).positions.size(), 2U);
}

TEST_P(CloudFormat, WritesSameBytesForSameCloud) {
  const TemporaryFolder folder;
  const std::string name = "cloud" + std::string(GetParam().extension);
  const ColumnCloud cloud = make_cloud(300);
  std::filesystem::create_directory(folder.path() / "a");
  write_column_cloud(folder.path() / name, cloud);
  write_column_cloud(folder.path() / "a" / name, cloud);
  const auto bytes = [](const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  EXPECT_TRUE(bytes(folder.path() / name) == bytes(folder.path() / "a" / name));
}

const std::string no_crs = "the reference system is not kept", no_normals = "normals are not kept";

INSTANTIATE_TEST_SUITE_P(
    Formats, CloudFormat,
    testing::Values(
        FormatCase{".ply", 0.0, {}, false, {no_crs}}, FormatCase{".pcd", 0.0, {}, false, {no_crs}},
        FormatCase{".xyz", 0.0, {}, false, {no_crs}}, FormatCase{".csv", 0.0, {}, false, {no_crs}},
        FormatCase{".e57", 0.0, {CloudColumn::classification}, true, {"classes are not kept"}},
        FormatCase{".las", 1e-9, normals, true, {no_normals}},
        FormatCase{".laz", 1e-9, normals, true, {no_normals}}),
    [](const auto& file) { return std::string(file.param.extension).substr(1); });

TEST(ColumnCloud, ScalesIntensitiesToSixteenBits) {
  const TemporaryFolder folder;
  ColumnCloud cloud;
  cloud.positions.assign(3, Eigen::Vector3d(1.0, 2.0, 3.0));
  const auto written = [&](const std::vector<float>& intensities) {
    cloud.column(CloudColumn::intensity) = intensities;
    const auto lost = write_column_cloud(folder.path() / "a.las", cloud);
    return std::pair(read_column_cloud(folder.path() / "a.las").column(CloudColumn::intensity),
                     lost);
  };
  EXPECT_THAT(written({0.0F, 0.5F, 1.0F}).first, ElementsAre(0.0F, 32768.0F, 65535.0F));
  EXPECT_THAT(written({0.0F, 255.0F, 7.0F}).first, ElementsAre(0.0F, 255.0F, 7.0F));
  const auto [values, lost] = written({-10.0F, 0.0F, 10.0F});
  EXPECT_THAT(values, ElementsAre(0.0F, 32768.0F, 65535.0F));
  EXPECT_THAT(lost, ElementsAre(HasSubstr("are scaled to 0 to 65535")));
  EXPECT_THAT(written({NAN, INFINITY, 3.0F}).first, ElementsAre(0.0F, 65535.0F, 3.0F));
}

TEST(ColumnCloud, StatesRoundingOfCoordinates) {
  const TemporaryFolder folder;
  ColumnCloud cloud;
  cloud.positions = {{0.00003, 0.0, 0.0}, {5'000'000.0, 0.0, 0.0}};
  EXPECT_THAT(write_column_cloud(folder.path() / "a.laz", cloud),
              ElementsAre("coordinates are rounded to 0.01"));
  cloud.positions[1].x() = 1e12;
  EXPECT_THAT(thrown_message([&] { write_column_cloud(folder.path() / "a.laz", cloud); }),
              HasSubstr("which LAS files cannot represent"));
}

TEST(ColumnCloud, ReducesColoursToBytesWithNote) {
  const TemporaryFolder folder;
  ColumnCloud cloud;
  cloud.positions = {{1.0, 2.0, 3.0}};
  for (const CloudColumn name : {CloudColumn::red, CloudColumn::green, CloudColumn::blue}) {
    cloud.column(name) = {1000.0F};
  }
  for (const char* const name : {"a.ply", "a.pcd", "a.e57"}) {
    EXPECT_THAT(write_column_cloud(folder.path() / name, cloud),
                ElementsAre("colours are reduced to 8 bits per channel"));
    EXPECT_THAT(read_column_cloud(folder.path() / name).column(CloudColumn::red),
                ElementsAre(3.0F * 257.0F));
  }
  EXPECT_THAT(write_column_cloud(folder.path() / "a.laz", cloud), IsEmpty());
  EXPECT_THAT(read_column_cloud(folder.path() / "a.laz").column(CloudColumn::red),
              ElementsAre(1000.0F));
}

TEST(ColumnCloud, ReadsNamedColumnsOfOtherPrograms) {
  const TemporaryFolder folder;
  const ColumnCloud text = read_column_cloud(
      folder.file("a.csv",
                  "//X,Y,Z,R,G,B,Intensity,GpsTime,Nx,Ny,Nz\n"
                  "1,2,3,10,20,30,0.5,100.25,0,0,1\n4,5,6,255,0,1,0.7,100.5,1,0,0\n"));
  EXPECT_THAT(text.column(CloudColumn::red), ElementsAre(2570.0F, 65535.0F));
  EXPECT_THAT(text.column(CloudColumn::intensity), ElementsAre(0.5F, 0.7F));
  EXPECT_THAT(text.times, ElementsAre(100.25, 100.5));
  EXPECT_THAT(text.column(CloudColumn::normal_z), ElementsAre(1.0F, 0.0F));
  EXPECT_THAT(text.lost, IsEmpty());
  const ColumnCloud unnamed = read_column_cloud(folder.file("a.xyz", "1 2 3 9 9\n4 5 6 9 9\n"));
  EXPECT_EQ(unnamed.positions.size(), 2U);
  EXPECT_THAT(unnamed.lost, ElementsAre(HasSubstr("2 columns without names are not read")));
  const ColumnCloud ply = read_column_cloud(folder.file(
      "a.ply",
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\n"
      "property double z\nproperty float scalar_Intensity\nproperty double scalar_GpsTime\n"
      "end_header\n500000.125 1 2 7 8\nnan 1 2 3 4\n"));
  EXPECT_THAT(ply.positions, ElementsAre(Eigen::Vector3d(500000.125, 1.0, 2.0)));
  EXPECT_THAT(ply.column(CloudColumn::intensity), ElementsAre(7.0F));
  EXPECT_THAT(ply.times, ElementsAre(8.0));
  EXPECT_EQ(ply.skipped, 1U);
}

TEST(ColumnCloud, StatesUnreadColumns) {
  const TemporaryFolder folder;
  EXPECT_THAT(
      read_column_cloud(folder.file("a.xyz", "x y z channel intensity Ring\n1 2 3 4 5 6\n")).lost,
      ElementsAre("not read: channel, ring"));
  EXPECT_THAT(
      read_column_cloud(folder.file("a.ply",
                                    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                                    "property float y\nproperty float z\nproperty int view\n"
                                    "end_header\n1 2 3 4\n"))
          .lost,
      ElementsAre("not read: view"));
  EXPECT_THAT(read_column_cloud(folder.file("a.csv", "Easting,Northing,Height\n1,2,3\n")).lost,
              IsEmpty());
}

// PCL writes opaque colours, whose bits are those of a NaN if red is 128 or more.
TEST(ColumnCloud, ReadsOpaquePackedColours) {
  const TemporaryFolder folder;
  std::string pcd =
      "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 2\n"
      "HEIGHT 1\nPOINTS 2\nDATA binary\n";
  for (const std::uint32_t packed : {0xFF8140C0U, 0xFF01FF02U}) {
    const std::array<float, 3> position{1.0F, 2.0F, 3.0F};
    pcd.append(reinterpret_cast<const char*>(position.data()), sizeof position);
    pcd.append(reinterpret_cast<const char*>(&packed), sizeof packed);
  }
  const ColumnCloud cloud = read_column_cloud(folder.file("a.pcd", pcd));
  EXPECT_THAT(cloud.column(CloudColumn::red), ElementsAre(257.0F * 0x81, 257.0F));
  EXPECT_THAT(cloud.column(CloudColumn::green), ElementsAre(257.0F * 0x40, 65535.0F));
  EXPECT_THAT(cloud.column(CloudColumn::blue), ElementsAre(257.0F * 0xC0, 257.0F * 2));
}

TEST(ColumnCloud, RejectsHostileFilesWithOneLine) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.ply",
       "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\n"
       "property float x\nproperty float y\nproperty float z\nend_header\n"},
      {"b.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n"},
      {"a.pcd",
       "FIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 9\nHEIGHT 1\n"
       "POINTS 9\nDATA binary\n123"},
      {"b.pcd", "FIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2\n"},
      {"a.xyz", "x y z nx\n1 2 3 zero\n"},
      {"b.xyz", "x y z nx\n1 2 3\n"},
      {"a.las", "LASF"},
      {"a.laz", std::string(400, 'x')},
      {"a.e57", "ASTM-E57"},
      {"a.doc", "1 2 3"}};
  for (const auto& [name, content] : files) {
    const auto file = folder.file(name, content);
    const std::string message = thrown_message([&] { read_column_cloud(file); });
    EXPECT_THAT(message, HasSubstr(name)) << message;
    EXPECT_THAT(message, testing::Not(HasSubstr("\n")));
  }
}

}  // namespace
}  // namespace skycap::geometry
