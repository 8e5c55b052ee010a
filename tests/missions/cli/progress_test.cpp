// Progress output in terminals and in logs.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "missions/cli/stage_clock.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

using cli::StageClock;
using testing::HasSubstr;
using testing::Not;

TEST(StageClock, TellsRateAndRemainingTimeOfAStage) {
  StageClock clock;
  clock.hear("vase: view 10 of at most 50, 900 points", 100.0);
  EXPECT_EQ(clock.rate_text(), "");
  clock.hear("vase: view 20 of at most 50, 1500 points", 104.0);
  EXPECT_EQ(clock.rate_text(), ", 2.5/s, at most 12 s left");
  // The rate of a new stage does not depend on the previous stage.
  clock.hear("vase: writing 5 of 10", 110.0);
  EXPECT_EQ(clock.rate_text(), "");
  clock.hear("vase: writing 6 of 10", 130.0);
  EXPECT_EQ(clock.rate_text(), ", 0.05/s, 80 s left");
  EXPECT_EQ(clock.elapsed(), 30.0);
}

TEST(StageClock, TellsTheRemainingTimeOfShares) {
  StageClock clock;
  clock.hear("a.las: 10 %", 0.0);
  clock.hear("a.las: 30 %", 200.0);
  EXPECT_EQ(clock.rate_text(), ", 12 min left");
}

TEST(StageClock, LeavesTextsAloneThatCountNothingOrTellTheTime) {
  StageClock clock;
  clock.hear("loading scene", 0.0);
  clock.hear("loading scene", 9.0);
  EXPECT_EQ(clock.rate_text(), "");
  clock.hear("plan: 1 of 9 surveys, about 3 min left", 10.0);
  clock.hear("plan: 2 of 9 surveys, about 3 min left", 20.0);
  EXPECT_EQ(clock.rate_text(), "");
}

TEST(StageClock, LogsStagesAtOnceAndTheRestEveryTenSeconds) {
  StageClock clock;
  clock.hear("view 1 of 90", 0.0);
  EXPECT_TRUE(clock.is_due());
  clock.hear("view 2 of 90", 9.0);
  EXPECT_FALSE(clock.is_due());
  clock.hear("view 3 of 90", 10.0);
  EXPECT_TRUE(clock.is_due());
  clock.hear("writing", 11.0);
  EXPECT_TRUE(clock.is_due());
}

TEST(Progress, IsInLogsWhereThatIsAskedFor) {
  const tests::TestFolder folder;
  const std::string mission = folder.write(
      "teapot.yaml",
      "scene: {model: 'builtin:teapot', longest_side: 1}\nsensor: {width: 80, height: 60}\n"
      "planner: {density: 5200, resolution_radius: 0.0525}\nlimits: {max_views: 1}\n"
      "evaluation: {coverage_distance: 0.03, samples: 500, visible_directions: 10,\n"
      "             attainable_views: 0}\n");
  const std::vector<std::string> quick{"plan", mission, "--no-report", "--out", folder / "out"};
  const auto run = [&](std::vector<std::string> more) {
    more.insert(more.begin(), quick.begin(), quick.end());
    return tests::run_skycap(more).err;
  };
  const std::string log = run({"--progress", "plain"});
  EXPECT_THAT(log, HasSubstr("s] teapot: loading scene\n"));
  EXPECT_THAT(log, HasSubstr("s] teapot: view 1 of at most 1, "));
  EXPECT_THAT(log, Not(HasSubstr("\033")));
  EXPECT_EQ(run({}), "");
  EXPECT_THAT(run({"--progress", "loud"}), HasSubstr("--progress"));
}

}  // namespace
}  // namespace skycap::missions
