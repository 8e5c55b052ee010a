// Clouds of eight points in the formats of other programs.
#include <cstring>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/io/cloud_io.h"
#include "geometry/io/las/layout.h"
#include "tests/support/complaint.h"
#include "tests/support/e57_bytes.h"
#include "tests/support/temporary_folder.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3f;
using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::TemporaryFolder;

std::vector<Vector3f> corners() {
  std::vector<Vector3f> points;
  for (int i = 0; i < 8; ++i) {
    points.emplace_back((i & 1) != 0 ? 4.5F : 0.0F, (i & 2) != 0 ? 3.0F : 0.0F,
                        (i & 4) != 0 ? 2.0F : 0.0F);
  }
  return points;
}

/// Returns one line for each point. `order` is the order of the coordinate columns.
std::string lines(const std::string& apart, const std::string& after = "",
                  const std::string& order = "xyz", char point = '.') {
  std::string text;
  for (const Vector3f& corner : corners()) {
    std::string line;
    for (const char axis : order) {
      std::string number = std::to_string(corner[axis - 'x']);
      number.replace(number.find('.'), 1, 1, point);
      line += (line.empty() ? "" : apart) + number;
    }
    text += line + after + "\n";
  }
  return text;
}

std::string replaced(std::string text, const std::string& old, const std::string& now) {
  for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old, at)) {
    text.replace(at, old.size(), now);
    at += now.size();
  }
  return text;
}

class ForeignCloud : public testing::Test {
 protected:
  void expect_corners(const std::string& name, const std::string& bytes, std::size_t skipped = 0) {
    try {
      const auto path = folder_.file(name, bytes);
      const AttributedCloud cloud = read_cloud(path);
      EXPECT_EQ(cloud.positions, corners()) << bytes.substr(0, 80);
      EXPECT_EQ(cloud.skipped, skipped) << bytes.substr(0, 80);
      std::vector<Vector3f> positions;
      EXPECT_EQ(read_positions(path,
                               [&](std::span<const Vector3f> chunk, double) {
                                 positions.insert(positions.end(), chunk.begin(), chunk.end());
                               }),
                skipped);
      EXPECT_EQ(positions, corners());
    } catch (const Error& error) {
      ADD_FAILURE() << error.what() << "\n" << bytes.substr(0, 200);
    }
  }
  std::string error_message(const std::string& name, const std::string& bytes) {
    return testing_support::thrown_message([&] { read_cloud(folder_.file(name, bytes)); });
  }
  TemporaryFolder folder_;
};

TEST_F(ForeignCloud, ReadsTextWithByteOrderMarksAndAnyLineEnds) {
  const std::string text = lines(" ", " 7 # a comment");
  expect_corners("a.xyz", text);
  expect_corners("a.xyz", "\xEF\xBB\xBF" + text);
  expect_corners("a.xyz", replaced(text, "\n", "\r"));
  expect_corners("a.xyz", replaced(text, "\n", "\r\n"));
  expect_corners("a.xyz", replaced(text, "\n", "\r\r\n"));
  std::string wide = "\xFE\xFF";
  for (const char c : text) wide += std::string{'\0', c};
  expect_corners("a.xyz", wide);
  EXPECT_THAT(error_message("a.xyz", replaced(lines(" "), "\n", " ")),
              HasSubstr("has 24 numbers on a single line; write one point per line"));
}

TEST_F(ForeignCloud, ReadsTextWithHeadersAndOtherSeparators) {
  expect_corners("a.asc", "//X Y Z\n" + lines(" "));
  expect_corners("a.asc", "# exported with columns x y z below\n" + lines(" "));
  expect_corners("a.xyz", "X Y Z\n" + lines(" "));
  expect_corners("a.xyz", "x\ty\tz\tIntensity\n" + lines("\t", "\t5"));
  expect_corners("a.txt", lines(","));
  expect_corners("a.txt", lines(", ", ", 3"));
  expect_corners("a.txt", lines(" ,"));
  expect_corners("a.txt", lines(" ", " 10,20,30"));
  expect_corners("a.txt", lines(";"));
  expect_corners("a.txt", lines("; ", "", "xyz", ','));
  expect_corners("a.txt", lines(" ", "", "xyz", ','));
  expect_corners("a.csv", "x,y,z\n" + lines(","));
  expect_corners("a.csv", "\"Y [m]\";\"Z [m]\";\"X [m]\"\n" + lines(";", "", "yzx"));
  expect_corners("a.csv", "Easting,Northing,Elevation,name\n" + lines(",", ",\"a\""));
  expect_corners("a.asc", "//Z Y X\n" + lines(" ", "", "zyx"));
  expect_corners("a.pts", "8\n" + lines(" ", " -1200 10 20 30"));
  expect_corners("a.xyz", "8\r\n" + replaced(lines(" "), "\n", "\r\n"));
  const std::string two_scans = lines(" ");
  const std::size_t half = two_scans.size() / 2;
  expect_corners("a.pts", "4\n" + two_scans.substr(0, half) + "4\n" + two_scans.substr(half));
}

TEST_F(ForeignCloud, RejectsInvalidText) {
  EXPECT_THAT(error_message("a.csv", "lat,lon,alt\n1,2,3\n"),
              HasSubstr("line 1: is a header that does not name the columns x, y and z"));
  EXPECT_THAT(error_message("a.pts", "9\n" + lines(" ")),
              HasSubstr("ends after 8 of its 9 points"));
  EXPECT_THAT(error_message("a.xyz", "4\n2\n0 0 0\n"),
              HasSubstr("line 2: contains a second point count"));
  EXPECT_THAT(error_message("a.csv", "1,2\n"),
              HasSubstr("line 1: ends where a coordinate is expected"));
  EXPECT_THAT(error_message("a.csv", "1,2,3\n1,,3\n"),
              HasSubstr("line 2: ends where a coordinate is expected"));
  EXPECT_THAT(error_message("a.xyz", "1 2 3\n1 2,5 3\n"),
              HasSubstr("line 2: '2,5' has a decimal comma"));
}

TEST_F(ForeignCloud, SkipsAndCountsPointsThatAreNotFinite) {
  expect_corners("a.xyz",
                 lines(" ") + "nan nan nan\n0 0 inf\n-nan(ind) 0 0\n0 1.#QNAN 0\n1e999 0 0\n", 5);
  expect_corners("a.csv", lines(",") + "0,0,-Inf\n", 1);
  const std::string pcd = "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 10\nHEIGHT 1\nDATA ascii\n";
  expect_corners("a.pcd", pcd + lines(" ") + "nan nan nan\n0 inf 0\n", 2);
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 9\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n";
  expect_corners("a.ply", ply + "nan 0 0\n" + lines(" "), 1);
  EXPECT_THAT(error_message("a.xyz", "nan nan nan\n"),
              HasSubstr("contains no valid points; 1 points are NaN or infinite"));
}

TEST_F(ForeignCloud, ReadsPcdOfOldVersionsAndWithOtherLineEnds) {
  const std::string pcd =
      "# .PCD v.5\nVERSION .5\nCOLUMNS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 8\n"
      "HEIGHT 1\nPOINTS 8\nDATA ASCII\n" +
      lines(" ");
  expect_corners("a.pcd", pcd);
  expect_corners("a.pcd", "\xEF\xBB\xBF" + pcd);
  expect_corners("a.pcd", replaced(pcd, "\n", "\r"));
}

/// Returns a PLY file whose vertices have one byte and three floats, or colours.
std::string binary_ply(const std::string& properties, const std::string& point_bytes,
                       const std::string& line_end) {
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex 8\n" + properties +
                      "property float x\nproperty float y\nproperty float z\nend_header\n";
  bytes = replaced(bytes, "\n", line_end);
  for (const Vector3f& corner : corners()) {
    bytes += point_bytes;
    bytes.append(reinterpret_cast<const char*>(corner.data()), 12);
  }
  return bytes;
}

// The first data byte equals a line end, but is not part of the header.
TEST_F(ForeignCloud, ReadsBinaryPlyAfterHeaderWithAnyLineEnds) {
  for (const char* line_end : {"\n", "\r\n", "\r"}) {
    expect_corners("a.ply", binary_ply("property uchar q\n", "\n", line_end));
  }
}

TEST_F(ForeignCloud, ScalesColoursByTypeOrIgnoresThem) {
  const auto make_colour = [&](const char* type, auto red, auto green, auto blue) {
    std::string properties, values;
    for (const auto& [name, value] : {std::pair{"red", red}, {"green", green}, {"blue", blue}}) {
      properties += "property " + std::string(type) + " " + name + "\n";
      values.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    const AttributedCloud cloud =
        read_cloud(folder_.file("a.ply", binary_ply(properties, values, "\n")));
    EXPECT_EQ(cloud.positions, corners());
    using Bytes = std::array<std::uint8_t, 3>;
    return cloud.colours.empty() ? std::optional<Bytes>() : cloud.colours.at(7);
  };
  using Colour = std::array<std::uint8_t, 3>;
  EXPECT_EQ(make_colour("uchar", std::uint8_t{200}, std::uint8_t{60}, std::uint8_t{20}),
            (Colour{200, 60, 20}));
  EXPECT_EQ(make_colour("ushort", std::uint16_t{51200}, std::uint16_t{15360}, std::uint16_t{5120}),
            (Colour{200, 60, 20}));
  EXPECT_EQ(make_colour("float", 1.0F, 0.2F, 0.0F), (Colour{255, 51, 0}));
  EXPECT_EQ(make_colour("float", 200.0F, 60.0F, 20.0F), std::nullopt);
  EXPECT_EQ(make_colour("int", 300, 0, 0), std::nullopt);
  EXPECT_EQ(make_colour("int", -1, 0, 0), std::nullopt);
}

/// Returns a LAS 1.4 file with point format 2, a colour, and the point counts of old and new
/// versions.
std::string make_las(std::uint32_t old_count, std::uint64_t count, std::uint16_t scale) {
  const std::size_t size = las::point_size(2);
  std::string bytes(las::header::end + 8 * size, '\0');
  const auto put = [&](std::size_t corner, auto value) {
    std::memcpy(bytes.data() + corner, &value, sizeof value);
  };
  bytes.replace(0, 4, "LASF");
  put(las::header::major, std::uint8_t{1});
  put(las::header::minor, std::uint8_t{4});
  put(las::header::size, static_cast<std::uint16_t>(las::header::end));
  put(las::header::first_point, static_cast<std::uint32_t>(las::header::end));
  put(las::header::point_format, std::uint8_t{2});
  put(las::header::point_size, static_cast<std::uint16_t>(size));
  put(las::header::old_points, old_count);
  put(las::header::points, count);
  for (std::size_t axis = 0; axis < 3; ++axis) put(las::header::scale + 8 * axis, 0.5);
  const std::vector<Vector3f> points = corners();
  for (std::size_t i = 0; i < 8; ++i) {
    const std::size_t corner = las::header::end + i * size;
    for (int axis = 0; axis < 3; ++axis) {
      put(corner + 4UL * axis, static_cast<std::int32_t>(2.0F * points[i][axis]));
    }
    for (std::size_t channel = 0; channel < 3; ++channel) {
      constexpr std::array<int, 3> colour{200, 60, 20};
      put(corner + 20 + 2 * channel, static_cast<std::uint16_t>(colour[channel] * scale));
    }
  }
  return bytes;
}

TEST_F(ForeignCloud, ReadsLasWithOnlyOnePointCount) {
  expect_corners("a.las", make_las(8, 0, 256));
  expect_corners("a.las", make_las(0, 8, 256));
  expect_corners("a.las", make_las(5, 8, 256));  // the new count is used
}

TEST_F(ForeignCloud, ReadsEightBitLasColours) {
  for (const std::uint16_t scale : {std::uint16_t{1}, std::uint16_t{256}}) {
    const AttributedCloud cloud = read_cloud(folder_.file("a.las", make_las(8, 8, scale)));
    EXPECT_THAT(cloud.colours.at(0), ElementsAre(200, 60, 20)) << scale;
  }
}

std::string e57_with(const std::string& rotation, double last_x) {
  testing_support::E57Scan scan;
  scan.records = 2;
  scan.streams = {testing_support::e57_doubles("cartesianX", {1.0, last_x}),
                  testing_support::e57_doubles("cartesianY", {2.0, 0.0}),
                  testing_support::e57_doubles("cartesianZ", {3.0, 0.0})};
  scan.more = "<pose>" + rotation + "<translation><x>10</x></translation></pose>";
  return testing_support::make_e57({scan});
}

TEST_F(ForeignCloud, TreatsZeroE57RotationAsIdentity) {
  const std::string zeros = "<rotation><w>0</w><x>0</x><y>0</y><z>0</z></rotation>";
  for (const std::string& rotation : {std::string(), zeros, std::string("<rotation></rotation>")}) {
    const AttributedCloud cloud = read_cloud(folder_.file("a.e57", e57_with(rotation, 0.0)));
    EXPECT_THAT(cloud.positions, ElementsAre(Vector3f(11, 2, 3), Vector3f(10, 0, 0))) << rotation;
  }
  EXPECT_THAT(error_message("a.e57", e57_with("<rotation><w>2</w></rotation>", 0.0)),
              HasSubstr("quaternion has length 2.000000; it must be 1: save the scan again"));
}

TEST_F(ForeignCloud, SkipsInfinitePointsOfE57) {
  const AttributedCloud cloud =
      read_cloud(folder_.file("a.e57", e57_with("", std::numeric_limits<double>::infinity())));
  EXPECT_THAT(cloud.positions, ElementsAre(Vector3f(11, 2, 3)));
  EXPECT_EQ(cloud.skipped, 1U);
}

}  // namespace
}  // namespace skycap::geometry
