// Outlines from maps and rasters, and their special cases.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/surfaces/mesh.h"
#include "tests/missions/site_data/cube_files.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::ThrowsMessage;

const flight::GeodeticPoint origin{48.0, 9.0, 500.0};

class Map : public testing::Test {
 protected:
  Prior read(const std::string& name, const std::string& text,
             const std::function<void(Source&)>& change = {}) {
    Source source;
    source.file = folder_.file(name, text);
    source.base = 500.0;
    source.vertical = HeightDatum::ellipsoid;
    if (change) change(source);
    return read_prior(source, {.origin = origin});
  }
  static double volume(const geometry::Mesh& mesh) {
    double sum = 0.0;
    for (const auto& t : mesh.triangles) {
      sum += mesh.vertices[t[0]].dot(mesh.vertices[t[1]].cross(mesh.vertices[t[2]])) / 6.0;
    }
    return sum;
  }
  testing_support::TemporaryFolder folder_;
};

/// Ring at 48 N, 9 E: 0.0002 degrees are 14.93 m east and 22.24 m north.
const std::string ring = "9,48 9.0002,48 9.0002,48.0002 9,48.0002 9,48";
constexpr double ring_area = 14.9256 * 22.2394;

std::string json_ring() { return "[[9,48],[9.0002,48],[9.0002,48.0002],[9,48.0002],[9,48]]"; }

std::string feature(const std::string& properties, const std::string& rings) {
  return R"({"type":"Feature","properties":)" + properties +
         R"(,"geometry":{"type":"Polygon","coordinates":[)" + rings + "]}}";
}

/// Returns a polygon as Google Earth writes it.
std::string make_kml(const std::string& mode, const std::string& coordinates) {
  return "<?xml version=\"1.0\"?><kml xmlns=\"http://www.opengis.net/kml/2.2\"><Document>"
         "<Placemark><name>court</name><Polygon>" +
         mode + "<outerBoundaryIs><LinearRing><coordinates>" + coordinates +
         "</coordinates></LinearRing></outerBoundaryIs></Polygon></Placemark></Document></kml>";
}

/// Returns the ring with a height at each corner.
std::string ring_at(const std::string& height) {
  std::string text;
  for (const char c : ring) text += c == ' ' ? "," + height + " " : std::string(1, c);
  return text + "," + height;
}

TEST_F(Map, ExtrudesPolygonFromGoogleEarth) {
  const Prior prior =
      read("court.kml", make_kml("", ring_at("0")), [](Source& s) { s.height = 18.0; });
  ASSERT_EQ(prior.objects.size(), 1U);
  EXPECT_EQ(prior.objects[0].id, "court");
  EXPECT_NEAR(volume(prior.objects[0].mesh), ring_area * 18.0, 1.0);
  EXPECT_NEAR(prior.box.min().z(), 0.0, 1e-3);
  EXPECT_NEAR(prior.box.max().z(), 18.0, 1e-3);
}

TEST_F(Map, UsesOnlyAbsoluteHeightsOfKmlPolygons) {
  const auto unplaced = [](Source& s) {
    s.base.reset();
    s.height = 18.0;
  };
  for (const char* mode : {"", "<altitudeMode>clampToGround</altitudeMode>",
                           "<extrude>1</extrude><altitudeMode>relativeToGround</altitudeMode>"}) {
    EXPECT_THAT([&] { read("court.kml", make_kml(mode, ring_at("30")), unplaced); },
                ThrowsMessage<Error>(HasSubstr("set base")))
        << mode;
  }
  const Prior prior = read(
      "court.kml", make_kml("<altitudeMode>absolute</altitudeMode>", ring_at("520")), unplaced);
  EXPECT_NEAR(prior.box.min().z(), 20.0, 1e-3);
  EXPECT_NEAR(prior.box.max().z(), 38.0, 1e-3);
}

TEST_F(Map, ReadsPolygonsWithAndWithoutHeights) {
  const std::string roof = "[[9,48,510],[9.0002,48,510],[9.0002,48.0002,512],[9,48,510]]";
  const std::string text = R"({"type":"FeatureCollection","features":[)" +
                           feature(R"({"id":"roof"})", roof) + "," +
                           feature(R"({"id":"flat","height":7})", json_ring()) + "]}";
  const Prior prior = read("mixed.geojson", text);
  ASSERT_EQ(prior.objects.size(), 2U);
  EXPECT_NEAR(geometry::bounding_box(prior.objects[0].mesh).min().z(), 10.0, 1e-3);
  EXPECT_NEAR(geometry::bounding_box(prior.objects[1].mesh).max().z(), 7.0, 1e-3);
  const std::string unsaid = R"({"type":"FeatureCollection","features":[)" +
                             feature(R"({"id":"roof"})", roof) + "," +
                             feature(R"({"id":"flat"})", json_ring()) + "]}";
  EXPECT_THAT([&] { read("mixed.geojson", unsaid); },
              ThrowsMessage<Error>(HasSubstr("contains no height of flat; set height")));
}

TEST_F(Map, ReadsHeightsAndStoreysFromAttributes) {
  const std::string text =
      R"({"type":"FeatureCollection","features":[)" +
      feature(R"({"id":"tall","height":"21.5 m"})", json_ring()) + "," +
      feature(R"({"id":"flat","building:levels":"4","building:min_level":"1"})", json_ring()) +
      "]}";
  const Prior prior = read("houses.geojson", text);
  ASSERT_EQ(prior.objects.size(), 2U);
  EXPECT_NEAR(geometry::bounding_box(prior.objects[0].mesh).max().z(), 21.5, 1e-3);
  const Eigen::AlignedBox3d flat = geometry::bounding_box(prior.objects[1].mesh);
  EXPECT_NEAR(flat.min().z(), 3.0, 1e-3);
  EXPECT_NEAR(flat.max().z(), 12.0, 1e-3);
  EXPECT_THAT(prior.notes, Contains(HasSubstr("1 outlines specify only a number of storeys")));
}

TEST_F(Map, ReadsOpenStreetMapBuildings) {
  // Editors write nodes in any order.
  const std::string osm = R"(<?xml version="1.0"?><osm version="0.6">
<node id="4" lat="48.0002" lon="9.0"/><node id="3" lat="48.0002" lon="9.0002"/>
<node id="1" lat="48.0" lon="9.0"/><node id="2" lat="48.0" lon="9.0002"/>
<way id="77"><nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="4"/><nd ref="1"/>
<tag k="building" v="yes"/><tag k="height" v="9"/></way></osm>)";
  const Prior prior = read("town.osm", osm);
  ASSERT_EQ(prior.objects.size(), 1U);
  EXPECT_EQ(prior.objects[0].id, "77");
  EXPECT_NEAR(volume(prior.objects[0].mesh), ring_area * 9.0, 1.0);
}

TEST_F(Map, IdentifiesGeoJsonFeaturesByUniqueNames) {
  const std::string text = R"({"type":"FeatureCollection","features":[)" +
                           feature(R"({"name":"hall","height":7})", json_ring()) + "," +
                           feature(R"({"name":"hall","height":8})", json_ring()) + "," +
                           feature(R"({"@id":"way/5","name":"barn","height":9})", json_ring()) +
                           "]}";
  const Prior prior = read("names.geojson", text);
  std::vector<std::string> ids;
  for (const auto& object : prior.objects) ids.push_back(object.id);
  EXPECT_THAT(ids, testing::ElementsAre("hall", "1", "way/5"));
}

TEST_F(Map, CutsCourtyardsOut) {
  const std::string hole =
      "[[9.00005,48.00005],[9.00015,48.00005],[9.00015,48.00015],[9.00005,48.00015],"
      "[9.00005,48.00005]]";
  const Prior prior = read("yard.geojson", feature(R"({"height":10})", json_ring() + "," + hole));
  EXPECT_NEAR(volume(prior.objects[0].mesh), 0.75 * ring_area * 10.0, 1.0);
}

TEST_F(Map, ReportsMissingKeys) {
  const std::string text = feature("{}", json_ring());
  EXPECT_THAT([&] { read("a.geojson", text); }, ThrowsMessage<Error>(HasSubstr("set height")));
  EXPECT_THAT(
      [&] {
        read("a.geojson", text, [](Source& s) {
          s.height = 5.0;
          s.base.reset();
        });
      },
      ThrowsMessage<Error>(HasSubstr("set base")));
  EXPECT_THAT(
      [&] {
        read("a.geojson", text, [](Source& s) {
          s.height = 5.0;
          s.vertical.reset();
          s.base_on_terrain = true;
        });
      },
      ThrowsMessage<Error>(HasSubstr("base: terrain requires prior data with role: terrain")));
  EXPECT_THAT([&] { read("a.geojson", text, [](Source& s) { s.select.layer = "b"; }); },
              ThrowsMessage<Error>(HasSubstr("unknown layer b; expected one of: a")));
}

TEST_F(Map, KeepsObjectsWithinPolygon) {
  const std::string two =
      R"({"type":"FeatureCollection","features":[)" +
      feature(R"({"id":"in","height":5})", json_ring()) + "," +
      feature(R"({"id":"out","height":5})", "[[9.01,48],[9.0102,48],[9.0102,48.0002],[9.01,48]]") +
      "]}";
  const auto region =
      folder_.file("site.geojson",
                   feature("{}", "[[8.999,47.999],[9.001,47.999],[9.001,48.001],[8.999,47.999]]"));
  const Prior prior = read("two.geojson", two, [&](Source& s) { s.select.within = region; });
  ASSERT_EQ(prior.objects.size(), 1U);
  EXPECT_EQ(prior.objects[0].id, "in");
}

TEST_F(Map, OpensOnlyNamedFile) {
  // A VRT could read any other file, so its driver is not enabled.
  EXPECT_THAT(testing_support::thrown_message(
                  [&] { read("a.tif", "<VRTDataset rasterXSize=\"1\" rasterYSize=\"1\"/>"); }),
              testing::HasSubstr("a.tif: "));
  EXPECT_THAT(testing_support::thrown_message([&] { read("a.gpkg", "<OGRVRTDataSource/>"); }),
              testing::HasSubstr("a.gpkg: "));
  Source source;
  source.file = "/vsizip/a.zip";
  EXPECT_THAT(testing_support::thrown_message([&] { read_prior(source, {}); }),
              testing::HasSubstr("/vsizip/a.zip: "));
}

}  // namespace
}  // namespace skycap::missions::site_data
