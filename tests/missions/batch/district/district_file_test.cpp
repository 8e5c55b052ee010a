#include "missions/batch/district/district_file.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/complaint.h"

namespace skycap::missions::batch {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;
using testing_support::thrown_message;

std::string error_message(const std::string& text) {
  return thrown_message([&] { parse_district(text, "town/quarter.yaml"); });
}

TEST(DistrictFile, HasDefaultsWhenOnlyMapIsSet) {
  const DistrictFile district = parse_district("map: town.gml\n", "town/quarter.yaml");
  EXPECT_EQ(district.name, "quarter");
  EXPECT_EQ(district.request.map, "town/town.gml");
  EXPECT_EQ(district.request.vehicle, "generic");
  EXPECT_EQ(district.planner, "skycap");
  EXPECT_EQ(district.seed, 1U);
  EXPECT_EQ(district.merge_distance, 0.5);
  EXPECT_THAT(district.targets.ids, IsEmpty());
  EXPECT_THAT(district.pads, IsEmpty());
  EXPECT_THAT(district.set, IsEmpty());
}

TEST(DistrictFile, ReadsAllKeys) {
  const DistrictFile district = parse_district(
      "name: old_town\nmap: town.gml\ncrs: 'EPSG:25832'\nvertical: geoid\nbase: 380\nheight: 9\n"
      "terrain: dtm.tif\nobstacles: [trees.las]\n"
      "targets: {id: [a, b], attribute: {use: school}, within: ['48.1,11.1', '48.2, 11.3'],\n"
      "          near: '48.15,11.2', distance: 250}\n"
      "merge_distance: 0\npads: ['48.15,11.21', '48.16,11.22']\nvehicle: m350_rtk\nplanner: see++\n"
      "seed: 7\nset: {limits.max_views: 9, flight: {clearance: 3}}\n",
      "quarter.yaml");
  EXPECT_EQ(district.name, "old_town");
  EXPECT_EQ(district.request.import_options.crs, "EPSG:25832");
  EXPECT_EQ(district.request.import_options.vertical, site_data::HeightDatum::geoid);
  EXPECT_EQ(district.request.import_options.base, 380.0);
  EXPECT_EQ(district.request.import_options.height, 9.0);
  EXPECT_EQ(district.request.terrain, "dtm.tif");
  EXPECT_THAT(district.request.obstacles, ElementsAre("trees.las"));
  const TargetChoice& targets = district.targets;
  EXPECT_THAT(targets.ids, ElementsAre("a", "b"));
  EXPECT_EQ(targets.attributes.at("use"), "school");
  ASSERT_EQ(targets.within.size(), 2U);
  EXPECT_EQ(targets.within[1].longitude_deg, 11.3);
  EXPECT_EQ(targets.near.value().latitude_deg, 48.15);
  EXPECT_EQ(targets.distance, 250.0);
  EXPECT_EQ(district.merge_distance, 0.0);
  ASSERT_EQ(district.pads.size(), 2U);
  EXPECT_EQ(district.pads[1].latitude_deg, 48.16);
  EXPECT_EQ(district.request.vehicle, "m350_rtk");
  EXPECT_EQ(district.planner, "see++");
  EXPECT_EQ(district.seed, 7U);
  ASSERT_EQ(district.set.size(), 2U);
  EXPECT_EQ(district.set[1].path, "flight.clearance");
  EXPECT_EQ(district.set[1].value, "3");
}

struct ExpectedError {
  std::string text, program_output;
};

TEST(DistrictFile, ReportsErrorsWithRemedies) {
  const std::vector<ExpectedError> expected_errors{
      {"pads: []\n", "key map is missing"},
      {"map: a\nvertical: takeoff\n", ":2: key vertical is takeoff; it must be one of ellipsoid"},
      {"map: a\nheight: -2\n", ":2: key height is -2 m; it must be from 0.01 to 10000"},
      {"map: a\nname: a/b\n", ":2: key name is not a valid folder name; use at most"},
      {"map: a\ntargets: {within: ['48,11']}\n",
       ":2: key targets.within has 1 positions; list two opposite corners of a box"},
      {"map: a\ntargets: {near: '48,11'}\n",
       ":2: key targets.near requires both near (a position) and distance"},
      {"map: a\ntargets: {near: here, distance: 5}\n",
       ":2: key targets.near has here; it must be LATITUDE,LONGITUDE in degrees"},
      {"map: a\ntargets: {near: '48,11', distance: -5}\n",
       ":2: key targets.distance is -5 m; it must be from 0 to 50000"},
      {"map: a\ntargets: {ids: [b]}\n", ":2: key targets.ids is unknown"},
      {"map: a\npads: [[48, 11]]\n", ":2: key pads"},
      {"map: a\npads: ['91,0']\n", ":2: key pads has 91,0; it must be LATITUDE,LONGITUDE"},
      {"map: a\nmerge_distance: 200\n",
       ":2: key merge_distance is 200 m; it must be from 0 to 100"},
      {"map: a\nplanner: best\n", ":2: key planner is best; it must be one of see++"},
      {"map: a\nseed: -1\n", ":2: key seed is -1; it must be 0 or more"},
      {"map: a\nset: {flight.takeoff: [0, 0, 0]}\n",
       ":2: key set.flight.takeoff follows from the district's files, targets, pads"},
      {"map: a\nset: {scene: {model: x}}\n", ":2: key set.scene.model follows from the district"},
      {"map: a\nset: {limits.most_views: 3}\n", ":2: key set.limits.most_views is unknown"},
      {"map: a\nfleet: 2\n", ":2: key fleet is unknown"},
      {"[a, b]\n", ":1: is not a map; a district must consist of 'key: value' lines"}};
  for (const ExpectedError& one : expected_errors) {
    EXPECT_THAT(error_message(one.text),
                AllOf(StartsWith("town/quarter.yaml:"), HasSubstr(one.program_output)))
        << one.text;
  }
}

}  // namespace
}  // namespace skycap::missions::batch
