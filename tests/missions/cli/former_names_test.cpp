// Names of version 0.1 in command lines, campaigns and districts.
#include "missions/config/former_names.h"

#include <algorithm>
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "missions/batch/benchmark/methods.h"
#include "missions/batch/campaign/campaign_file.h"
#include "missions/batch/district/district_file.h"
#include "tests/missions/former_names/former_mission.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using tests::former_mission;
using tests::read_content;
using tests::run_skycap;

TEST(FormerNames, GiveSameResultsAsCurrentNames) {
  const tests::TestFolder folder;
  for (const char* name : {"former", "current"}) std::filesystem::create_directory(folder / name);
  const std::string former = folder.write("former/m.yaml", former_mission);
  const std::string current =
      folder.write("current/m.yaml", config::with_current_names(former_mission, "m.yaml"));
  for (const std::string& mission : {former, current}) {
    const auto run = run_skycap({"plan", mission, "--quiet", "--no-report", "--out",
                                 std::filesystem::path(mission).parent_path() / "out"});
    ASSERT_EQ(run.exit_code, 0) << run.err;
  }
  for (const char* file : {"views.csv", "cloud.ply", "trajectory.tum"}) {
    EXPECT_EQ(read_content(folder / ("former/out/" + std::string(file))),
              read_content(folder / ("current/out/" + std::string(file))));
  }
  using Json = nlohmann::ordered_json;
  EXPECT_EQ(Json::parse(read_content(folder / "former/out/summary.json"))["settings"],
            Json::parse(read_content(folder / "current/out/summary.json"))["settings"]);
}

TEST(FormerNames, CauseOneWarningPerFile) {
  const tests::TestFolder folder;
  const std::string mission = folder.write("m.yaml", former_mission);
  const auto run = run_skycap({"check", mission, "--setup", "--set", "planner.least_gain=0.02"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(std::ranges::count(run.err, '\n'), 2);
  EXPECT_THAT(run.err,
              AllOf(HasSubstr("m.yaml:6: uses names of version 0.1: planner.wanted_coverage "
                              "is now planner.target_coverage, "),
                    HasSubstr("--rewrite FILE"),
                    HasSubstr("--set: planner.least_gain is now planner.min_gain")));
}

TEST(FormerNames, AreRewrittenByCheckCommand) {
  const tests::TestFolder folder;
  const std::string mission = folder.write("m.yaml", former_mission);
  const auto run = run_skycap({"check", mission, "--rewrite", folder / "new.yaml"});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(read_content(folder / "new.yaml"), config::with_current_names(former_mission, "m"));
  EXPECT_EQ(read_content(mission), former_mission);
  EXPECT_THAT(run_skycap({"check", folder / "new.yaml", "--setup"}).err, Not(HasSubstr("warning")));
  folder.write("broken.yaml", "evaluation: {registration_distance: -1}\n");
  EXPECT_EQ(
      run_skycap({"check", folder / "broken.yaml", "--rewrite", folder / "no.yaml"}).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(folder / "no.yaml"));
}

TEST(FormerNames, AreAcceptedAsOptionsWithWarning) {
  const auto check = run_skycap({"check", "no.yaml", "--return-height=30"});
  EXPECT_EQ(check.err,
            "skycap: warning: --return-height is now --return-altitude; version 0.3 will not "
            "accept former names\n" +
                run_skycap({"check", "no.yaml", "--return-altitude=30"}).err);
  const auto plan = run_skycap({"plan", "no.yaml", "--dry-run", "prior"});
  EXPECT_THAT(plan.err, HasSubstr("--dry-run prior is now --use-prior-as-truth"));
  EXPECT_THAT(plan.err, HasSubstr(run_skycap({"plan", "no.yaml", "--use-prior-as-truth"}).err));
}

TEST(FormerNames, AreReadInCampaignsAndDistricts) {
  const batch::CampaignFile campaign = batch::parse_campaign(
      "missions: [a.yaml]\nplanners: [see++, omniscient]\nset: {planner.least_gain: 0.1}\n"
      "variants: {slow: {flight: {views: anew}}}\n",
      "c.yaml");
  EXPECT_THAT(campaign.planners, testing::ElementsAre("see++", "oracle"));
  ASSERT_EQ(campaign.variants.at(0).changes.size(), 2U);
  EXPECT_EQ(campaign.variants[0].changes[0].path, "planner.min_gain");
  EXPECT_EQ(campaign.variants[0].changes[1].value, "replanned");
  const batch::DistrictFile district =
      batch::parse_district("map: a.json\ntogether: 2\nplanner: omniscient\n", "d.yaml");
  EXPECT_EQ(district.merge_distance, 2.0);
  EXPECT_EQ(district.planner, "oracle");
  EXPECT_EQ(batch::find_method("omniscient"), batch::find_method("oracle"));
}

}  // namespace
}  // namespace skycap::missions
