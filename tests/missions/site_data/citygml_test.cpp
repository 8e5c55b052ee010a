// CityGML variants: levels of detail, parts, references, openings, three versions.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/surfaces/mesh.h"
#include "missions/site_data/formats/file_contents.h"
#include "tests/missions/site_data/cube_files.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

/// Returns a square with this side and height as gml:Polygon, optionally with a hole.
std::string square(double side, double z, const std::string& attributes = "", double hole = 0.0) {
  const auto ring = [z](double low, double high) {
    const std::string a = std::to_string(low), b = std::to_string(high),
                      h = " " + std::to_string(z) + " ";
    return "<gml:LinearRing><gml:posList>" + a + " " + a + h + b + " " + a + h + b + " " + b + h +
           a + " " + b + h + a + " " + a + h + "</gml:posList></gml:LinearRing>";
  };
  return "<gml:Polygon " + attributes + "><gml:exterior>" + ring(0, side) + "</gml:exterior>" +
         (hole > 0.0 ? "<gml:interior>" + ring(1, 1 + hole) + "</gml:interior>" : "") +
         "</gml:Polygon>";
}

std::string model(const std::string& members, const std::string& version = "2.0") {
  return "<core:CityModel xmlns:core=\"http://www.opengis.net/citygml/" + version +
         "\" xmlns:gml=\"http://www.opengis.net/gml\" xmlns:xlink=\"x\">" + members +
         "</core:CityModel>";
}

std::string building(const std::string& content) {
  return "<core:cityObjectMember><bldg:Building gml:id=\"b\">" + content +
         "</bldg:Building></core:cityObjectMember>";
}

class CityGml : public testing::Test {
 protected:
  Prior read(const std::string& text, const std::function<void(Source&)>& change = {}) {
    Source source;
    source.file = folder_.file("city.gml", text);
    source.pose = SourcePose{};
    if (change) change(source);
    return read_prior(source, {});
  }
  testing_support::TemporaryFolder folder_;
};

TEST_F(CityGml, UsesMaxDetailOfEachObjectByDefault) {
  const std::string text = model(building(
      "<bldg:lod1Solid>" + square(10, 1) + "</bldg:lod1Solid><bldg:lod2MultiSurface>" +
      square(20, 2) +
      "</bldg:lod2MultiSurface><bldg:consistsOfBuildingPart>"
      "<bldg:BuildingPart gml:id=\"part\"><bldg:lod1Solid>" +
      square(30, 3) + "</bldg:lod1Solid></bldg:BuildingPart></bldg:consistsOfBuildingPart>"));
  const Prior max_height_prior = read(text);
  ASSERT_EQ(max_height_prior.objects.size(), 1U);
  EXPECT_DOUBLE_EQ(geometry::surface_area(max_height_prior.objects[0].mesh), 400.0 + 900.0);
  const Prior first = read(text, [](Source& s) { s.select.lod = 1.0; });
  EXPECT_DOUBLE_EQ(geometry::surface_area(first.objects[0].mesh), 100.0 + 900.0);
}

TEST_F(CityGml, RejectsTwoReferenceSystemsUnlessPoseIsSet) {
  const std::string text = model(building(
      "<gml:boundedBy><gml:Envelope srsName=\"EPSG:25832\"/></gml:boundedBy><bldg:lod2Solid>" +
      square(10, 1, "srsName=\"EPSG:31468\"") + "</bldg:lod2Solid>"));
  const auto without_pose = [](Source& s) {
    s.pose.reset();
    s.vertical = HeightDatum::ellipsoid;
  };
  EXPECT_THAT([&] { read(text, without_pose); },
              ThrowsMessage<Error>(
                  HasSubstr("two coordinate reference systems, EPSG:25832 and EPSG:31468")));
  EXPECT_EQ(read(text).objects.size(), 1U) << "a place puts all of it";
}

TEST_F(CityGml, IgnoresRingsWithoutHeights) {
  const std::string flat =
      "<gml:Polygon><gml:exterior><gml:LinearRing><gml:posList srsDimension=\"2\">0 0 9 0 9 9 0 0"
      "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>";
  const Prior prior = read(model(
      building("<bldg:lod2MultiSurface>" + flat + square(10, 30) + "</bldg:lod2MultiSurface>")));
  EXPECT_EQ(prior.box.min().z(), 30.0);
  EXPECT_THAT(prior.notes, Contains(HasSubstr("1 rings ignored (no heights")));
  EXPECT_THAT(
      [&] { read(model(building("<bldg:lod2MultiSurface>" + flat + "</bldg:lod2MultiSurface>"))); },
      ThrowsMessage<Error>(HasSubstr("only coordinates without heights")));
}

TEST_F(CityGml, SelectsBuildingParts) {
  const std::string text = model(building(
      "<bldg:lod2Solid>" + square(10, 1) +
      "</bldg:lod2Solid><bldg:consistsOfBuildingPart>"
      "<bldg:BuildingPart gml:id=\"part\"><bldg:lod2Solid>" +
      square(30, 3) + "</bldg:lod2Solid></bldg:BuildingPart></bldg:consistsOfBuildingPart>"));
  const Prior part = read(text, [](Source& s) { s.select.ids = {"part"}; });
  ASSERT_EQ(part.objects.size(), 1U);
  EXPECT_EQ(part.objects[0].id, "part");
  EXPECT_DOUBLE_EQ(geometry::surface_area(part.objects[0].mesh), 900.0);
}

TEST_F(CityGml, KeepsHolesAndFillsThemWithOpenings) {
  const std::string text = model(building(
      "<bldg:boundedBy><bldg:WallSurface gml:id=\"w\"><bldg:lod3MultiSurface>" +
      square(10, 1, "", 3.0) +
      "</bldg:lod3MultiSurface><bldg:opening><bldg:Window gml:id=\"o\"><bldg:lod3MultiSurface>" +
      square(3, 1) +
      "</bldg:lod3MultiSurface></bldg:Window></bldg:opening>"
      "</bldg:WallSurface></bldg:boundedBy>"));
  const Prior prior = read(text);
  EXPECT_NEAR(geometry::surface_area(prior.objects[0].mesh), 91.0 + 9.0, 1e-9);
  EXPECT_THAT(prior.objects[0].surfaces, Contains(SurfaceKind::wall));
  EXPECT_THAT(prior.objects[0].surfaces, Contains(SurfaceKind::opening));
}

TEST_F(CityGml, ReadsSurfaceKindsFromReferences) {
  const std::string text =
      model(building("<bldg:lod2Solid><gml:Solid>" + square(10, 1, "gml:id=\"p\"") +
                     "</gml:Solid></bldg:lod2Solid><bldg:boundedBy><bldg:RoofSurface gml:id=\"r\">"
                     "<bldg:lod2MultiSurface><gml:surfaceMember xlink:href=\"#p\"/>"
                     "</bldg:lod2MultiSurface></bldg:RoofSurface></bldg:boundedBy>"));
  const Prior prior = read(text);
  EXPECT_DOUBLE_EQ(geometry::surface_area(prior.objects[0].mesh), 100.0);
  EXPECT_THAT(prior.objects[0].surfaces, testing::Each(SurfaceKind::roof));
}

TEST_F(CityGml, ReportsIgnoredRoomsAndClosures) {
  const std::string text =
      model(building("<bldg:lod2Solid>" + square(10, 1) +
                     "</bldg:lod2Solid>"
                     "<bldg:boundedBy><bldg:ClosureSurface gml:id=\"c\"><bldg:lod2MultiSurface>" +
                     square(20, 2) +
                     "</bldg:lod2MultiSurface></bldg:ClosureSurface></bldg:boundedBy>"
                     "<bldg:interiorRoom><bldg:Room gml:id=\"i\"><bldg:lod4Solid>" +
                     square(5, 0) + "</bldg:lod4Solid></bldg:Room></bldg:interiorRoom>"));
  const Prior prior = read(text);
  EXPECT_DOUBLE_EQ(geometry::surface_area(prior.objects[0].mesh), 100.0);
  EXPECT_THAT(prior.notes, Contains(HasSubstr("1 ClosureSurface ignored")));
  EXPECT_THAT(prior.notes, Contains(HasSubstr("1 Room ignored")));
}

TEST_F(CityGml, ReadsSinglePositions) {
  const std::string ring =
      "<gml:Polygon><gml:exterior><gml:LinearRing><gml:pos>0 0 1</gml:pos><gml:pos>4 0 1</gml:pos>"
      "<gml:pos>4 4 1</gml:pos><gml:pos>0 4 1</gml:pos></gml:LinearRing></gml:exterior>"
      "</gml:Polygon>";
  const Prior prior =
      read(model(building("<bldg:lod0FootPrint>" + ring + "</bldg:lod0FootPrint>")));
  EXPECT_DOUBLE_EQ(geometry::surface_area(prior.objects[0].mesh), 16.0);
}

TEST_F(CityGml, ReadsVersionsAndAttributes) {
  EXPECT_EQ(read(model(building(square(1, 0)), "1.0")).format, "CityGML 1.0");
  const Prior third = read(
      model(building("<gen:genericAttribute><gen:StringAttribute><gen:name>use</gen:name>"
                     "<gen:value>church</gen:value></gen:StringAttribute></gen:genericAttribute>"
                     "<gen:stringAttribute name=\"owner\"><gen:value>town</gen:value>"
                     "</gen:stringAttribute><bldg:roofType>1030</bldg:roofType>"
                     "<bldg:address><core:Address><xal:Thoroughfare><xal:ThoroughfareName>Am Ring"
                     "</xal:ThoroughfareName></xal:Thoroughfare></core:Address></bldg:address>" +
                     square(1, 0)),
            "3.0"));
  EXPECT_EQ(third.format, "CityGML 3.0");
  const auto& attributes = third.objects[0].attributes;
  EXPECT_EQ(attributes.at("use"), "church");
  EXPECT_EQ(attributes.at("owner"), "town");
  EXPECT_EQ(attributes.at("roofType"), "1030");
  EXPECT_EQ(attributes.at("ThoroughfareName"), "Am Ring");
}

TEST_F(CityGml, CountsDroppedPolygonsWithoutArea) {
  const std::string line =
      "<gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>0 0 0 1 1 1 0 0 0</gml:posList>"
      "</gml:LinearRing></gml:exterior></gml:Polygon>";
  const Prior prior = read(model(building(line + square(2, 0))));
  EXPECT_EQ(prior.dropped_polygons, 1U);
  EXPECT_DOUBLE_EQ(geometry::surface_area(prior.objects[0].mesh), 4.0);
}

TEST_F(CityGml, ReportsErrors) {
  const struct {
    std::string text, message;
  } cases[] = {
      {model("<a>") + "</b>", "is not valid XML from line"},
      {model(building("<gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>1 2 x"
                      "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>")),
       "the coordinate 'x'"},
      {model(building("<gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>1 2 3 4"
                      "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>")),
       "a ring of 4 numbers"},
      {model(building("<gml:Polygon srsDimension=\"7\"><gml:exterior><gml:LinearRing><gml:posList>1"
                      "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>")),
       "7 dimensions"},
      {model(building("<gml:Polygon><gml:exterior><gml:LinearRing><gml:posList>1 2 nan"
                      "</gml:posList></gml:LinearRing></gml:exterior></gml:Polygon>")),
       "the coordinate 'nan'"},
      {model(""), "contains neither surfaces nor points"},
  };
  for (const auto& broken : cases) {
    EXPECT_THAT(
        [&] { read(broken.text); },
        ThrowsMessage<Error>(testing::AllOf(HasSubstr("city.gml: "), HasSubstr(broken.message))));
  }
}

TEST_F(CityGml, RejectsTooManyObjects) {
  const std::string two = model(building(square(1, 0)) + building(square(1, 0)));
  EXPECT_EQ(parse_citygml("city.gml", two, 2).objects.size(), 2U);
  EXPECT_THAT([&] { parse_citygml("city.gml", two, 1); },
              ThrowsMessage<Error>(HasSubstr("city.gml: has more than 1 objects")));
}

TEST_F(CityGml, RejectsDeepNestingAndExternalEntities) {
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  for (int i = 0; i < 100'000; ++i) deep += "</a>";
  EXPECT_THAT([&] { read(model(deep)); }, ThrowsMessage<Error>(HasSubstr("nested deeper")));
  const std::string entity = "<!DOCTYPE x [<!ENTITY e SYSTEM \"file:///etc/passwd\">]>" +
                             model(building("<bldg:name>&e;</bldg:name>" + square(1, 0)));
  EXPECT_THAT(read(entity).objects[0].attributes["name"], testing::Not(HasSubstr("root")));
}

}  // namespace
}  // namespace skycap::missions::site_data
