// Scenes with units, extensions and names that assimp ignores.
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "missions/site_data/prior.h"
#include "tests/missions/site_data/cube_files.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::site_data {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;

class ForeignScene : public testing::Test {
 protected:
  Prior read_file(const std::filesystem::path& file, std::optional<double> unit = {}) {
    Source source;
    source.file = file;
    source.unit = unit;
    return read_prior(source, {});
  }
  Prior read(const std::string& name, const std::string& bytes, std::optional<double> unit = {}) {
    return read_file(folder_.file(name, bytes), unit);
  }
  std::string error_message(const std::string& name, const std::string& bytes) {
    return testing_support::thrown_message([&] { read(name, bytes); });
  }
  testing_support::TemporaryFolder folder_;
};

/// The JSON and binary parts of the cube's scene with a side of 10 m.
struct Glb {
  std::string json, binary;
};

Glb split_glb(const std::string& glb) {
  std::uint32_t size = 0;
  std::memcpy(&size, glb.data() + 12, 4);
  return {glb.substr(20, size), glb.substr(28 + size)};
}

/// Returns the scene as text with a separate buffer file and additional members.
std::string gltf(const std::string& uri, const std::string& more = "") {
  std::string json = split_glb(testing_support::make_glb({})).json;
  const std::string length = R"("byteLength":168})";
  json.replace(json.find(length), length.size(), R"("byteLength":168,"uri":")" + uri + R"("})");
  json.insert(json.find('{') + 1, more);
  return json;
}

void put(const std::filesystem::path& file) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << split_glb(testing_support::make_glb({})).binary;
}

TEST_F(ForeignScene, OpensBuffersByUri) {
  for (const auto& [uri, name] : std::initializer_list<std::pair<const char*, const char*>>{
           {"my%20house.bin", "my house.bin"},
           {"h%C3%A4us.bin", "h\xC3\xA4us.bin"},
           {"buffers/b.bin", "buffers/b.bin"},
           {"./c.bin", "c.bin"},
           {"one/two/d%2ebin", "one/two/d.bin"},
           {"100%.bin", "100%.bin"}}) {
    put(folder_.path() / name);
    const Prior prior = read("scene.gltf", gltf(uri));
    EXPECT_LT((prior.box.sizes() - Vector3d(10, 10, 10)).norm(), 1e-5) << uri;
  }
}

TEST_F(ForeignScene, RejectsFilesOutsideFolder) {
  std::filesystem::create_directories(folder_.path() / "scene");
  put(folder_.path() / "secret.bin");
  for (const char* uri : {"../secret.bin", "..%2Fsecret.bin", "%2e%2e/secret.bin"}) {
    const auto file = folder_.file("scene/scene.gltf", gltf(uri));
    EXPECT_THAT(testing_support::thrown_message([&] { read_file(file); }),
                HasSubstr("could not open referenced file"))
        << uri;
  }
}

TEST_F(ForeignScene, RejectsUnknownRequiredExtensionsByName) {
  put(folder_.path() / "b.bin");
  for (const std::string name :
       {"KHR_mesh_quantization", "EXT_meshopt_compression", "CESIUM_RTC", "ACME_rotated_houses"}) {
    const std::string member = R"("extensionsRequired":[")" + name + R"("],)";
    EXPECT_THAT(error_message("scene.gltf", gltf("b.bin", member)),
                AllOf(HasSubstr("scene.gltf: requires the glTF extension " + name),
                      HasSubstr("save the scene without it")));
    // The same for the binary form.
    const Glb parts = split_glb(testing_support::make_glb({}));
    std::string json = parts.json;
    json.insert(json.find('{') + 1, member);
    while (json.size() % 4 != 0) json += ' ';
    std::string bytes = testing_support::make_glb({}).substr(0, 12);
    const auto append = [&](std::size_t number) {
      const auto value = static_cast<std::uint32_t>(number);
      bytes.append(reinterpret_cast<const char*>(&value), 4);
    };
    append(json.size());
    bytes += "JSON" + json;
    append(parts.binary.size());
    bytes += std::string("BIN\0", 4) + parts.binary;
    EXPECT_THAT(error_message("scene.glb", bytes),
                HasSubstr("requires the glTF extension " + name));
  }
  EXPECT_THAT(error_message("scene.gltf",
                            gltf("b.bin", R"("extensionsUsed":["EXT_mesh_gpu_instancing"],)")),
              HasSubstr("requires the glTF extension EXT_mesh_gpu_instancing"));
  EXPECT_THAT(error_message("scene.gltf",
                            gltf("b.bin", R"("extensions":{"CESIUM_RTC":{"center":[1,2,3]}},)")),
              HasSubstr("requires the glTF extension CESIUM_RTC"));
}

TEST_F(ForeignScene, AcceptsRequiredAppearanceExtensions) {
  put(folder_.path() / "b.bin");
  const Prior prior = read(
      "scene.gltf",
      gltf("b.bin", R"("extensionsRequired":["KHR_texture_transform","KHR_materials_unlit"],)"));
  EXPECT_LT((prior.box.sizes() - Vector3d(10, 10, 10)).norm(), 1e-5);
}

/// Returns a block of 8 x 10 x 12 m with lengths in a unit of `metres`.
std::string ifc(const std::string& unit, double metres, const std::string& more = "") {
  const auto length = [&](double in_metres) {
    std::string text = std::to_string(in_metres / metres);
    return text;
  };
  return "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
         "FILE_NAME('a.ifc','2024-01-01T00:00:00',(''),(''),'','','');\n"
         "FILE_SCHEMA(('IFC2X3'));\nENDSEC;\nDATA;\n"
         "#1=IFCPERSON($,$,'x',$,$,$,$,$);\n#2=IFCORGANIZATION($,'x',$,$,$);\n"
         "#3=IFCPERSONANDORGANIZATION(#1,#2,$);\n#4=IFCAPPLICATION(#2,'1','x','x');\n"
         "#5=IFCOWNERHISTORY(#3,#4,$,.ADDED.,$,$,$,0);\n" +
         unit +
         "#20=IFCCARTESIANPOINT((0.,0.,0.));\n#21=IFCDIRECTION((0.,0.,1.));\n"
         "#22=IFCDIRECTION((1.,0.,0.));\n#23=IFCAXIS2PLACEMENT3D(#20,#21,#22);\n"
         "#24=IFCGEOMETRICREPRESENTATIONCONTEXT($,'Model',3,1.E-5,#23,$);\n"
         "#30=IFCPROJECT('0000000000000000000001',#5,'p',$,$,$,$,(#24),#14);\n"
         "#42=IFCLOCALPLACEMENT($,#23);\n"
         "#43=IFCSITE('0000000000000000000002',#5,'s',$,$,#42,$,$,.ELEMENT.,$,$,0.,$,$);\n"
         "#44=IFCLOCALPLACEMENT(#42,#23);\n"
         "#45=IFCBUILDING('0000000000000000000003',#5,'b',$,$,#44,$,$,.ELEMENT.,$,$,$);\n"
         "#50=IFCLOCALPLACEMENT(#44,#23);\n#51=IFCCARTESIANPOINT((" +
         length(4.0) + "," + length(5.0) + "));\n#52=IFCAXIS2PLACEMENT2D(#51,$);\n" +
         "#53=IFCRECTANGLEPROFILEDEF(.AREA.,$,#52," + length(8.0) + "," + length(10.0) + ");\n" +
         "#54=IFCEXTRUDEDAREASOLID(#53,#23,#21," + length(12.0) + ");\n" +
         "#55=IFCSHAPEREPRESENTATION(#24,'Body','SweptSolid',(#54));\n"
         "#56=IFCPRODUCTDEFINITIONSHAPE($,$,(#55));\n"
         "#57=IFCBUILDINGELEMENTPROXY('0000000000000000000004',#5,'house',$,$,#50,#56,$,$);\n"
         "#60=IFCRELAGGREGATES('0000000000000000000005',#5,$,$,#30,(#43));\n"
         "#61=IFCRELAGGREGATES('0000000000000000000006',#5,$,$,#43,(#45));\n"
         "#62=IFCRELCONTAINEDINSPATIALSTRUCTURE('0000000000000000000007',#5,$,$,(#57),#45);\n" +
         more + "ENDSEC;\nEND-ISO-10303-21;\n";
}

std::string si(const std::string& prefix) {
  return "#10=IFCSIUNIT(*,.LENGTHUNIT.," + prefix + ",.METRE.);\n#14=IFCUNITASSIGNMENT((#10));\n";
}

std::string converted(const std::string& name, const std::string& factor,
                      const std::string& prefix) {
  return "#9=IFCSIUNIT(*,.PLANEANGLEUNIT.,$,.RADIAN.);\n"
         "#10 = IFCSIUNIT(*,.LENGTHUNIT.," +
         prefix +
         ",.METRE.);\n"
         "#11=IFCDIMENSIONALEXPONENTS(1,0,0,0,0,0,0);\n#12=IFCMEASUREWITHUNIT(IFCLENGTHMEASURE(" +
         factor + "),#10);\n#13=IFCCONVERSIONBASEDUNIT(#11,.LENGTHUNIT.,'" + name +
         "',#12);\n#14=IFCUNITASSIGNMENT((#9,#13));\n";
}

TEST_F(ForeignScene, ReadsUnitsOfIfc) {
  const struct {
    std::string unit;
    double metres;
  } units[] = {{si("$"), 1.0},
               {si(".MILLI."), 0.001},
               {converted("FOOT", "0.3048", "$"), 0.3048},
               {converted("INCH", "25.4", ".MILLI."), 0.0254},
               {converted("US SURVEY FOOT", "3.048006E-1", "$"), 0.3048006}};
  for (const auto& [unit, metres] : units) {
    const Prior prior = read("a.ifc", ifc(unit, metres));
    EXPECT_LT((prior.box.sizes() - Vector3d(8, 10, 12)).norm(), 1e-3) << unit;
  }
  const Prior marked = read("a.ifc", "\xEF\xBB\xBF" + ifc(si("$"), 1.0));
  EXPECT_LT((marked.box.sizes() - Vector3d(8, 10, 12)).norm(), 1e-3);
}

TEST_F(ForeignScene, RejectsIfcWithoutKnownUnit) {
  const std::string unknown =
      "#10=IFCSIUNIT(*,.AREAUNIT.,$,.SQUARE_METRE.);\n#14=IFCUNITASSIGNMENT((#10));\n";
  EXPECT_THAT(error_message("a.ifc", ifc(unknown, 1.0)), HasSubstr("has no linear unit; set unit"));
  EXPECT_LT((read("a.ifc", ifc(unknown, 0.5), 0.5).box.sizes() - Vector3d(8, 10, 12)).norm(), 1e-3);
}

TEST_F(ForeignScene, ReportsMapPositionOfIfc) {
  const Prior prior =
      read("a.ifc", ifc(si("$"), 1.0,
                        "#70=IFCPROJECTEDCRS('EPSG:25832',$,$,$,$,$,$);\n"
                        "#71=IFCMAPCONVERSION(#24,#70,678193.,5404280.,420.,1.,0.,$);\n"));
  EXPECT_THAT(prior.notes,
              Contains(AllOf(HasSubstr("IfcMapConversion"), HasSubstr("678193 5404280 420"),
                             HasSubstr("EPSG:25832"), HasSubstr("set crs, vertical and offset"))));
  const Prior older = read(
      "a.ifc", ifc(si("$"), 1.0,
                   "#80=IFCPROPERTYSINGLEVALUE('Eastings',$,IFCREAL(678193.),$);\n"
                   "#81=IFCPROPERTYSET('0000000000000000000009',#5,'ePSet_MapConversion',$,(#80));"
                   "\n"));
  EXPECT_THAT(older.notes, Contains(HasSubstr("(ePset_MapConversion), which is not supported")));
}

}  // namespace
}  // namespace skycap::missions::site_data
