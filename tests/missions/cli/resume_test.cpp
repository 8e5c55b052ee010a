// A resumed survey gives the same results as an uninterrupted one.
#include <array>
#include <filesystem>
#include <map>
#include <sstream>
#include <stop_token>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "geometry/io/cloud_io.h"
#include "geometry/io/record_log.h"
#include "missions/cli/command_line.h"
#include "tests/missions/ctrl_c.h"
#include "tests/missions/results_in.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"

namespace skycap::missions {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using tests::CtrlC;
using tests::flight_mission;
using tests::quick_mission;
using tests::read_content;
using tests::run_skycap;
using tests::TestFolder;

/// Returns all results except those with durations.
std::map<std::string, std::string> results_in(const fs::path& folder) {
  return tests::results_in(folder, {"summary.json", "report.html"});
}

class ResumedPlan : public testing::Test {
 protected:
  std::vector<std::string> plan(const std::string& out, const std::vector<std::string>& more = {},
                                const std::string& mission = "m.yaml") const {
    std::vector<std::string> arguments{"plan", folder_ / mission, "--out", folder_ / out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  /// Plans into "part" and interrupts after this number of views.
  void interrupt_after(int views, const std::vector<std::string>& more = {}) const {
    CtrlC keys("view " + std::to_string(views) + " of");
    std::ostringstream out;
    std::ostream err(&keys);
    EXPECT_EQ(cli::run_command_line(plan("part", more), {out, err, true, keys.token()}), 1);
    ASSERT_EQ(geometry::read_records(journal_).records.size(), views + 1);
  }

  TestFolder folder_;
  fs::path journal_ = folder_.path() / "part" / "survey.journal";
};

/// Returns a mission with scans en route.
std::string moving_mission() {
  std::string text = flight_mission();
  const std::string sensor = "sensor: {";
  return text.insert(text.find(sensor) + sensor.size(), "capture: moving, ");
}

TEST_F(ResumedPlan, MatchesUninterruptedPlan) {
  struct Case {
    std::string mission, planner;
    int views;  ///< until the interruption, and after resuming
  };
  for (const auto& [mission, planner, views] : {Case{quick_mission(), "see++", 3},
                                                {quick_mission(), "oa", 4},
                                                {flight_mission(), "skycap", 2},
                                                {moving_mission(), "skycap", 2}}) {
    folder_.write("m.yaml", mission);
    const std::vector<std::string> more{"--planner", planner, "--max-views",
                                        std::to_string(2 * views)};
    ASSERT_EQ(run_skycap(plan("whole", more)).exit_code, 0) << planner;
    interrupt_after(views, more);
    std::vector<std::string> resume = more;
    resume.insert(resume.end(), {"--resume", "--threads", "2"});
    const tests::ProgramRun run = run_skycap(plan("part", resume));
    EXPECT_EQ(run.exit_code, 0) << run.err;
    EXPECT_THAT(run.err, HasSubstr("resuming an interrupted survey after " + std::to_string(views) +
                                   " views"));
    EXPECT_TRUE(results_in(folder_ / "part") == results_in(folder_ / "whole")) << planner;
    fs::remove_all(folder_.path() / "whole");
    fs::remove_all(folder_.path() / "part");
  }
}

/// After a kill, the journal is a prefix of any length.
TEST_F(ResumedPlan, ResumesFromAnyPrefixOfJournal) {
  folder_.write("m.yaml", quick_mission());
  const std::vector<std::string> more{"--max-views", "6"};
  ASSERT_EQ(run_skycap(plan("whole", more)).exit_code, 0);
  interrupt_after(5, more);
  const std::string journal = read_content(journal_);
  for (std::size_t part = 0; part <= 7; ++part) {
    std::ofstream(journal_, std::ios::binary) << journal.substr(0, part * journal.size() / 7);
    ASSERT_EQ(run_skycap(plan("part", {"--max-views", "6", "--resume", "--quiet"})).exit_code, 0);
    EXPECT_TRUE(results_in(folder_ / "part") == results_in(folder_ / "whole")) << part;
  }
}

TEST_F(ResumedPlan, MatchesUninterruptedPlanAfterTwoInterruptions) {
  folder_.write("m.yaml", quick_mission());
  const std::vector<std::string> more{"--max-views", "6"};
  ASSERT_EQ(run_skycap(plan("whole", more)).exit_code, 0);
  interrupt_after(2, more);
  interrupt_after(5, {"--max-views", "6", "--resume"});
  ASSERT_EQ(run_skycap(plan("part", {"--max-views", "6", "--resume"})).exit_code, 0);
  EXPECT_TRUE(results_in(folder_ / "part") == results_in(folder_ / "whole"));
}

/// Points of the preview in millimetres.
std::vector<std::array<long, 3>> preview_in(const fs::path& folder, std::size_t stride) {
  const std::vector<std::string> records = geometry::read_records(folder / "survey.points").records;
  EXPECT_EQ(nlohmann::json::parse(records.at(0)).at("stride"), stride);
  std::vector<std::array<long, 3>> points;
  for (std::size_t i = 1; i < records.size(); ++i) {
    const auto numbers = nlohmann::json::parse(records[i]).get<std::vector<long>>();
    for (std::size_t k = 0; k < numbers.size(); k += 3)
      points.push_back({numbers[k], numbers[k + 1], numbers[k + 2]});
  }
  return points;
}

TEST_F(ResumedPlan, WritesPreviewOfMeasuredPoints) {
  folder_.write("m.yaml", quick_mission());
  const std::vector<std::string> more{"--max-views", "6"};
  interrupt_after(3, more);
  const auto expect_cloud = [&] {
    const geometry::AttributedCloud cloud =
        geometry::read_cloud(folder_.path() / "part" / "cloud.ply");
    const auto points = preview_in(folder_.path() / "part", 1);
    ASSERT_EQ(points.size(), cloud.positions.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(static_cast<double>(points[i][static_cast<std::size_t>(axis)]) / 1000.0,
                    static_cast<double>(cloud.positions[i][axis]), 0.00051);
      }
    }
  };
  expect_cloud();
  interrupt_after(5, {"--max-views", "6", "--resume"});
  expect_cloud();
  ASSERT_EQ(run_skycap(plan("part", {"--max-views", "6", "--resume"})).exit_code, 0);
  EXPECT_FALSE(fs::exists(folder_.path() / "part" / "survey.points"));
}

TEST_F(ResumedPlan, StartsWithoutJournal) {
  folder_.write("m.yaml", quick_mission());
  const tests::ProgramRun run = run_skycap(plan("out", {"--resume"}));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_FALSE(fs::exists(folder_.path() / "out" / "survey.journal"));
}

TEST_F(ResumedPlan, RejectsJournalOfAnotherSurvey) {
  folder_.write("m.yaml", quick_mission());
  interrupt_after(2);
  const std::string journal = read_content(journal_);
  const auto rejection = [&](const std::vector<std::string>& more) {
    const tests::ProgramRun run = run_skycap(plan("part", more));
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(read_content(journal_), journal);
    return run.err;
  };
  EXPECT_THAT(rejection({"--resume", "--seed", "2"}), HasSubstr("seed changed from 1 to 2"));
  EXPECT_THAT(rejection({"--resume", "--set", "planner.density=5300"}),
              HasSubstr("planner.density changed from \"5200\" to \"5300\""));
  EXPECT_THAT(rejection({"--resume", "--set", "scene.longest_side=1.01"}), HasSubstr("surface"));
}

TEST_F(ResumedPlan, RejectsDamagedJournalAndRestartsWithoutResume) {
  folder_.write("m.yaml", quick_mission());
  interrupt_after(3);
  std::string journal = read_content(journal_);
  journal[journal.find("\"position\"") + 15] ^= 1;
  std::ofstream(journal_, std::ios::binary) << journal;
  const tests::ProgramRun run = run_skycap(plan("part", {"--resume"}));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("survey.journal: line 2 is damaged"));
  EXPECT_EQ(run_skycap(plan("part")).exit_code, 0);
  EXPECT_FALSE(fs::exists(journal_));
}

/// A journal with valid checksums whose records differ from the survey's results.
TEST_F(ResumedPlan, RejectsJournalWithDifferentResults) {
  folder_.write("m.yaml", quick_mission());
  interrupt_after(3);
  std::vector<std::string> records = geometry::read_records(journal_).records;
  const std::string field = "\"returns\":";
  records[2].insert(records[2].find(field) + field.size(), "1");
  fs::remove(journal_);
  {
    geometry::RecordLog log(journal_);
    for (const std::string& record : records) log.append(record);
  }
  const tests::ProgramRun run = run_skycap(plan("part", {"--resume"}));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("does not match: view 1 has different points"));
}

}  // namespace
}  // namespace skycap::missions
