// A resumed scan gives the same results as an uninterrupted one.
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "missions/cli/command_line.h"
#include "tests/missions/cli/cube_scan.h"
#include "tests/missions/ctrl_c.h"

namespace skycap::missions {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using tests::read_content;
using tests::run_skycap;

class ResumedScan : public tests::CubeScan {
 protected:
  /// Scans into "part" and interrupts when the progress line contains `text`.
  void interrupt_at(const std::string& text, const std::vector<std::string>& more) const {
    tests::CtrlC keys(text);
    std::ostringstream out;
    std::ostream err(&keys);
    ASSERT_EQ(cli::run_command_line(scan("part", with(more, {"--threads", "1"})),
                                    {out, err, true, keys.token()}),
              1);
    ASSERT_TRUE(fs::exists(journal_));
    ASSERT_THAT(read_content(folder_ / "part/scan.json"), HasSubstr("\"complete\": false"));
  }

  fs::path journal_ = folder_.path() / "part" / "unfinished" / "scan.journal";
  const std::vector<std::string> images_{"--route",  folder_.path().string(),
                                         "--sensor", folder_ / "camera.yaml",
                                         "--format", "rawlog"};
};

TEST_F(ResumedScan, MatchesUninterruptedLaserScan) {
  ASSERT_EQ(run_skycap(scan("whole", with(clouds_, {"--threads", "2"}))).exit_code, 0);
  interrupt_at("% flown", clouds_);
  for (const char* name : {"scan.las", "trajectory.tum", "trajectory_estimated.tum"}) {
    EXPECT_LT(fs::file_size(folder_.path() / "part" / name),
              fs::file_size(folder_.path() / "whole" / name));
  }
  const std::vector<std::string> evaluation{
      "evaluate",  "--model", folder_ / "cube.obj", "--cloud", folder_ / "part/scan.las",
      "--samples", "1000"};
  EXPECT_THAT(run_skycap(evaluation).err, HasSubstr("the scan was interrupted"));
  const auto run = run_skycap(scan("part", with(clouds_, {"--resume", "--threads", "2"})));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("resuming an interrupted scan"));
  expect_same_results();
}

// State after a kill: files longer than recorded in the journal, and an incomplete record.
TEST_F(ResumedScan, DiscardsDataMissingFromJournal) {
  ASSERT_EQ(run_skycap(scan("whole", clouds_)).exit_code, 0);
  interrupt_at("% flown", clouds_);
  const std::string partial = read_content(folder_ / "part/scan.las");
  for (const char* name : {"scan.las", "scan.ply", "scan.rawlog", "preview.ply"}) {
    // The file is replaced instead of written to, because the results share its data through a hard
    // link and must not change.
    const fs::path file = journal_.parent_path() / name;
    const std::string content = read_content(file);
    fs::remove(file);
    std::ofstream(file, std::ios::binary) << content << std::string(1000, 'x');
  }
  std::ofstream(journal_, std::ios::binary | std::ios::app) << "0123abcd 3 {\"fir";
  EXPECT_EQ(run_skycap(scan("part", with(clouds_, {"--resume"}))).exit_code, 0);
  expect_same_results();
  EXPECT_NE(partial, read_content(folder_ / "part/scan.las"));
}

TEST_F(ResumedScan, MatchesUninterruptedCameraScan) {
  ASSERT_EQ(run_skycap(scan("whole", images_)).exit_code, 0);
  interrupt_at("image 2 of 4", images_);
  EXPECT_FALSE(fs::exists(folder_ / "part/depth_000002.png"));
  const auto run = run_skycap(scan("part", with(images_, {"--resume"})));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  expect_same_results();
}

// State of a camera scan after a kill: half an image that is not in the journal, and a longer log.
TEST_F(ResumedScan, DiscardsImagesMissingFromJournal) {
  ASSERT_EQ(run_skycap(scan("whole", images_)).exit_code, 0);
  interrupt_at("image 2 of 4", images_);
  const fs::path log = journal_.parent_path() / "frames.rawlog";
  const std::string content = read_content(log);
  fs::remove(log);
  std::ofstream(log, std::ios::binary) << content << std::string(1000, 'x');
  std::ofstream(journal_.parent_path() / "depth_000002.png", std::ios::binary) << "\x89PNG";
  EXPECT_EQ(run_skycap(scan("part", with(images_, {"--resume"}))).exit_code, 0);
  expect_same_results();
}

// If recorded bytes are missing, the scan cannot be resumed.
TEST_F(ResumedScan, RejectsTruncatedFiles) {
  for (const auto& [options, until, name] :
       {std::tuple{clouds_, "% flown", "scan.las"},
        std::tuple{images_, "image 2 of 4", "frames.rawlog"}}) {
    interrupt_at(until, options);
    const fs::path file = journal_.parent_path() / name;
    const std::string content = read_content(file);
    fs::remove(file);
    std::ofstream(file, std::ios::binary) << content.substr(0, content.size() - 1);
    const auto run = run_skycap(scan("part", with(options, {"--resume"})));
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.err, HasSubstr(std::string(name) + ": contains "));
    fs::remove_all(folder_ / "part");
  }
}

// The results of the interrupted run share data with the files that continue to grow.
TEST_F(ResumedScan, KeepsEarlierResultsWhenInterruptedAgain) {
  ASSERT_EQ(run_skycap(scan("whole", clouds_)).exit_code, 0);
  interrupt_at("% flown", clouds_);
  const fs::path kept = folder_ / "kept.las";
  fs::create_hard_link(folder_ / "part/scan.las", kept);
  const std::string partial = read_content(kept);
  const auto pulses = [&] {
    return nlohmann::json::parse(read_content(folder_ / "part/scan.json")).at("shots").get<int>();
  };
  const int pulses_before = pulses();
  interrupt_at("% flown", with(clouds_, {"--resume"}));
  EXPECT_EQ(read_content(kept), partial);
  EXPECT_GT(pulses(), pulses_before);
  ASSERT_EQ(run_skycap(scan("part", with(clouds_, {"--resume"}))).exit_code, 0);
  expect_same_results();
}

TEST_F(ResumedScan, RejectsOtherScanWithoutLosingResults) {
  interrupt_at("% flown", clouds_);
  const auto before = tests::scan_results_in(folder_ / "part");
  const auto rejection = [&](const std::vector<std::string>& more) {
    const auto run = run_skycap(scan("part", with(more, {"--resume"})));
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_TRUE(tests::scan_results_in(folder_ / "part") == before);
    return run.err;
  };
  EXPECT_THAT(rejection(with(clouds_, {"--seed", "2"})), HasSubstr("seed changed from 1 to 2"));
  EXPECT_THAT(rejection({"--format", "las"}), HasSubstr("formats changed from "));
  EXPECT_THAT(rejection(with(clouds_, {"--set", "scan.orbit.speed=21"})),
              HasSubstr("cannot resume: "));
  folder_.write("cube.obj",
                read_content(folder_ / "cube.obj") + "v 2 2 0\nv 2 3 0\nv 2 3 3\n" + "f 9 10 11\n");
  EXPECT_THAT(rejection(clouds_), HasSubstr("scene_digest changed from "));
}

// For files named by a key, the content matters.
TEST_F(ResumedScan, RejectsChangedSensorOrRouteFiles) {
  interrupt_at("image 2 of 4", images_);
  const auto rejection_with = [&](const std::string& file, const std::string& from,
                                  const std::string& to) {
    const std::string kept = read_content(folder_ / file);
    std::string changed = kept;
    changed.replace(changed.find(from), from.size(), to);
    folder_.write(file, changed);
    const auto run = run_skycap(scan("part", with(images_, {"--resume"})));
    EXPECT_EQ(run.exit_code, 2);
    folder_.write(file, kept);
    return run.err;
  };
  EXPECT_THAT(rejection_with("camera.yaml", "_deg: 5", "_deg: 5.1"),
              HasSubstr("sensor_digest changed from "));
  EXPECT_THAT(rejection_with("views.csv", "2,3,0,1", "2,3,0,1.001"),
              HasSubstr("route_digest changed from "));
  EXPECT_EQ(run_skycap(scan("part", with(images_, {"--resume"}))).exit_code, 0);
}

TEST_F(ResumedScan, RejectsDamagedJournalAndRestartsWithoutResume) {
  interrupt_at("% flown", clouds_);
  std::string journal = read_content(journal_);
  journal[journal.find("\"seed\"") + 1] ^= 1;
  std::ofstream(journal_, std::ios::binary) << journal;
  const auto run = run_skycap(scan("part", with(clouds_, {"--resume"})));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("scan.journal: line 1 is damaged"));
  EXPECT_EQ(run_skycap(scan("part", clouds_)).exit_code, 0);
  EXPECT_FALSE(fs::exists(journal_.parent_path()));
}

TEST_F(ResumedScan, StartsWithoutJournal) {
  ASSERT_EQ(run_skycap(scan("whole", clouds_)).exit_code, 0);
  const auto run = run_skycap(scan("part", with(clouds_, {"--resume"})));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(run.err, "");
  expect_same_results();
}

}  // namespace
}  // namespace skycap::missions
