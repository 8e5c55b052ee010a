// City models with the names, numbers and semantics of other programs.
#include <iterator>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/site_data/prior.h"
#include "missions/site_data/reference_system.h"
#include "tests/missions/site_data/cube_files.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing_support::Cube;

class ForeignCity : public testing::Test {
 protected:
  Prior read(const std::string& name, const std::string& text) {
    Source source = testing_support::make_source(folder_.file(name, text));
    source.crs.clear();
    return read_prior(source, testing_support::site_at_cube());
  }
  void expect_cube(const std::string& name, const std::string& text) {
    try {
      const Prior prior = read(name, text);
      ASSERT_EQ(prior.objects.size(), 1U);
      EXPECT_EQ(prior.objects[0].mesh.triangles.size(), 12U);
      EXPECT_NEAR(prior.ellipsoid_heights->min, 380.0, 1e-3);
      EXPECT_NEAR(prior.ellipsoid_heights->max, 390.0, 1e-3);
      notes_ = prior.notes;
    } catch (const Error& error) {
      ADD_FAILURE() << error.what();
    }
  }
  std::string error_message(const std::string& name, const std::string& text) {
    return testing_support::thrown_message([&] { read(name, text); });
  }
  testing_support::TemporaryFolder folder_;
  std::vector<std::string> notes_;  ///< notes about the last cube
};

std::string replaced(std::string text, const std::string& old, const std::string& now) {
  EXPECT_NE(text.find(old), std::string::npos) << old;
  for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old, at)) {
    text.replace(at, old.size(), now);
    at += now.size();
  }
  return text;
}

TEST(ReferenceNames, AreConvertedToAuthorityCodes) {
  for (const char* name :
       {"urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH", "urn:adv:crs:ETRS89_UTM32 * DE_DHHN2016_NH",
        "urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH*GCG2016"}) {
    EXPECT_EQ(proj_name(name), "EPSG:25832+7837") << name;
  }
  for (const char* name : {"urn:ogc:def:crs:EPSG:2056, crs:EPSG:5728",
                           "urn:ogc:def:crs,crs:EPSG::2056,crs:EPSG::5728", "EPSG:2056+EPSG:5728",
                           "http://www.opengis.net/def/crs/epsg/0/2056 + "
                           "http://www.opengis.net/def/crs/EPSG/0/5728"}) {
    EXPECT_EQ(name_by_numbers(name), "EPSG:2056+5728") << name;
  }
  EXPECT_EQ(proj_name("CH1903"), "EPSG:21781");
  EXPECT_EQ(proj_name("CH1903+"), "EPSG:2056");
  EXPECT_EQ(name_by_numbers("http://www.opengis.net/gml/srs/epsg.xml#25832"), "EPSG:25832");
  EXPECT_EQ(name_by_numbers("urn:ogc:def:crs:EPSG:6.9:25832"), "EPSG:25832");
  EXPECT_EQ(name_by_numbers("local"), "");
  EXPECT_EQ(likely_name("urn:adv:crs:ETRS89_UTM32*DE_DHHN2099_NH"), "EPSG:25832");
  EXPECT_EQ(likely_name("my own"), "");
}

TEST_F(ForeignCity, ReadsReferenceSystemNamesOfAuthorities) {
  for (const char* name : {"EPSG:25832", "http://www.opengis.net/gml/srs/epsg.xml#25832",
                           "urn:adv:crs:ETRS89_UTM32", "urn:ogc:def:crs:EPSG:6.9:25832"}) {
    expect_cube("a.gml", testing_support::make_citygml(Cube(), name));
  }
  EXPECT_THAT(error_message("a.gml", testing_support::make_citygml(
                                         Cube(), "urn:adv:crs:ETRS89_UTM32*DE_DHHN2099_NH")),
              HasSubstr("; set crs: EPSG:25832 if this system is intended"));
  EXPECT_THAT(error_message("a.gml", testing_support::make_citygml(Cube(), "my own")),
              HasSubstr("'my own'; set crs to its PROJ name"));
}

/// Returns the cube as GML with another notation for the coordinates of each ring.
std::string gml_with(const std::function<std::string(const std::vector<std::string>&)>& ring) {
  std::string text = testing_support::make_citygml(Cube());
  const std::string begin = "<gml:posList>", end = "</gml:posList>";
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
    const std::size_t close = text.find(end, at);
    std::istringstream words(text.substr(at + begin.size(), close - at - begin.size()));
    const std::vector<std::string> numbers(std::istream_iterator<std::string>(words), {});
    const std::string now = ring(numbers);
    text.replace(at, close + end.size() - at, now);
    at += now.size();
  }
  return text;
}

TEST_F(ForeignCity, ReadsCoordinatesWithCustomSeparators) {
  const auto coordinates = [](const std::string& attributes, const std::string& cs,
                              const std::string& ts, char point) {
    return gml_with([=](const std::vector<std::string>& numbers) {
      std::string text = "<gml:coordinates" + attributes + ">";
      for (std::size_t i = 0; i < numbers.size(); ++i) {
        std::string number = numbers[i];
        number[number.find('.')] = point;
        text += (i == 0 ? "" : i % 3 == 0 ? ts : cs) + number;
      }
      return text + "</gml:coordinates>";
    });
  };
  expect_cube("a.gml", coordinates("", ",", " ", '.'));
  expect_cube("a.gml", coordinates(" decimal=\",\" cs=\";\" ts=\" \"", ";", " ", ','));
  expect_cube("a.gml", coordinates(" decimal=\",\" cs=\" \" ts=\"|\"", " ", "|", ','));
  expect_cube("a.gml", coordinates(" cs=\";\"", ";", " ", '.'));
  EXPECT_THAT(error_message("a.gml", coordinates("", ";", " ", '.')),
              HasSubstr("it must be a number"));
}

TEST_F(ForeignCity, ReadsSinglePoints) {
  for (const char* element : {"pointProperty", "pointRep"}) {
    expect_cube("a.gml", gml_with([&](const std::vector<std::string>& numbers) {
                  std::string text;
                  for (std::size_t i = 0; i + 2 < numbers.size(); i += 3) {
                    text += "<gml:" + std::string(element) + "><gml:Point><gml:pos>" + numbers[i] +
                            " " + numbers[i + 1] + " " + numbers[i + 2] +
                            "</gml:pos></gml:Point></gml:" + element + ">";
                  }
                  return text;
                }));
  }
}

TEST_F(ForeignCity, ReadsUtf16Files) {
  const std::string gml = replaced(testing_support::make_citygml(Cube()), "<?xml version=\"1.0\"?>",
                                   "<?xml version=\"1.0\" encoding=\"UTF-16\"?>");
  for (const bool is_big_endian : {false, true}) {
    std::string wide = is_big_endian ? "\xFE\xFF" : "\xFF\xFE";
    for (const char c : gml) {
      wide += is_big_endian ? '\0' : c;
      wide += is_big_endian ? c : '\0';
    }
    expect_cube("a.gml", wide);
  }
  expect_cube("a.json", "\xEF\xBB\xBF" + testing_support::make_cityjson(Cube()));
  expect_cube("a.gml", "\xEF\xBB\xBF" + testing_support::make_citygml(Cube()));
}

TEST_F(ForeignCity, ReadsSurfacesWithIncompleteSemantics) {
  const std::string json = testing_support::make_cityjson(Cube());
  const std::size_t begin = json.find(R"("semantics":)"), end = json.find("]]}}]}}", begin) + 3;
  const auto with = [&](const std::string& semantics) {
    return json.substr(0, begin) + semantics + json.substr(end);
  };
  for (const char* semantics :
       {R"("semantics":{"surfaces":[{"type":"WallSurface"}]})", R"("semantics":{})",
        R"("semantics":null)", R"("semantics":{"surfaces":null,"values":null})",
        R"("semantics":{"surfaces":[{"type":"WallSurface"}],"values":[[0,7,0,0,-1,null]]})",
        R"("semantics":{"surfaces":[{"type":"WallSurface"}],"values":[[5]]})"}) {
    expect_cube("a.json", with(semantics));
    EXPECT_THAT(notes_, Contains(HasSubstr("semantics are incomplete"))) << semantics;
  }
  expect_cube("a.json",
              with(R"("semantics":{"surfaces":[{"type":"WallSurface"}],"values":[[0]]})"));
}

TEST_F(ForeignCity, AcceptsInvalidDetailLevels) {
  const std::string json = testing_support::make_cityjson(Cube());
  for (const char* lod :
       {R"("lod":null)", R"("lod":"")", R"("lod":"high")", R"("lod":true)", R"("lod":-1)"}) {
    expect_cube("a.json", replaced(json, R"("lod":"2.2")", lod));
    EXPECT_THAT(notes_, Contains(HasSubstr("1 geometries have an invalid lod"))) << lod;
  }
  for (const char* lod : {R"("lod":"LoD2")", R"("lod":" lod2.2 ")", R"("lod":2)"}) {
    expect_cube("a.json", replaced(json, R"("lod":"2.2")", lod));
    EXPECT_THAT(notes_, testing::IsEmpty()) << lod;
  }
}

TEST_F(ForeignCity, NamesInvalidObjects) {
  const std::string json = testing_support::make_cityjson(Cube());
  EXPECT_THAT(error_message("a.json", replaced(json, R"("boundaries":[[)", R"("bounds":[[)")),
              HasSubstr("violates the CityJSON specification in the object cube ("));
}

}  // namespace
}  // namespace skycap::missions::site_data
