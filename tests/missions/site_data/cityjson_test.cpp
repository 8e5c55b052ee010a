// All CityJSON versions, as one document and as CityJSONSeq lines.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "geometry/surfaces/mesh.h"
#include "missions/site_data/file_reader.h"
#include "missions/site_data/formats/file_contents.h"
#include "tests/missions/site_data/cube_files.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class CityJson : public testing::Test {
 protected:
  Prior read(const std::string& text, const std::function<void(Source&)>& change = {}) {
    Source source;
    source.file = folder_.file("city.json", text);
    source.pose = SourcePose{};
    if (change) change(source);
    return read_prior(source, {});
  }
  testing_support::TemporaryFolder folder_;
};

const std::string four_vertices = R"("vertices":[[0,0,0],[4,0,0],[4,4,0],[0,4,0]])";

std::string make_surface(const std::string& type, const std::string& boundaries) {
  return R"({"type":"CityJSON","version":"1.0","CityObjects":{"a":{"type":"Building","geometry":[)"
         R"({"type":")" +
         type + R"(","lod":1,"boundaries":)" + boundaries + "}]}}," + four_vertices + "}";
}

TEST_F(CityJson, ReadsBoundariesByGeometryType) {
  EXPECT_EQ(read(make_surface("MultiSurface", "[[[0,1,2,3]]]")).objects[0].mesh.triangles.size(),
            2U);
  EXPECT_EQ(read(make_surface("Solid", "[[[[0,1,2,3]]]]")).objects[0].mesh.triangles.size(), 2U);
  EXPECT_EQ(read(make_surface("MultiSolid", "[[[[[0,1,2,3]]]]]")).objects[0].mesh.triangles.size(),
            2U);
}

TEST_F(CityJson, IsParsedOnceDuringReadOnce) {
  Source source;
  source.file = folder_.file("city.json", make_surface("MultiSurface", "[[[0,1,2,3]]]"));
  source.pose = SourcePose{};
  const SharedContents before = read_contents(source, {});
  EXPECT_NE(read_contents(source, {}), before);
  SharedContents kept;
  {
    const ReadOnce once;
    kept = read_contents(source, {});
    {
      const ReadOnce inner;
      EXPECT_EQ(read_contents(source, {}), kept);
    }
    EXPECT_EQ(read_contents(source, {}), kept);
    Source cloud = source;
    cloud.file = folder_.file("scan.txt", "1 2 3\n4 5 6\n");
    const SharedContents points = read_contents(cloud, {});
    EXPECT_NE(read_contents(cloud, {}), points) << "the caller changes its points";
    EXPECT_EQ(read_contents(source, {}), kept);
    Source other = source;
    other.height_attribute = "h";  // used by map readers only
    EXPECT_NE(read_contents(other, {}), kept);
  }
  EXPECT_NE(read_contents(source, {}), kept);
}

TEST_F(CityJson, ReadsFeatureLinesWithScaleOfFirstLine) {
  const std::string lines =
      R"({"type":"CityJSON","version":"2.0","transform":{"scale":[0.5,0.5,0.5],"translate":[10,20,30]},)"
      R"("CityObjects":{},"vertices":[]})"
      "\n"
      R"({"type":"CityJSONFeature","id":"a","CityObjects":{"a":{"type":"Building","children":["p"]},)"
      R"("p":{"type":"BuildingPart","parents":["a"],"geometry":[{"type":"MultiSurface","lod":"2.2",)"
      R"("boundaries":[[[0,1,2,3]]]}]}},)" +
      four_vertices + "}\n\n" +
      R"({"type":"CityJSONFeature","id":"b","CityObjects":{"b":{"type":"Building","geometry":[)"
      R"({"type":"MultiSurface","lod":"2.2","boundaries":[[[0,1,2]]]}]}},)" +
      four_vertices + "}\n";
  const Prior prior = read(lines);
  EXPECT_EQ(prior.format, "CityJSONSeq 2.0");
  ASSERT_EQ(prior.objects.size(), 2U);
  EXPECT_EQ(prior.objects[0].id, "a");  // the part belongs to its building
  EXPECT_DOUBLE_EQ(geometry::surface_area(prior.objects[0].mesh), 4.0);
  EXPECT_TRUE(prior.box.min().isApprox(Eigen::Vector3d(10, 20, 30)));
}

TEST_F(CityJson, TransformsTemplatesToInstances) {
  const std::string text =
      R"({"type":"CityJSON","version":"1.1","transform":{"scale":[1,1,1],"translate":[0,0,0]},)"
      R"("geometry-templates":{"templates":[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2]]]}],)"
      R"("vertices-templates":[[0,0,0],[1,0,0],[0,1,0]]},"CityObjects":{"tree":{"type":)"
      R"("SolitaryVegetationObject","geometry":[{"type":"GeometryInstance","template":0,)"
      R"("boundaries":[2],"transformationMatrix":[2,0,0,0,0,2,0,0,0,0,2,0,0,0,0,1]}]}},)" +
      four_vertices + "}";
  const Prior prior = read(text);
  EXPECT_DOUBLE_EQ(geometry::surface_area(prior.objects[0].mesh), 2.0);
  EXPECT_TRUE(prior.box.min().isApprox(Eigen::Vector3d(4, 4, 0)));
}

TEST_F(CityJson, ReportsErrors) {
  const std::string deep(100'000, '[');
  const struct {
    std::string text, message;
  } cases[] = {
      {R"({"type":"CityJSON",)", "is not JSON"},
      {R"({"type":"CityJSON","x":)" + deep, "is not JSON"},
      {R"({"type":"CityJSON","version":"2.0"})", "violates the CityJSON specification"},
      {make_surface("MultiSurface", "[[[0,1,9]]]"), "violates the CityJSON specification"},
      {make_surface("MultiSurface", "[[[0,1,-1]]]"), "violates the CityJSON specification"},
      {make_surface("MultiSurface", "7"), "violates the CityJSON specification"},
      {R"({"type":"CityJSON","version":"2.0","vertices":[],"CityObjects":{"a":{"type":"Building",)"
       R"("parents":["a"],"geometry":[{"type":"MultiSurface","boundaries":[[[]]]}]}}})",
       "contains itself"},
  };
  for (const auto& broken : cases) {
    EXPECT_THAT(
        [&] { read(broken.text); },
        ThrowsMessage<Error>(testing::AllOf(HasSubstr("city.json: "), HasSubstr(broken.message))));
  }
}

/// Property: the expansion of template instances in a small file is limited.
TEST_F(CityJson, RejectsTooManyCorners) {
  std::string ring = "0", instances;
  for (int i = 1; i < 10'000; ++i) ring += ",0";
  for (int i = 0; i < 1601; ++i) {
    instances += std::string(i == 0 ? "" : ",") +
                 R"({"type":"GeometryInstance","template":0,"boundaries":[0],)"
                 R"("transformationMatrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]})";
  }
  const std::string text =
      R"({"type":"CityJSON","version":"2.0","geometry-templates":{"vertices-templates":[[0,0,0]],)"
      R"("templates":[{"type":"MultiSurface","lod":1,"boundaries":[[[)" +
      ring + R"(]]]}]},"vertices":[[0,0,0]],"CityObjects":{"a":{"type":"Building","geometry":[)" +
      instances + "]}}}";
  EXPECT_THAT([&] { parse_cityjson("city.json", text); },
              ThrowsMessage<Error>(HasSubstr("has more than 16 million polygon corners")));
}

/// Estimated from counts in the text before it is parsed.
TEST_F(CityJson, RejectsTreesAboveMemoryLimit) {
  EXPECT_THAT([&] { parse_cityjson("city.json", std::string(max_tree_bytes / 65 + 1, '[')); },
              ThrowsMessage<Error>(HasSubstr("city.json: requires more than 2 GiB")));
}

}  // namespace
}  // namespace skycap::missions::site_data
