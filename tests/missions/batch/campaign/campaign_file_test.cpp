// Contents of a campaign and rejected campaign files.
#include "missions/batch/campaign/campaign_file.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "missions/config/mission_reader.h"
#include "missions/support/flow_text.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions::batch {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string rejection_message(const std::string& text) {
  try {
    parse_campaign(text, "c.yaml");
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

const char* const two_by_two =
    "missions: [a.yaml, town/b.yaml]\n"
    "planners: [oa, see++]\n"
    "seeds: 2\n"
    "first_seed: 5\n"
    "set: {limits.max_views: 9}\n"
    "variants:\n"
    "  plain: {}\n"
    "  dense: {planner: {density: 213}, start.position: [1, 2, 3.5]}\n";

TEST(Campaign, ExpandsToProductOfLists) {
  const Manifest manifest(parse_campaign(two_by_two, "folder/c.yaml"));
  EXPECT_EQ(manifest.file().name, "c");
  EXPECT_EQ(manifest.file().folder, "folder");
  ASSERT_EQ(manifest.size(), 16U);  // 2 missions, 2 variants, 2 planners, 2 seeds
  std::vector<std::string> folders;
  for (std::size_t i = 0; i < manifest.size(); ++i) {
    EXPECT_EQ(manifest.line(i).number, i);
    folders.push_back(manifest.line(i).folder());
  }
  EXPECT_THAT(folders, ElementsAre("items/a/plain/see++/seed_5", "items/a/plain/oa/seed_5",
                                   "items/a/dense/see++/seed_5", "items/a/dense/oa/seed_5",
                                   "items/b/plain/see++/seed_5", "items/b/plain/oa/seed_5",
                                   "items/b/dense/see++/seed_5", "items/b/dense/oa/seed_5",
                                   "items/a/plain/see++/seed_6", "items/a/plain/oa/seed_6",
                                   "items/a/dense/see++/seed_6", "items/a/dense/oa/seed_6",
                                   "items/b/plain/see++/seed_6", "items/b/plain/oa/seed_6",
                                   "items/b/dense/see++/seed_6", "items/b/dense/oa/seed_6"));
  EXPECT_EQ(manifest.line(7).json(),
            R"({"item":7,"mission":"town/b.yaml","variant":"dense","planner":"oa","seed":5,)"
            R"("set":{"limits.max_views":"9","planner.density":"213",)"
            R"("start.position":"[1, 2, 3.5]"},"folder":"items/b/dense/oa/seed_5"})");
}

TEST(Campaign, RequiresOnlyMissions) {
  const Manifest manifest(parse_campaign("missions: [a.yaml]\n", "c.yaml"));
  ASSERT_EQ(manifest.size(), 10U);
  EXPECT_EQ(manifest.line(3).folder(), "items/a/own/seed_4");
  EXPECT_TRUE(manifest.entry(0).planner.empty());
  EXPECT_EQ(manifest.file().results, ItemResults::figures);
}

TEST(Campaign, AppendsRunsWhenSeedsAreAdded) {
  const Manifest few(parse_campaign(two_by_two, "c.yaml"));
  const std::string text = two_by_two;
  const Manifest more(
      parse_campaign(std::string(text).replace(text.find("seeds: 2"), 8, "seeds: 7"), "c.yaml"));
  EXPECT_EQ(more.size(), 56U);
  EXPECT_THAT(more.text(), testing::StartsWith(few.text()));
}

// Each run of a range belongs to one entry and occurs once.
TEST(Campaign, DividesRangesAmongEntries) {
  const Manifest manifest(parse_campaign(two_by_two, "c.yaml"));
  for (std::size_t first = 0; first < manifest.size(); ++first) {
    for (std::size_t end = first; end <= manifest.size(); ++end) {
      std::vector<std::size_t> numbers;
      for (std::size_t entry = 0; entry < manifest.entries(); ++entry) {
        for (const std::size_t n : manifest.entry_run_numbers(entry, {first, end})) {
          EXPECT_EQ(n % manifest.entries(), entry);
          numbers.push_back(n);
        }
      }
      std::ranges::sort(numbers);
      ASSERT_EQ(numbers.size(), end - first);
      for (std::size_t i = 0; i < numbers.size(); ++i) ASSERT_EQ(numbers[i], first + i);
    }
  }
}

// Property: a value that is written in one line and read again is unchanged.
TEST(Campaign, WritesYamlValuesUnchanged) {
  for (const char* value :
       {"1", "-2.5e-3", "'7'", "true", "see++", "'a, b]: \"c\" # d'", "builtin:teapot",
        "[1, [2, '3'], {a: b, 'c d': ~}]", "{x: [], y: {}}", "''", "\"tab\\tand\\x7f\""}) {
    const support::YamlNode node = support::parse_yaml(value, "v");
    const std::string text = support::flow_text(node);
    const support::YamlNode again = support::parse_yaml(text, "v");
    EXPECT_EQ(support::flow_text(again), text) << value;
    EXPECT_EQ(again.kind, node.kind) << value;
    EXPECT_EQ(again.text, node.text) << value;
    EXPECT_EQ(again.items.size(), node.items.size()) << value;
    EXPECT_EQ(again.entries.size(), node.entries.size()) << value;
    EXPECT_TRUE(again.is_quoted || !node.is_quoted) << value;
  }
}

TEST(Campaign, RejectsInvalidKeysWithLineNumber) {
  EXPECT_THAT(rejection_message("[a]"), HasSubstr("c.yaml:1: is not a map"));
  EXPECT_THAT(rejection_message("name: x\n"),
              HasSubstr("c.yaml:1: key missions is missing or empty"));
  EXPECT_THAT(rejection_message("missions: [a.yaml]\nseed: 3\n"),
              HasSubstr("c.yaml:2: key seed is unknown; expected one of: first_seed, missions"));
  EXPECT_THAT(rejection_message("missions: [a.yaml]\nseeds: 0\n"),
              HasSubstr("c.yaml:2: key seeds is 0; it must be from 1 to 100000"));
  EXPECT_THAT(
      rejection_message("missions: [a.yaml]\nplanners: [frontier]\n"),
      HasSubstr("c.yaml:2: key planners: unknown planner 'frontier'; expected all or names"));
  const testing_support::TemporaryFolder folder;
  const std::string code = folder.file("mine_alone.py", "").string();
  EXPECT_THAT(rejection_message("missions: [a.yaml]\nplanners: [" + code + "]\n"),
              HasSubstr("c.yaml:2: key planners: mine_alone.py is code, which campaigns do not"));
  EXPECT_THAT(rejection_message("missions: [a.yaml]\nset:\n  planner.densty: 3\n"),
              HasSubstr("c.yaml:3: key set.planner.densty is unknown"));
  EXPECT_THAT(rejection_message("missions: [a.yaml]\nvariants:\n  v: {seed: 3}\n"),
              HasSubstr("c.yaml:3: key variants.v.seed follows from the campaign"));
  EXPECT_THAT(rejection_message("missions: [a.yaml]\nvariants:\n  ../v: {}\n"),
              HasSubstr("c.yaml:3: key variants.../v is not a valid folder name"));
  EXPECT_THAT(rejection_message("missions: [a.yaml]\nvariants:\n  v: 3\n"),
              HasSubstr("c.yaml:3: key variants.v must be a map"));
  EXPECT_THAT(rejection_message("missions: [a.yaml, b/a.yaml]\n"),
              HasSubstr("a.yaml and b/a.yaml have the same name"));
  EXPECT_THAT(rejection_message("missions: ['a,b.yaml']\n"),
              HasSubstr("must have a name that can be used in tables"));
  EXPECT_THAT(rejection_message("missions: ['..']\n"),
              HasSubstr("must have a name that can be used in tables"));
  EXPECT_THAT(rejection_message("missions: [a.yaml]\nname: ../../etc\n"),
              HasSubstr("c.yaml:2: key name is not a valid folder name"));
  EXPECT_THAT(rejection_message("missions: [a.yaml]\nresults: all\n"),
              HasSubstr("c.yaml:2: key results is all; it must be one of figures, package"));
}

TEST(Campaign, RejectsMoreRunsThanMaximum) {
  std::string missions = "m0.yaml";
  for (int i = 1; i < 12; ++i) missions += ", m" + std::to_string(i) + ".yaml";
  EXPECT_THAT(rejection_message("missions: [" + missions + "]\nseeds: 100000\n"),
              HasSubstr("exceeds the limit of 1000000"));
}

// Invalid values are detected when a mission is read with them. The message contains their line.
TEST(Campaign, NamesLineOfInvalidChanges) {
  const CampaignFile file =
      parse_campaign("missions: [a.yaml]\nvariants:\n  v:\n    planner.density: much\n", "c.yaml");
  const std::string mission =
      "scene: {model: 'builtin:teapot'}\nevaluation: {coverage_distance: 0.03}\n";
  try {
    config::parse_mission_document(mission, "m.yaml", file.variants.at(0).changes);
    FAIL() << "was taken";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("c.yaml:4: key planner.density is much; it must be"));
  }
}

}  // namespace
}  // namespace skycap::missions::batch
