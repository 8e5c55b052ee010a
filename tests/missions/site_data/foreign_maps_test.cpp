// Maps of other programs: notations of heights, building parts, masts, drawings in other units, and
// notes for files without a reference system, an index or a known attribute.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/surfaces/mesh.h"
#include "missions/site_data/formats/building_heights.h"
#include "missions/site_data/prior.h"
#include "tests/missions/site_data/gdal_files.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using Change = std::function<void(Source&)>;

class ForeignMap : public testing::Test {
 protected:
  Prior read_file(const std::filesystem::path& file, const Change& change = {}) {
    Source source;
    source.file = file;
    source.base = 500.0;
    source.vertical = HeightDatum::ellipsoid;
    if (change) change(source);
    return read_prior(source, {.origin = flight::GeodeticPoint{48.0, 9.0, 500.0}});
  }
  Prior read(const std::string& name, const std::string& text, const Change& change = {}) {
    return read_file(folder_.file(name, text), change);
  }
  std::string error_message(const std::string& name, const std::string& text,
                            const Change& change = {}) {
    return testing_support::thrown_message([&] { read(name, text, change); });
  }
  testing_support::TemporaryFolder folder_;
};

/// Returns a building with these properties.
std::string building(const std::string& properties) {
  return R"({"type":"Feature","id":"way/1","properties":{)" + properties +
         R"(},"geometry":{"type":"Polygon","coordinates":)"
         "[[[9,48],[9.0002,48],[9.0002,48.0002],[9,48.0002],[9,48]]]}}";
}

TEST(BuildingHeights, ReadsLengthsInMapNotations) {
  const struct {
    const char* text;
    double metres;
  } lengths[] = {
      {"12.5", 12.5},         {" 12,5 m", 12.5}, {"12 metres", 12.0},    {"130 ft", 39.624},
      {"130ft", 39.624},      {"40'", 12.192},   {"40 feet", 12.192},    {"7'4\"", 2.2352},
      {"7 ft 4 in", 2.2352},  {"12.5;13", 13.0}, {"9 m; 40 ft", 12.192}, {"10-12", 12.0},
      {"10 - 12 ft", 3.6576}, {"1200 cm", 12.0}, {"-1", -1.0},           {"+3", 3.0}};
  for (const auto& [text, metres] : lengths) {
    ASSERT_TRUE(parse_metres(text).has_value()) << text;
    EXPECT_NEAR(*parse_metres(text), metres, 1e-9) << text;
  }
  for (const char* text : {"", "high", "12 parsecs", "~12", "12 m?", "1.000,5", "12;tall"}) {
    EXPECT_EQ(parse_metres(text), std::nullopt) << text;
  }
  EXPECT_EQ(parse_storeys("4"), 4.0);
  EXPECT_EQ(parse_storeys("2;5"), 5.0);
  EXPECT_EQ(parse_storeys("3+1"), 4.0);
  EXPECT_EQ(parse_storeys("2-3"), 3.0);
  EXPECT_EQ(parse_storeys("G+2"), std::nullopt);
}

TEST_F(ForeignMap, ReadsHeightsFromAttributes) {
  const struct {
    const char* properties;
    double height;
  } cases[] = {{R"("height":"130 ft")", 39.624},
               {R"("height":"40'")", 12.192},
               {R"("height":"12,5")", 12.5},
               {R"("height":"12.5;13")", 13.0},
               {R"("HEIGHT":14)", 14.0},
               {R"("building:height":"15")", 15.0},
               {R"("est_height":16)", 16.0},
               {R"("building:levels":"2","roof:levels":"2")", 12.0},
               {R"("building:levels":"2","roof:height":"6")", 12.0},
               {R"("building:levels":"2;5")", 15.0},
               {R"("building:levels":"3+1")", 12.0},
               {R"("num_floors":5)", 15.0},
               {R"("building_l":"4")", 12.0},
               {R"("height":-1,"building:levels":3)", 9.0}};
  for (const auto& [properties, height] : cases) {
    SCOPED_TRACE(properties);
    const Prior prior = read("a.geojson", building(properties));
    EXPECT_NEAR(prior.box.max().z(), height, 1e-3);
    // For an obstacle, a lower default height has no effect.
    const Prior default_height =
        read("a.geojson", building(properties), [](Source& s) { s.height = 5.0; });
    EXPECT_NEAR(default_height.box.max().z(), height, 1e-3);
  }
  EXPECT_NEAR(read("a.geojson", building(R"("height":"30","min_height":"20 ft")")).box.min().z(),
              6.096, 1e-3);
}

TEST_F(ForeignMap, RejectsUnreadableHeights) {
  for (const char* properties : {R"("height":"12 parsecs")", R"("building:levels":"G+2")",
                                 R"("building:levels":"2","roof:height":"steep")"}) {
    EXPECT_THAT(
        error_message("a.geojson", building(properties), [](Source& s) { s.height = 10.0; }),
        AllOf(HasSubstr("a.geojson: way/1 has the "),
              HasSubstr("; correct it or exclude the object with select")))
        << properties;
  }
}

TEST_F(ForeignMap, TreatsHeightsUpToZeroAsUnknown) {
  for (const char* height : {"-1", "0", "-1.0"}) {
    const std::string text = building(R"("height":)" + std::string(height));
    EXPECT_THAT(error_message("a.geojson", text), HasSubstr("contains no height of way/1"));
    const Prior prior = read("a.geojson", text, [](Source& s) { s.height = 10.0; });
    EXPECT_NEAR(prior.box.max().z(), 10.0, 1e-3);
    EXPECT_THAT(prior.notes, Contains(HasSubstr("1 outlines have a height of 0 or less")));
  }
}

TEST_F(ForeignMap, ListsAttributesWhenHeightIsMissing) {
  const std::string text = building(R"("name":"hall","hauteur":17)");
  EXPECT_THAT(error_message("a.geojson", text), HasSubstr("(available attributes: "));
  EXPECT_THAT(error_message("a.geojson", text), HasSubstr("hauteur, "));
  const Prior prior = read("a.geojson", text, [](Source& s) { s.height_attribute = "hauteur"; });
  EXPECT_NEAR(prior.box.max().z(), 17.0, 1e-3);
}

/// Returns an OSM file with nodes 1 to 4 of the square, nodes 5 to 8 of a smaller square inside it,
/// and `more`.
std::string osm(const std::string& more) {
  std::string text = "<?xml version=\"1.0\"?><osm version=\"0.6\">";
  const char* const positions[] = {"lat='48' lon='9'",
                                   "lat='48' lon='9.0002'",
                                   "lat='48.0002' lon='9.0002'",
                                   "lat='48.0002' lon='9'",
                                   "lat='48.00005' lon='9.00005'",
                                   "lat='48.00005' lon='9.00015'",
                                   "lat='48.00015' lon='9.00015'",
                                   "lat='48.00015' lon='9.00005'"};
  for (int i = 0; i < 8; ++i) {
    text += "<node id='" + std::to_string(i + 1) + "' " + positions[i] + " version='1'/>";
  }
  return text + more + "</osm>";
}

std::string osm_line(int id, bool is_inner, const std::string& tags) {
  std::string text = "<way id='" + std::to_string(id) + "' version='1'>";
  for (const int node : {1, 2, 3, 4, 1}) {
    text += "<nd ref='" + std::to_string(node + (is_inner ? 4 : 0)) + "'/>";
  }
  return text + tags + "</way>";
}

std::string tag(const std::string& key, const std::string& value) {
  return "<tag k='" + key + "' v='" + value + "'/>";
}

TEST_F(ForeignMap, ReadsBuildingParts) {
  const std::string hall = osm_line(101, false, tag("building", "yes") + tag("height", "12"));
  const std::string part =
      tag("building:part", "yes") + tag("height", "40") + tag("min_height", "12");
  const std::string relation = osm_line(102, true, "") +
                               "<relation id='103' version='1'><member type='way' ref='102' "
                               "role='outer'/>" +
                               tag("type", "multipolygon") + part + "</relation>";
  for (const std::string& tower : {osm_line(102, true, part), relation}) {
    const Prior prior = read("a.osm", osm(hall + tower));
    ASSERT_EQ(prior.objects.size(), 2U);
    EXPECT_NEAR(prior.box.max().z(), 40.0, 1e-2);
    EXPECT_THAT(prior.notes, Not(Contains(HasSubstr("points and lines ignored"))));
  }
  const std::string tank =
      osm_line(104, true, tag("man_made", "storage_tank") + tag("height", "20"));
  EXPECT_NEAR(read("a.osm", osm(hall + tank)).box.max().z(), 20.0, 1e-2);
}

TEST_F(ForeignMap, ReadsMastsAndWallsWithHeight) {
  const std::string mast = "<node id='9' lat='48.0001' lon='9.0001' version='1'>" +
                           tag("man_made", "mast") + tag("height", "45") + "</node>";
  const Prior prior = read("a.osm", osm(mast));
  ASSERT_EQ(prior.objects.size(), 1U);
  EXPECT_NEAR(prior.box.max().z(), 45.0, 1e-2);
  // A circle of 0.5 m around its position, 7.46 m east and 11.12 m north.
  EXPECT_NEAR(prior.box.sizes().x(), 1.08, 0.01);
  EXPECT_NEAR(prior.box.center().x(), 7.46, 0.02);
  EXPECT_NEAR(prior.box.center().y(), 11.12, 0.02);
  EXPECT_THAT(prior.notes,
              Contains(HasSubstr("1 points and lines with a height are read as poles")));
  const std::string wall = "<way id='7' version='1'><nd ref='1'/><nd ref='2'/>" +
                           tag("barrier", "wall") + tag("height", "3") + "</way>";
  const Prior walled = read("a.osm", osm(wall));
  EXPECT_NEAR(walled.box.max().z(), 3.0, 1e-2);
  EXPECT_NEAR(walled.box.sizes().x(), 15.43, 0.05);
  EXPECT_NEAR(walled.box.sizes().y(), 0.5, 0.01);
}

TEST_F(ForeignMap, CountsIgnoredNonStructures) {
  const std::string hall = osm_line(101, true, tag("building", "yes") + tag("height", "12"));
  const std::string others = osm_line(102, false, tag("landuse", "residential")) +
                             osm_line(103, false, tag("building", "no") + tag("height", "30")) +
                             osm_line(104, false, tag("natural", "water")) +
                             "<way id='8' version='1'><nd ref='1'/><nd ref='3'/>" +
                             tag("power", "line") + "</way>";
  const Prior prior = read("a.osm", osm(hall + others), [](Source& s) { s.height = 10.0; });
  ASSERT_EQ(prior.objects.size(), 1U);
  EXPECT_NEAR(prior.box.max().z(), 12.0, 1e-2);
  EXPECT_THAT(prior.notes, Contains(HasSubstr("3 areas ignored (neither buildings")));
  EXPECT_THAT(prior.notes, Contains(HasSubstr("1 power lines and cableways ignored")));
  EXPECT_THAT(
      error_message("a.osm", osm(osm_line(102, false, tag("landuse", "forest")))),
      HasSubstr("contains no outlines and no other objects with a height (1 areas ignored"));
}

/// Returns a closed line of 8 x 10 units as AutoCAD writes it.
std::string dxf(const std::string& header, double unit) {
  std::string text = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n" + header +
                     "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n5\nA1\n100\nAcDbEntity\n"
                     "8\nHOUSE\n100\nAcDbPolyline\n90\n4\n70\n1\n";
  for (const auto& [x, y] :
       std::initializer_list<std::pair<double, double>>{{0, 0}, {8, 0}, {8, 10}, {0, 10}}) {
    text += "10\n" + std::to_string(x / unit) + "\n20\n" + std::to_string(y / unit) + "\n";
  }
  return text + "0\nENDSEC\n0\nEOF\n";
}

std::string insunits(int number) { return "9\n$INSUNITS\n70\n" + std::to_string(number) + "\n"; }

TEST_F(ForeignMap, ReadsUnitsOfDrawings) {
  const auto here = [](Source& s) {
    s.vertical.reset();
    s.base = 0.0;
    s.height = 12.0;
  };
  const struct {
    int number;
    double metres;
  } units[] = {{1, 0.0254}, {2, 0.3048}, {4, 0.001},   {5, 0.01},
               {6, 1.0},    {14, 0.1},   {10, 0.9144}, {21, 1200.0 / 3937.0}};
  for (const auto& [number, metres] : units) {
    SCOPED_TRACE(number);
    const Prior prior = read("a.dxf", dxf(insunits(number), metres), here);
    EXPECT_LT((prior.box.sizes() - Eigen::Vector3d(8, 10, 12)).norm(), 1e-3) << prior.box.sizes();
    EXPECT_THAT(prior.notes, Contains(HasSubstr("linear unit: the ")));
  }
  for (const std::string& header : {std::string(), insunits(0)}) {
    const Prior prior = read("a.dxf", dxf(header, 1.0), here);
    EXPECT_LT((prior.box.sizes() - Eigen::Vector3d(8, 10, 12)).norm(), 1e-3);
    EXPECT_THAT(prior.notes, Contains(HasSubstr("missing unit ($INSUNITS)")));
  }
  EXPECT_THAT(error_message("a.dxf", dxf(insunits(99), 1.0), here),
              HasSubstr("has an unknown unit: $INSUNITS 99; set unit"));
  const Prior reported = read("a.dxf", dxf(insunits(99), 0.5), [&](Source& s) {
    here(s);
    s.unit = 0.5;
  });
  EXPECT_LT((reported.box.sizes() - Eigen::Vector3d(8, 10, 12)).norm(), 1e-3);
}

TEST_F(ForeignMap, WarnsAboutImplausibleExtent) {
  const auto here = [](Source& s) {
    s.vertical.reset();
    s.base = 0.0;
    s.height = 0.5;
  };
  EXPECT_THAT(read("a.dxf", dxf(insunits(6), 100.0), here).notes,
              Contains(HasSubstr("Warning: the extent of the data is only 0.5 m")));
  EXPECT_THAT(read("a.dxf", dxf(insunits(6), 0.001), here).notes,
              Contains(HasSubstr("Warning: the extent of the data is 10.0 km")));
  EXPECT_THAT(read("a.dxf", dxf(insunits(6), 1.0), here).notes,
              Not(Contains(HasSubstr("Warning"))));
}

TEST_F(ForeignMap, ReadsTruncatedAttributeNamesOfShapefiles) {
  const auto file = folder_.path() / "levels.shp";
  testing_support::write_map(
      file, {.driver = "ESRI Shapefile", .attributes = {{"building_l", "4"}, {"NAME", "hall"}}});
  EXPECT_NEAR(read_file(file).box.max().z(), 12.0, 1e-3);
  const auto upper = folder_.path() / "upper.shp";
  testing_support::write_map(upper,
                             {.driver = "ESRI Shapefile", .attributes = {{"HEIGHT", "14 m"}}});
  EXPECT_NEAR(read_file(upper).box.max().z(), 14.0, 1e-3);
}

TEST_F(ForeignMap, ReadsShapefileWithoutIndexButNotWithoutCrs) {
  const auto file = folder_.path() / "hall.shp";
  testing_support::write_map(file, {.driver = "ESRI Shapefile", .attributes = {{"height", "12"}}});
  std::filesystem::remove(folder_.path() / "hall.shx");
  const Prior prior = read_file(file);
  EXPECT_NEAR(prior.box.max().z(), 12.0, 1e-3);
  EXPECT_NEAR(prior.box.sizes().x(), 14.93, 0.01);
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "hall.shx"));
  std::filesystem::remove(folder_.path() / "hall.prj");
  const auto nowhere = [](Source& s) { s.vertical.reset(); };
  EXPECT_THAT(testing_support::thrown_message([&] { read_file(file, nowhere); }),
              HasSubstr("missing coordinate reference system; the coordinates (9.0000, 48.0000) "
                        "may be degrees; set crs: EPSG:4326, or set place if they are in metres"));
  EXPECT_NEAR(read_file(file, [](Source& s) { s.crs = "EPSG:4326"; }).box.sizes().x(), 14.93, 0.01);
  for (const char* driver : {"GPKG", "FlatGeobuf"}) {
    const auto other = folder_.path() / (std::string("a.") + (driver[0] == 'G' ? "gpkg" : "fgb"));
    testing_support::write_map(other,
                               {.driver = driver, .epsg = 0, .attributes = {{"height", "12"}}});
    EXPECT_THAT(testing_support::thrown_message([&] { read_file(other, nowhere); }),
                HasSubstr(other.string() + ": "))
        << driver;
  }
}

}  // namespace
}  // namespace skycap::missions::site_data
