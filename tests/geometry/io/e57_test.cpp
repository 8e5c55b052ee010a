// Reads E57 files that tests/support/e57_bytes.h creates from known values.

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "geometry/io/cloud_io.h"
#include "tests/geometry/io/e57_reading.h"

namespace skycap::geometry {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using testing::ElementsAre;
using testing::HasSubstr;
using namespace testing_support;

TEST_F(E57, ReadsExactCoordinates) {
  EXPECT_THAT(read(make_e57_from_points(three_points)).positions,
              ElementsAre(Vector3d(1, 2, 3), Vector3d(-4.5, 1e-3, 6), Vector3d(0.1, 0.2, 1e4)));
}

// Bit widths from 0 to 64. Packets end within values, and a stream with this width is between two
// streams with other widths.
TEST_F(E57, ReadsIntegersOfAnyBitWidth) {
  std::mt19937_64 random(1);
  for (unsigned bits = 0; bits <= 64; ++bits) {
    const std::uint64_t span = bits == 0 ? 0 : ~std::uint64_t{0} >> (64 - bits);
    const std::int64_t min = bits == 64 ? std::numeric_limits<std::int64_t>::min()
                                        : -static_cast<std::int64_t>(span / 3);
    std::vector<std::int64_t> y;
    for (int i = 0; i < 201; ++i) {
      const std::uint64_t above = i == 0 ? 0 : i == 1 ? span : random() & span;
      y.push_back(static_cast<std::int64_t>(static_cast<std::uint64_t>(min) + above));
    }
    const auto max = static_cast<std::int64_t>(static_cast<std::uint64_t>(min) + span);
    E57Scan scan;
    scan.streams = {e57_integers("cartesianX", 0, 4, std::vector<std::int64_t>(201, 3)),
                    e57_integers("cartesianY", min, max, y),
                    e57_singles("cartesianZ", std::vector<float>(201, 0.5F))};
    scan.records = 201;
    for (scan.packets = 1; scan.packets < 12; scan.packets += 5) {
      const std::vector<Vector3d> positions = read(make_e57({scan})).positions;
      ASSERT_EQ(positions.size(), 201U) << bits;
      for (std::size_t i = 0; i < 201; ++i) {
        ASSERT_EQ(positions[i], Vector3d(3, static_cast<double>(y[i]), 0.5)) << bits << ", " << i;
      }
    }
  }
}

// Integers without a minimum or maximum have 64 bits.
TEST_F(E57, ReadsIntegersWithoutRangeAsSixtyFourBits) {
  E57Stream x{"<cartesianX type=\"Integer\"/>", {}};
  x.add(static_cast<std::uint64_t>(-7) + (std::uint64_t{1} << 63), 64);
  const E57Scan scan{{x, e57_doubles("cartesianY", {8.0}), e57_doubles("cartesianZ", {9.0})}, 1};
  EXPECT_THAT(read(make_e57({scan})).positions, ElementsAre(Vector3d(-7, 8, 9)));
}

TEST_F(E57, ReadsScaledIntegersWithScaleAndOffset) {
  const auto axis = [](const std::string& name, const std::string& more) {
    return e57_integers(name, -500, 500, {-500, 7, 500}, "ScaledInteger", more);
  };
  const E57Scan scan{{axis("cartesianX", "scale=\"0.25\""),
                      axis("cartesianY", "scale=\"5.0000000000000000e-001\" offset=\"1000\""),
                      axis("cartesianZ", "")},
                     3};
  EXPECT_THAT(
      read(make_e57({scan})).positions,
      ElementsAre(Vector3d(-125, 750, -500), Vector3d(1.75, 1003.5, 7), Vector3d(125, 1250, 500)));
}

// Range, azimuth from x to y, elevation from that plane to z.
TEST_F(E57, ConvertsSphericalToCartesianCoordinates) {
  const double quarter = std::acos(0.0);
  const E57Scan scan{{e57_doubles("sphericalAzimuth", {0, quarter, 0.3, -2 * quarter}),
                      e57_doubles("sphericalElevation", {0, 0, quarter, -quarter / 2}),
                      e57_doubles("sphericalRange", {2, 3, 4, std::sqrt(2.0)})},
                     4};
  const std::vector<Vector3d> expected{{2, 0, 0}, {0, 3, 0}, {0, 0, 4}, {-1, 0, -1}};
  const std::vector<Vector3d> positions = read(make_e57({scan})).positions;
  ASSERT_EQ(positions.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT((positions[i] - expected[i]).norm(), 1e-15 * 4) << i;
  }
}

TEST_F(E57, PrefersCartesianToSphericalCoordinates) {
  E57Scan scan{{e57_doubles("sphericalRange", {9}), e57_doubles("sphericalAzimuth", {9}),
                e57_doubles("sphericalElevation", {9}), e57_doubles("cartesianZ", {3}),
                e57_doubles("cartesianY", {2}), e57_doubles("cartesianX", {1}),
                e57_integers("sphericalInvalidState", 0, 2, {2})},
               1};
  EXPECT_THAT(read(make_e57({scan})).positions, ElementsAre(Vector3d(1, 2, 3)));
}

// State 1: direction without a range. State 2: invalid. Some scanners write NaN.
TEST_F(E57, SkipsInvalidPoints) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const bool is_spherical : {false, true}) {
    const std::string kind = is_spherical ? "spherical" : "cartesian";
    E57Scan scan{{e57_doubles(kind + (is_spherical ? "Azimuth" : "Y"), {0, 0, 0, 0, 0}),
                  e57_doubles(kind + (is_spherical ? "Range" : "X"), {1, 2, 3, nan, 5}),
                  e57_doubles(kind + (is_spherical ? "Elevation" : "Z"), {0, 0, 0, 0, 0}),
                  e57_integers(kind + "InvalidState", 0, 2, {0, 1, 2, 0, 0})},
                 5};
    EXPECT_THAT(read(make_e57({scan})).positions, ElementsAre(Vector3d(1, 0, 0), Vector3d(5, 0, 0)))
        << kind;
  }
}

E57Scan make_single_point_scan(double x, double y, double z, const std::string& more) {
  return {{e57_doubles("cartesianX", {x}), e57_doubles("cartesianY", {y}),
           e57_doubles("cartesianZ", {z})},
          1,
          more};
}

// Rotation by 90° about z, by 180° about x, translation only, and no pose.
TEST_F(E57, AppliesScanPoses) {
  const std::string half_root = "0.70710678118654752";
  const Read all = read(make_e57(
      {make_single_point_scan(1, 0, 0, make_pose(half_root + " 0 0 " + half_root, "10 20 30")),
       make_single_point_scan(0, 1, 2, make_pose("0 1 0 0", "")),
       make_single_point_scan(1, 1, 1, make_pose("", "4 0 -6e1")),
       make_single_point_scan(5, 5, 5, "")}));
  const std::vector<Vector3d> expected{{10, 21, 30}, {0, -1, -2}, {5, 1, -59}, {5, 5, 5}};
  ASSERT_EQ(all.positions.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_LT((all.positions[i] - expected[i]).norm(), 1e-14) << i;
  }
  EXPECT_THAT(all.scans, ElementsAre(0, 1, 2, 3));
}

TEST_F(E57, SkipsScansWithoutPoints) {
  E57Scan empty = make_single_point_scan(0, 0, 0, "");
  empty.records = 0;
  const Read all = read(make_e57({empty, make_single_point_scan(1, 2, 3, ""), empty}));
  EXPECT_THAT(all.positions, ElementsAre(Vector3d(1, 2, 3)));
  EXPECT_THAT(all.scans, ElementsAre(0));
  EXPECT_TRUE(read(make_e57({empty})).positions.empty());
  EXPECT_TRUE(read(make_e57({})).positions.empty());
}

// Packets begin and end anywhere in pages. Index packets and unused space may be between them.
TEST_F(E57, ReadsPacketsAcrossPages) {
  constexpr int count = 5000;
  std::vector<double> x;
  std::vector<std::int64_t> y;
  std::vector<float> z;
  for (int i = 0; i < count; ++i) {
    x.push_back(0.1 * i);
    y.push_back(i * 7919 % 5000);
    z.push_back(static_cast<float>(i));
  }
  E57Scan scan{{e57_doubles("cartesianX", x), e57_integers("cartesianY", 0, 4999, y),
                e57_singles("cartesianZ", z)},
               count};
  for (const std::size_t packets : {2U, 13U, 97U, 4999U}) {
    for (const bool has_others : {false, true}) {
      scan.packets = packets;
      scan.has_others = has_others;
      const std::string bytes = make_e57({scan});
      for (const std::size_t max : {333UL, 1UL << 16}) {
        const std::vector<Vector3d> positions = read(bytes, max).positions;
        ASSERT_EQ(positions.size(), count);
        for (std::size_t i = 0; i < count; ++i) {
          ASSERT_EQ(positions[i],
                    Vector3d(x[i], static_cast<double>(y[i]), static_cast<double>(z[i])));
        }
      }
    }
  }
}

// Strings have no fixed length. Coordinates of an extension are not those of the point.
TEST_F(E57, IgnoresOtherFields) {
  E57Scan scan = make_single_point_scan(1, 2, 3, "");
  E57Stream text{"<name type=\"String\"/>", {}};
  for (const char c : std::string("\x0A"
                                  "house"))
    text.add(static_cast<std::uint8_t>(c), 8);
  scan.streams.insert(scan.streams.begin(), text);
  scan.streams.insert(scan.streams.begin() + 2, e57_doubles("ext:cartesianY", {7}));
  scan.streams.push_back(e57_integers("intensity", 0, 4095, {77}));
  EXPECT_THAT(read(make_e57({scan})).positions, ElementsAre(Vector3d(1, 2, 3)));
}

std::vector<E57Stream> make_colours(std::int64_t max, std::int64_t red, std::int64_t green,
                                    std::int64_t blue) {
  return {e57_integers("colorRed", 0, max, {red}), e57_integers("colorGreen", 0, max, {green}),
          e57_integers("colorBlue", 0, max, {blue})};
}

TEST_F(E57, ScalesColoursFromMinToMax) {
  const auto colour = [&](const std::vector<E57Stream>& streams, const std::string& more) {
    E57Scan scan = make_single_point_scan(1, 2, 3, more);
    scan.streams.insert(scan.streams.end(), streams.begin(), streams.end());
    return read(make_e57({scan})).colours;
  };
  using Colour = std::array<std::uint8_t, 3>;
  EXPECT_THAT(colour(make_colours(255, 0, 77, 255), ""), ElementsAre(Colour{0, 77, 255}));
  EXPECT_THAT(colour(make_colours(65535, 0, 257, 65535), ""), ElementsAre(Colour{0, 1, 255}));
  std::string limits = "<colorLimits type=\"Structure\">";
  for (const std::string name : {"Red", "Green", "Blue"}) {
    limits += "<color" + name + "Minimum type=\"Integer\"/><color" + name +
              "Maximum type=\"Integer\">255</color" + name + "Maximum>";
  }
  EXPECT_THAT(colour(make_colours(65535, 0, 77, 300), limits + "</colorLimits>"),
              ElementsAre(Colour{0, 77, 255}));
  EXPECT_THAT(colour({e57_singles("colorRed", {0.5F}), e57_singles("colorGreen", {NAN}),
                      e57_singles("colorBlue", {1.0F})},
                     ""),
              ElementsAre(Colour{128, 0, 255}));
}

// Attributes that are missing in one scan are discarded for all.
TEST_F(E57, ReadsOnlyAttributesOfAllScans) {
  E57Scan coloured = make_single_point_scan(1, 2, 3, ""),
          turned = make_single_point_scan(1, 2, 3, make_pose("0 0 0 1", ""));
  for (E57Scan* scan : {&coloured, &turned}) {
    for (const auto& [name, value] : {std::pair("X", 0.6F), {"Y", 0.0F}, {"Z", 0.8F}}) {
      scan->streams.push_back(e57_singles(std::string("nor:normal") + name, {value}));
    }
  }
  for (const E57Stream& stream : make_colours(255, 1, 2, 3)) coloured.streams.push_back(stream);
  const Read all = read(make_e57({coloured, turned}));
  EXPECT_TRUE(all.colours.empty());
  EXPECT_THAT(all.normals, ElementsAre(Vector3f(0.6F, 0, 0.8F), Vector3f(-0.6F, 0, 0.8F)));
}

TEST_F(E57, ReadsCloudWithOneViewPerScan) {
  const auto path = folder_.file("two.e57", make_e57({make_single_point_scan(1, 2, 3, ""),
                                                      make_single_point_scan(4, 5, 6, "")}));
  const AttributedCloud cloud = read_cloud(path);
  EXPECT_THAT(cloud.positions, ElementsAre(Vector3f(1, 2, 3), Vector3f(4, 5, 6)));
  EXPECT_THAT(cloud.views, ElementsAre(0, 1));
  EXPECT_TRUE(read_cloud(folder_.file("a.e57", make_e57_from_points(three_points))).views.empty());
  std::vector<Vector3f> positions;
  double last = 0.0;
  read_positions(path, [&](std::span<const Vector3f> chunk, double share) {
    positions.insert(positions.end(), chunk.begin(), chunk.end());
    last = share;
  });
  EXPECT_EQ(positions, cloud.positions);
  EXPECT_EQ(last, 1.0);
  const auto none = folder_.file("none.e57", make_e57({}));
  EXPECT_THAT([&] { read_cloud(none); }, testing::ThrowsMessage<Error>(HasSubstr("no points")));
  EXPECT_THAT([&] { read_positions(none, [](auto, double) {}); },
              testing::ThrowsMessage<Error>(HasSubstr("no points")));
}

TEST_F(E57, ReadsGzipFiles) {
  const std::string path = folder_.path() / "a.e57.gz", bytes = make_e57_from_points(three_points);
  const gzFile file = gzopen(path.c_str(), "wb");
  gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size()));
  gzclose(file);
  EXPECT_EQ(read_cloud(path).positions.size(), 3U);
}

TEST_F(E57, ReadsReferenceSystem) {
  const auto path = folder_.file(
      "a.e57",
      make_e57_from_points(three_points,
                           "<coordinateMetadata type=\"String\"><![CDATA[ PROJCS[\"a < b\"] "
                           "]]></coordinateMetadata>"));
  EXPECT_EQ(E57Reader(path).reference_system(), "PROJCS[\"a < b\"]");
  EXPECT_EQ(E57Reader(path).points(), 3U);
}

}  // namespace
}  // namespace skycap::geometry
