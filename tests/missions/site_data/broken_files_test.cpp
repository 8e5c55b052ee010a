// Truncated files and files with changed bytes are read or rejected in one line, for all formats
// and parsers.

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/missions/site_data/cube_files.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using namespace testing_support;

struct Whole {
  const char* name;
  std::string bytes;
};

std::vector<Whole> whole_files() {
  const Cube cube;
  return {{"cube.gml", make_citygml(cube)},     {"cube.json", make_cityjson(cube)},
          {"cube.geojson", make_geojson(cube)}, {"cube.obj", make_obj(cube)},
          {"cube.glb", make_glb(cube)},         {"cube.asc", make_ascii_grid(cube)},
          {"cube.las", make_las(cube, 4, 6)},   {"old.las", make_las(cube, 2, 3)},
          {"cube.e57", make_e57(cube)}};
}

class DamagedFiles : public testing::Test {
 protected:
  /// Returns true if the file is rejected. The test fails if the message is not one line with the
  /// file name.
  bool is_rejected(const std::string& name, const std::string& bytes, const std::string& what) {
    Source source = make_source(folder_.file(name, bytes));
    if (name == "cube.geojson") {
      source.base = 380.0;
      source.height = 10.0;
    }
    if (name == "cube.glb") source.offset = Cube().low;
    try {
      read_prior(source, site_at_cube());
      return false;
    } catch (const Error& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(name), std::string::npos) << what << ": " << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << what << ": " << message;
      return true;
    } catch (const std::exception& error) {
      ADD_FAILURE() << what << ": " << error.what();
      return true;
    }
  }
  TemporaryFolder folder_;
};

TEST_F(DamagedFiles, AreReadWhenIntact) {
  for (const Whole& whole : whole_files()) {
    EXPECT_FALSE(is_rejected(whole.name, whole.bytes, "whole")) << whole.name;
  }
}

TEST_F(DamagedFiles, AreRejectedInOneLineWhenTruncated) {
  std::size_t rejected = 0;
  for (const Whole& whole : whole_files()) {
    for (std::size_t i = 0; i < 20; ++i) {
      const std::size_t size = whole.bytes.size() * i / 20;
      const std::string what = std::string(whole.name) + " of " + std::to_string(size) + " bytes";
      rejected += is_rejected(whole.name, whole.bytes.substr(0, size), what) ? 1 : 0;
    }
  }
  EXPECT_GE(rejected, 100U);  // truncated text files such as OBJ may still be valid meshes
}

TEST_F(DamagedFiles, AreReadOrRejectedInOneLineWhenBytesChange) {
  std::mt19937_64 random(1);
  std::size_t rejected = 0, read = 0;
  for (const Whole& whole : whole_files()) {
    for (int i = 0; i < 40; ++i) {
      std::string bytes = whole.bytes;
      for (int j = 0; j < 4; ++j) bytes[random() % bytes.size()] = static_cast<char>(random());
      const std::string what = std::string(whole.name) + ", change " + std::to_string(i);
      ++(is_rejected(whole.name, bytes, what) ? rejected : read);
    }
  }
  EXPECT_GE(rejected, 100U);
  EXPECT_GE(read, 10U) << "else no change got past the first check of a format";
}

// A parsed tree needs many times the memory of its text: 110 MB and 60 MB here.
TEST_F(DamagedFiles, AreRejectedWhenTreesExceedMemoryLimit) {
  const auto expect_rejected = [&](const std::string& name, const std::string& bytes) {
    const Source source = make_source(folder_.file(name, bytes));
    EXPECT_THAT(thrown_message([&] { read_prior(source, site_at_cube()); }),
                testing::HasSubstr(name + ": requires more than 2 GiB"));
  };
  std::string gml = "<CityModel xmlns='http://www.opengis.net/citygml/2.0'>";
  for (int i = 0; i < 25'000'000; ++i) gml += "<a/>";
  expect_rejected("many.gml", gml + "</CityModel>");
  std::string json = R"({"type": "CityJSON", "version": "1.1", "CityObjects": {}, "vertices": [[])";
  for (int i = 0; i < 17'000'000; ++i) json += ",[]";
  expect_rejected("many.json", json + "]}");
}

TEST_F(DamagedFiles, AreRejectedWithKnownFormatsWhenUnknown) {
  Source source = make_source(folder_.file("notes.doc", "dear surveyor"));
  EXPECT_THAT([&] { read_prior(source, site_at_cube()); },
              testing::ThrowsMessage<Error>(testing::AllOf(testing::HasSubstr("notes.doc: "),
                                                           testing::HasSubstr("CityGML"))));
  source.file = folder_.path() / "none.gml";
  EXPECT_THAT(testing_support::thrown_message([&] { read_prior(source, site_at_cube()); }),
              testing::HasSubstr("none.gml: "));
  source.file = folder_.path();
  EXPECT_THAT(testing_support::thrown_message([&] { read_prior(source, site_at_cube()); }),
              testing::HasSubstr(folder_.path().string() + ": "));
}

// The first file crashes assimp 5.2, and the second makes it allocate memory without limit. It
// therefore runs in a separate process.
TEST_F(DamagedFiles, AreRejectedWhenLibraryCrashesOrLoops) {
  const auto error_message = [&](const std::string& name, const std::string& bytes) {
    return thrown_message(
        [&] { read_prior(make_source(folder_.file(name, bytes)), site_at_cube()); });
  };
  EXPECT_EQ(
      error_message("cut.ifc",
                    "ISO-10303-21;\nFILE_SCHEMA(('IFC2X3'));\nDATA;\n"
                    "#6=IFCPROJECT('0YvctVUKr0kugbFTf53O9L',#11,'p',$,$,$,$,(#5),#2);\n"
                    "#8=IFCSITE"),
      (folder_.path() / "cut.ifc").string() + ": is damaged: assimp stopped while reading it");
  EXPECT_THAT(
      error_message(
          "loop.dae",
          R"(<COLLADA version="1.4.1"><asset></asset><library_geometries><geometry id="g">)"
          R"(<mesh><source id="p"><float_array count="3">0 0 0</float_array></source>)"
          R"(<vertices id="v"></vertices><triangles count="12"><p>0 1e999 3</p></triangles>)"
          R"(</mesh></geometry></library_geometries></COLLADA>)"),
      testing::StartsWith((folder_.path() / "loop.dae").string() + ": "));
}

}  // namespace
}  // namespace skycap::missions::site_data
