// Google Earth's polygons, lines and points: extrude, altitude modes, and KMZ.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "geometry/error.h"
#include "missions/site_data/prior.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using testing::Contains;
using testing::HasSubstr;

using Change = std::function<void(Source&)>;

class ForeignKml : public testing::Test {
 protected:
  Prior read(const std::string& name, const std::string& text, const Change& change = {},
             const TerrainHeight& terrain = {}) {
    Source source;
    source.file = folder_.file(name, text);
    if (change) change(source);
    return read_prior(source, {.origin = flight::GeodeticPoint{48.0, 9.0, 500.0}, .ground_z = 0.0},
                      terrain);
  }
  testing_support::TemporaryFolder folder_;
};

std::string placemark(const std::string& geometry) {
  return "<?xml version=\"1.0\"?><kml xmlns=\"http://www.opengis.net/kml/2.2\" "
         "xmlns:gx=\"http://www.google.com/kml/ext/2.2\"><Document><Placemark><name>hall</name>" +
         geometry + "</Placemark></Document></kml>";
}

std::string corners(double altitude) {
  std::string text;
  for (const char* position : {"9,48,", "9.0002,48,", "9.0002,48.0002,", "9,48.0002,", "9,48,"}) {
    text += position + std::to_string(altitude) + " ";
  }
  return "<coordinates>" + text + "</coordinates>";
}

std::string polygon(const std::string& mode, double altitude) {
  return "<Polygon>" + mode + "<outerBoundaryIs><LinearRing>" + corners(altitude) +
         "</LinearRing></outerBoundaryIs></Polygon>";
}

const std::string extruded = "<extrude>1</extrude>";
std::string mode(const std::string& name) { return "<altitudeMode>" + name + "</altitudeMode>"; }

/// Returns the KML altitude of a roof 20 m above the origin, which is 520 m above the ellipsoid.
/// KML altitudes are relative to the geoid.
double roof_altitude() { return 520.0 - egm96_undulation(48.0, 9.0); }

TEST_F(ForeignKml, ExtrudesPolygonsToGround) {
  const double roof = roof_altitude();
  const std::string text = placemark(polygon(extruded + mode("absolute"), roof));
  const Prior open = read("a.kml", text);
  ASSERT_EQ(open.objects.size(), 1U);
  EXPECT_EQ(open.objects[0].mesh.triangles.size(), 12U);
  EXPECT_NEAR(open.box.max().z(), 20.0, 0.1);
  EXPECT_NEAR(open.box.min().z(), -100.0, 0.1);
  EXPECT_THAT(open.notes, Contains(HasSubstr("unknown terrain below some polygons")));
  const Prior on_terrain = read("a.kml", text, {}, [](const Eigen::Vector2d&) { return -3.0; });
  EXPECT_NEAR(on_terrain.box.min().z(), -3.0, 1e-6);
  EXPECT_NEAR(on_terrain.box.max().z(), 20.0, 0.1);
  const Prior target = read("a.kml", text, [](Source& s) { s.role = Role::target; });
  EXPECT_NEAR(target.box.min().z(), 0.0, 0.1);
}

TEST_F(ForeignKml, ReadsPolygonsWithoutExtrudeAsSheets) {
  const double roof = roof_altitude();
  const Prior prior = read("a.kml", placemark(polygon(mode("absolute"), roof)));
  EXPECT_NEAR(prior.box.min().z(), 20.0, 0.1);
  EXPECT_NEAR(prior.box.max().z(), 20.0, 0.1);
}

TEST_F(ForeignKml, ReadsHeightsAboveGroundAsSolids) {
  const auto based = [](Source& s) {
    s.base = 500.0;
    s.vertical = HeightDatum::ellipsoid;
  };
  for (const std::string& how :
       {extruded + mode("relativeToGround"), mode("relativeToGround"),
        extruded + "<gx:altitudeMode>relativeToSeaFloor</gx:altitudeMode>"}) {
    const Prior prior = read("a.kml", placemark(polygon(how, 12.0)), based);
    EXPECT_NEAR(prior.box.min().z(), 0.0, 1e-3) << how;
    EXPECT_NEAR(prior.box.max().z(), 12.0, 1e-3) << how;
  }
  EXPECT_THAT(testing_support::thrown_message(
                  [&] { read("a.kml", placemark(polygon(mode("clampToGround"), 12.0)), based); }),
              HasSubstr("contains no height of hall"));
}

TEST_F(ForeignKml, ExtrudesLinesToWallsAndPointsToPoles) {
  const double roof = roof_altitude();
  const std::string line = "<LineString>" + extruded + mode("absolute") + "<coordinates>9,48," +
                           std::to_string(roof) + " 9.0002,48," + std::to_string(roof) +
                           "</coordinates></LineString>";
  const Prior wall = read("a.kml", placemark(line));
  EXPECT_NEAR(wall.box.sizes().x(), 15.43, 0.05);
  EXPECT_NEAR(wall.box.sizes().y(), 0.5, 0.01);
  EXPECT_NEAR(wall.box.sizes().z(), 120.0, 0.2);
  const std::string point = "<Point>" + extruded + mode("absolute") + "<coordinates>9,48," +
                            std::to_string(roof) + "</coordinates></Point>";
  const Prior pole = read("a.kml", placemark(point));
  EXPECT_NEAR(pole.box.sizes().x(), 1.08, 0.01);
  EXPECT_NEAR(pole.box.max().z(), 20.0, 0.1);
}

TEST_F(ForeignKml, ReadsAllPolygonsOfMultiGeometry) {
  const double roof = roof_altitude();
  const std::string text =
      placemark("<MultiGeometry>" + polygon(extruded + mode("absolute"), roof) +
                polygon(extruded + mode("absolute"), roof + 5.0) + "</MultiGeometry>");
  const Prior prior = read("a.kml", text);
  ASSERT_EQ(prior.objects.size(), 1U);
  EXPECT_NEAR(prior.box.max().z(), 25.0, 0.1);
}

/// Returns a zip archive with one uncompressed member.
std::string make_zip(const std::string& name, const std::string& bytes) {
  const auto sum = static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
  const auto number = [](std::uint64_t value, int size) {
    std::string text;
    for (int i = 0; i < size; ++i) text += static_cast<char>(value >> (8 * i) & 0xFF);
    return text;
  };
  const std::string facts = number(20, 2) + number(0, 8) + number(sum, 4) +
                            number(bytes.size(), 4) + number(bytes.size(), 4) +
                            number(name.size(), 2) + number(0, 2);
  const std::string local = "PK\3\4" + facts + name + bytes;
  const std::string central = "PK\1\2" + number(20, 2) + facts + number(0, 2) + number(0, 2) +
                              number(0, 2) + number(0, 4) + number(0, 4) + name;
  return local + central + "PK\5\6" + number(0, 4) + number(1, 2) + number(1, 2) +
         number(central.size(), 4) + number(local.size(), 4) + number(0, 2);
}

TEST_F(ForeignKml, ReadsKmz) {
  const double roof = roof_altitude();
  const std::string text = placemark(polygon(extruded + mode("absolute"), roof));
  const Prior prior = read("hall.kmz", make_zip("doc.kml", text));
  ASSERT_EQ(prior.objects.size(), 1U);
  EXPECT_NEAR(prior.box.max().z(), 20.0, 0.1);
  EXPECT_THAT(testing_support::thrown_message([&] { read("hall.zip", make_zip("doc.kml", text)); }),
              HasSubstr("is a zip archive; unpack it and use the file in it"));
}

}  // namespace
}  // namespace skycap::missions::site_data
