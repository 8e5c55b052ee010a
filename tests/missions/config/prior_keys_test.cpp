// The key `prior`: a list of maps with their own key table.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "geometry/error.h"
#include "missions/config/mission_keys.h"
#include "missions/config/mission_reader.h"
#include "missions/config/setting_json.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

const std::string mission =
    "scene: {model: 'builtin:teapot'}\nevaluation: {coverage_distance: 0.005}\n";

config::MissionDocument parsed(const std::string& more) {
  return config::parse_mission_document(mission + more, "m.yaml");
}

std::string error_message(const std::string& more) {
  return testing_support::thrown_message([&] { parsed(more); });
}

TEST(PriorKeys, SetEveryFieldOfSource) {
  const config::MissionDocument given = parsed(
      "prior:\n"
      "  - {file: tile.gml, role: obstacle, select: {lod: 2, id: [A1, B2]}}\n"
      "  - file: yard.kml\n"
      "    role: target\n"
      "    base: terrain\n"
      "    height: 18\n"
      "    height_attribute: HEIGHT_M\n"
      "    uncertainty: 1.5\n"
      "    select: {attribute: {use: church}, layer: roofs, within: area.geojson}\n"
      "  - {file: scan.laz, role: truth, crs: 'EPSG:25832+7837', vertical: geoid,\n"
      "     select: {classes: [2, 5]}, spacing: 0.5, offset: [1, 2, 3]}\n"
      "  - {file: a.obj, role: terrain, place: {position: [4, 5, 6], heading_deg: 90},\n"
      "     up_axis: y, unit: 0.3048, base: 2.5, min_height: 1}\n");
  const std::vector<site_data::Source>& sources = given.prior;
  ASSERT_EQ(sources.size(), 4U);
  EXPECT_EQ(sources[0].file, "tile.gml");
  EXPECT_EQ(sources[0].role, site_data::Role::obstacle);
  EXPECT_THAT(sources[0].select.ids, ElementsAre("A1", "B2"));
  EXPECT_EQ(sources[0].select.lod, 2.0);
  EXPECT_TRUE(sources[1].base_on_terrain);
  EXPECT_EQ(sources[1].height, 18.0);
  EXPECT_EQ(sources[1].height_attribute, "HEIGHT_M");
  EXPECT_EQ(sources[1].uncertainty, 1.5);
  EXPECT_EQ(sources[1].select.attributes.at("use"), "church");
  EXPECT_EQ(sources[1].select.layer, "roofs");
  EXPECT_EQ(sources[1].select.within, "area.geojson");
  EXPECT_EQ(sources[2].crs, "EPSG:25832+7837");
  EXPECT_EQ(sources[2].vertical, site_data::HeightDatum::geoid);
  EXPECT_THAT(sources[2].select.classes, ElementsAre(2, 5));
  EXPECT_EQ(sources[2].spacing, 0.5);
  EXPECT_EQ(sources[2].offset, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(sources[3].pose.value().position, Eigen::Vector3d(4, 5, 6));
  EXPECT_NEAR(sources[3].pose.value().heading, 90 * geometry::radians_per_degree, 1e-12);
  EXPECT_EQ(sources[3].is_y_up, true);
  EXPECT_EQ(sources[3].unit, 0.3048);
  EXPECT_EQ(sources[3].base, 2.5);
  EXPECT_EQ(sources[3].min_height, 1.0);
  EXPECT_EQ(given.locations.at("prior[1].height"), "m.yaml:8");
}

// The mission in a package contains the same sources.
TEST(PriorKeys, RejectFractionsInListsOfIntegers) {
  EXPECT_NO_THROW(parsed("prior: [{file: x.las, role: truth, select: {classes: [2]}}]\n"));
  EXPECT_THROW(parsed("prior: [{file: x.las, role: truth, select: {classes: [2.5]}}]\n"), Error);
}

TEST(PriorKeys, ReadBackFromSettings) {
  const config::MissionDocument given = parsed(
      "prior: [{file: tile.gml, role: target, base: terrain, place: {heading_deg: 90}},\n"
      "        {file: x.las, role: obstacle, select: {classes: [6], attribute: {a: b}}}]\n");
  const config::Key& key = *config::find_key("prior");
  const std::string text = config::to_text(*key.get(given));
  const config::MissionDocument again = parsed("prior: " + text + "\n");
  EXPECT_EQ(config::to_text(*key.get(again)), text);
  EXPECT_EQ(again.prior.size(), 2U);
  EXPECT_TRUE(again.prior[0].base_on_terrain);
  EXPECT_EQ(text.find("uncertainty"), std::string::npos) << "what was not given is not said";
}

TEST(PriorKeys, ReportInvalidValuesWithLine) {
  EXPECT_EQ(error_message("prior: {file: a.obj}\n"),
            "m.yaml:3: key prior is a map; it must be a list of YAML mappings, each with file, "
            "role and further keys");
  EXPECT_EQ(error_message("prior: [a.obj]\n"), "m.yaml:3: key prior[0] is a.obj; it must be a map");
  EXPECT_THAT(error_message("prior:\n  - {file: a.obj, role: target}\n  - {role: target}\n"),
              StartsWith("m.yaml:5: key prior[1].file is missing; it must be a string"));
  EXPECT_THAT(
      error_message("prior:\n  - file: a.obj\n    role: wall\n"),
      StartsWith(
          "m.yaml:5: key prior[0].role is wall; it must be target, obstacle, terrain or truth"));
  EXPECT_THAT(error_message("prior: [{file: a.obj, role: target, hight: 3}]\n"),
              HasSubstr("key prior[0].hight is unknown; did you mean height?"));
  EXPECT_THAT(error_message("prior: [{file: a.obj, role: target, base: sea}]\n"),
              HasSubstr("key prior[0].base is sea; it must be terrain or a number"));
  EXPECT_THAT(error_message("prior: [{file: a.obj, role: target, select: all}]\n"),
              HasSubstr("key prior[0].select is a section"));
}

// Malicious values for each key of a source are rejected with the key, or accepted within its
// range.
TEST(PriorKeys, RejectHostileValues) {
  const std::vector<std::string> hostile = {"",
                                            "~",
                                            "nan",
                                            "-.inf",
                                            "1e999",
                                            "0x10",
                                            "'1'",
                                            "\"a\\nb\"",
                                            "{}",
                                            "[]",
                                            "{a: {b: c}}",
                                            "[[1]]",
                                            "*x",
                                            "&x 1",
                                            "!!int 1",
                                            "[1e999, 0, 0]",
                                            "-1e30",
                                            "1e30",
                                            "[-1]",
                                            "[1.5]",
                                            "[999999999999]",
                                            "[~]",
                                            "{1: [2]}"};
  std::size_t rejected = 0;
  for (const config::Key& key : config::find_key("prior")->items) {
    for (const std::string& value : hostile) {
      std::string path = key.path, open;
      for (auto dot = path.find('.'); dot != std::string::npos; dot = path.find('.')) {
        open += path.substr(0, dot) + ":\n" + std::string(open.empty() ? 6 : 8, ' ');
        path.erase(0, dot + 1);
      }
      std::string text = "prior:\n  - ";
      if (key.path != "file") text += "file: a.obj\n    ";
      if (key.path != "role") text += "role: target\n    ";
      text += open + path + ": " + value + "\n";
      try {
        const config::MissionDocument taken = parsed(text);
        const auto number = key.get(taken);
        if (!number || !std::holds_alternative<double>(*number)) continue;
        EXPECT_GE(std::get<double>(*number), key.range.min) << text;
        EXPECT_LE(std::get<double>(*number), key.range.max) << text;
      } catch (const Error& error) {
        ++rejected;
        EXPECT_THAT(error.what(), StartsWith("m.yaml:")) << text;
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << text;
      }
    }
  }
  EXPECT_GT(rejected, 200U);
}

}  // namespace
}  // namespace skycap::missions
