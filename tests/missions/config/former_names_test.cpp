#include "missions/config/former_names.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/io/file.h"
#include "missions/config/mission_keys.h"
#include "missions/config/resolve.h"
#include "missions/config/setup_text.h"
#include "missions/package/former_fields.h"
#include "missions/package/package.h"
#include "tests/missions/former_names/former_mission.h"
#include "tests/support/complaint.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;
using tests::former_mission;

const std::filesystem::path source = SKYCAP_SOURCE_DIR;
const std::string smallest =
    "scene: {model: 'builtin:teapot'}\nevaluation: {coverage_distance: 0.03}\n";
const std::filesystem::path former_missions = source / "tests/missions/former_names/missions";

std::string read_content(const std::filesystem::path& file) {
  return geometry::read_file(file, 1 << 24);
}

config::MissionSetup make_setup(const std::string& text) {
  return config::parse_mission(text, "m.yaml");
}

TEST(FormerNames, GiveSameSetupsForShippedMissions) {
  std::size_t missions = 0;
  for (const auto& entry : std::filesystem::directory_iterator(former_missions)) {
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(config::setup_text(config::read_mission(entry.path())),
              config::setup_text(config::read_mission(source / "missions" / name)))
        << name;
    ++missions;
  }
  EXPECT_EQ(missions, 9U);
}

TEST(FormerNames, AreRewrittenToShippedMissions) {
  for (const auto& entry : std::filesystem::directory_iterator(former_missions)) {
    const std::string name = entry.path().filename().string();
    EXPECT_EQ(config::with_current_names(read_content(entry.path()), name),
              read_content(source / "missions" / name));
  }
}

TEST(FormerNames, AreAllRewrittenWithoutOtherChanges) {
  const std::string current = config::with_current_names(former_mission, "m.yaml");
  EXPECT_EQ(config::setup_text(make_setup(current)),
            config::setup_text(make_setup(former_mission)));
  EXPECT_EQ(config::with_current_names(current, "m.yaml"), current);
  EXPECT_THAT(current, HasSubstr("  target_coverage: 0.9   # least_gain: 0.5 is not it\n"
                                 "  'min_gain' : 0.01\n"
                                 "  ablation:\n"
                                 "    coverage_model: true\n"
                                 "    batch: false\n"
                                 "  still_occluded: defer  # put_off\n"));
  EXPECT_THAT(current, HasSubstr("      floor: -1\n      ceiling: 3\n"));
  EXPECT_THAT(current, HasSubstr("# A tower.  Its planner.least_gain stays in this comment.\n"));
}

TEST(FormerNames, AreReadAsValues) {
  const auto value = [](const config::Key& key, const std::string& text) {
    const auto found = key.get(config::parse_mission_document(
        smallest, "m.yaml",
        {{"--set", "flight.vehicles", "[generic, generic]"}, {"--set", key.path, text}}));
    return found ? config::to_text(*found) : "-";
  };
  const std::pair<const char*, std::pair<const char*, const char*>> values[] = {
      {"planner.still_occluded", {"put_off", "defer"}},
      {"flight.views", {"anew", "replanned"}},
      {"flight.fleet_goal", {"flown", "total_time"}},
      {"flight.style", {"pass", "fly-through"}}};
  for (const auto& [key, names] : values) {
    const config::Key& known = *config::find_key(key);
    EXPECT_EQ(value(known, names.first), names.second);
    EXPECT_EQ(value(known, names.second), names.second);
  }
}

TEST(FormerNames, AreRejectedTogetherWithCurrentNames) {
  const auto error_message = [](const std::string& section) {
    return testing_support::thrown_message(
        [&] { make_setup("scene: {model: 'builtin:teapot'}\nevaluation:\n" + section); });
  };
  EXPECT_THAT(error_message("  coverage_distance: 0.03\n  registration_distance: 0.03\n"),
              HasSubstr("m.yaml:4: key evaluation.registration_distance is now "
                        "evaluation.coverage_distance, which is also set; remove one of them"));
}

TEST(FormerNames, AreNotRewrittenWhenAmbiguous) {
  EXPECT_THAT(testing_support::thrown_message([] {
                config::with_current_names(
                    "{scan: {orbit: {radius: 3}}, evaluation: {radius: 1}}\n", "m.yaml");
              }),
              HasSubstr("write each key on a separate line"));
}

// A summary written by version 0.1, from the fuzzing corpus.
TEST(FormerFields, AreReadInPackages) {
  const std::filesystem::path file = source / "tests/fuzz/corpus/summary/package.json";
  ASSERT_THAT(read_content(file), HasSubstr("\"version\": \"0.1.0\""));
  const package::PackageSummary summary =
      package::parse_package_summary(read_content(file), file.string());
  EXPECT_FALSE(summary.views.empty());
  EXPECT_GT(summary.mission.evaluation().registration_distance, 0.0);
}

TEST(FormerFields, AreConvertedToCurrentNamesAndValues) {
  using Json = nlohmann::ordered_json;
  Json former = Json::parse(R"({
    "coverage_ceiling": 0.9, "stop_reason": "nowhere_to_go", "planner": "anew",
    "belief": {"stop": "little_gain", "predicted_coverage": 0.8, "missing": {"never_seen": 0.1},
               "reliability": {"bands": [{"believed": 0.1}]}},
    "surface": {"holes": [{"reason": "seen_too_thinly"}]},
    "flight": {"anew": {"anew": {"promised_coverage": 0.7}}, "route": {"unreached": []}},
    "settings": {"planner.ideas.dose": true}})");
  package::use_current_fields(former);
  const Json current = Json::parse(R"({
    "attainable_coverage": 0.9, "stop_reason": "no_reachable_view", "planner": "anew",
    "estimate": {"stop": "min_gain", "estimated_coverage": 0.8, "missing": {"unobserved": 0.1},
                 "reliability": {"bands": [{"estimated": 0.1}]}},
    "surface": {"holes": [{"reason": "undersampled"}]},
    "flight": {"replanned": {"replanned": {"predicted_coverage": 0.7}},
               "route": {"skipped_views": []}},
    "settings": {"planner.ablation.coverage_model": true}})");
  EXPECT_EQ(former.dump(), current.dump());
  Json again = current;
  package::use_current_fields(again);
  EXPECT_EQ(again.dump(), current.dump());
}

}  // namespace
}  // namespace skycap::missions
