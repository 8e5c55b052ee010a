// Meshes of photogrammetry programs, whose georeference is in another file.
#include "missions/site_data/formats/photogrammetry_offset.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/site_data/prior.h"
#include "tests/missions/site_data/cube_files.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using testing::HasSubstr;
using testing_support::Cube;

class PhotogrammetryOffsetTest : public testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) const {
    const fs::path path = folder_.path() / name;
    fs::create_directories(path.parent_path());
    std::ofstream(path) << text;
  }
  Source source(const std::string& name) const {
    Source source;
    source.file = folder_.path() / name;
    source.role = Role::target;
    return source;
  }
  /// Returns the box of the cube in the frame of a site 60 m from it.
  Eigen::AlignedBox3d box_of(const Source& source) const {
    return read_prior(source, testing_support::site_at_cube()).box;
  }

  const testing_support::TemporaryFolder folder_;
  Cube cube_;
  Cube local_{.low = Cube{}.low - Vector3d(676000, 5403000, 0)};
};

TEST_F(PhotogrammetryOffsetTest, IsReadFromOpenDroneMap) {
  write("odm_texturing/odm_textured_model_geo.obj", make_obj(local_));
  write("odm_georeferencing/coords.txt", "WGS84 UTM 32N\n676000 5403000\n1.5 2.5 430\n");
  const auto found =
      find_photogrammetry_offset(folder_.path() / "odm_texturing/odm_textured_model_geo.obj");
  ASSERT_TRUE(found);
  EXPECT_EQ(found->crs, "EPSG:32632");
  EXPECT_EQ(found->offset, Vector3d(676000, 5403000, 0));
  const Prior prior = read_prior(source("odm_texturing/odm_textured_model_geo.obj"),
                                 testing_support::site_at_cube());
  EXPECT_THAT(prior.notes, testing::Contains(HasSubstr("read from coords.txt, in EPSG:32632")));

  // The same cube in map coordinates. The two datums differ by less than a metre.
  write("cube.gml", make_citygml(cube_));
  Source reference = source("cube.gml");
  reference.vertical = HeightDatum::ellipsoid;
  const Eigen::AlignedBox3d expected = box_of(reference);
  EXPECT_LT((prior.box.min() - expected.min()).norm(), 0.01);
  EXPECT_LT((prior.box.max() - expected.max()).norm(), 0.01);
}

TEST_F(PhotogrammetryOffsetTest, IsReadFromPix4dWithTheCrsOfTheMission) {
  write("house.obj", make_obj(local_));
  write("project_offset.xyz", "676000.000 5403000.000 0.000\n");
  Source house = source("house.obj");
  EXPECT_THAT([&] { box_of(house); },
              testing::ThrowsMessage<Error>(
                  HasSubstr("has the coordinate offset of project_offset.xyz but no coordinate "
                            "reference system; set crs")));
  house.crs = "EPSG:25832";
  house.vertical = HeightDatum::ellipsoid;
  write("cube.gml", make_citygml(cube_));
  Source reference = source("cube.gml");
  reference.vertical = HeightDatum::ellipsoid;
  EXPECT_LT((box_of(house).min() - box_of(reference).min()).norm(), 0.01);
  // The offset of the mission file has priority.
  house.offset = Vector3d(676001, 5403000, 0);
  EXPECT_NEAR((box_of(house).min() - box_of(reference).min()).norm(), 1.0, 0.01);
}

std::string model_metadata(const std::string& system, const std::string& origin) {
  return R"(<?xml version="1.0" encoding="utf-8"?><ModelMetadata version="1"><SRS>)" + system +
         "</SRS><SRSOrigin>" + origin + "</SRSOrigin></ModelMetadata>";
}

TEST_F(PhotogrammetryOffsetTest, IsReadFromMetadataXml) {
  write("model/Data/tile_1/tile_1.obj", make_obj(local_));
  write("model/metadata.xml", model_metadata("EPSG:25832", "676000,5403000,0"));
  write("cube.gml", make_citygml(cube_));
  Source reference = source("cube.gml");
  reference.vertical = HeightDatum::ellipsoid;
  EXPECT_LT((box_of(source("model/Data/tile_1/tile_1.obj")).min() - box_of(reference).min()).norm(),
            0.01);
  // A file with the same name in the folder of the mesh, but of another program.
  write("model/Data/tile_1/metadata.xml", "<metadata><SRSOrigin>1,2,3</SRSOrigin></metadata>");
  const fs::path tile = folder_.path() / "model/Data/tile_1/tile_1.obj";
  EXPECT_EQ(find_photogrammetry_offset(tile)->offset, Vector3d(676000, 5403000, 0));

  write("model/metadata.xml", model_metadata("ENU:48.7,11.4", "0,0,0"));
  EXPECT_THAT([&] { box_of(source("model/Data/tile_1/tile_1.obj")); },
              testing::ThrowsMessage<Error>(
                  HasSubstr("has the coordinate offset of metadata.xml but no coordinate")));
  write("model/metadata.xml", model_metadata("EPSG:25832", "676000 5403000 0"));
  EXPECT_THAT([&] { find_photogrammetry_offset(tile); },
              testing::ThrowsMessage<Error>(
                  HasSubstr("metadata.xml: SRSOrigin must contain the origin as x,y,z")));
}

TEST_F(PhotogrammetryOffsetTest, RejectsInvalidFiles) {
  write("a_geo.obj", make_obj(local_));
  write("coords.txt", "WGS84 UTM 61N\n1 2\n");
  EXPECT_THAT([&] { find_photogrammetry_offset(folder_.path() / "a_geo.obj"); },
              testing::ThrowsMessage<Error>(HasSubstr("coords.txt: line 1 must be a coordinate")));
  write("coords.txt", "EPSG:32733\nleft right\n");
  EXPECT_THAT([&] { find_photogrammetry_offset(folder_.path() / "a_geo.obj"); },
              testing::ThrowsMessage<Error>(HasSubstr("line 2 must contain the easting")));
  write("coords.txt", "WGS84 UTM 33S\n1 2\n");
  EXPECT_EQ(find_photogrammetry_offset(folder_.path() / "a_geo.obj")->crs, "EPSG:32733");
  EXPECT_FALSE(find_photogrammetry_offset(folder_.path() / "a.obj"));
}

}  // namespace
}  // namespace skycap::missions::site_data
