// A scan in shards gives the same bytes as an unsplit one.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
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

class SplitScan : public tests::CubeScan {
 protected:
  /// Measures one shard, as a task does.
  tests::ProgramRun task(std::size_t shard, std::size_t shards,
                         const std::vector<std::string>& more = {}) const {
    return run_skycap(scan("part", with(more, {"--pieces", std::to_string(shards), "--index",
                                               std::to_string(shard), "--quiet"})));
  }
  tests::ProgramRun collect(std::size_t shards, const std::vector<std::string>& more = {}) const {
    return run_skycap(scan("part", with(more, {"--pieces", std::to_string(shards), "--collect"})));
  }
  fs::path own_shard_folder(const std::string& name) const {
    return folder_.path() / "part" / "pieces" / name;
  }

  const std::vector<std::string> all_{"--format", "las,laz,ply,pcd,xyz,rawlog,e57", "--with-truth"};
};

TEST_F(SplitScan, MatchesUnsplitScanForAnyTaskOrder) {
  ASSERT_EQ(run_skycap(scan("whole", all_)).exit_code, 0);
  for (const std::size_t shards : {1, 2, 4}) {
    for (std::size_t i = 0; i < shards; ++i) {  // in another order
      const auto run =
          task((3 * i + 2) % shards, shards, with(all_, {"--threads", i % 2 == 0 ? "1" : "2"}));
      ASSERT_EQ(run.exit_code, 0) << run.err;
    }
    const auto run = collect(shards, all_);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    expect_same_results();
    fs::remove_all(folder_ / "part");
  }
}

TEST_F(SplitScan, AllowsMorePiecesThanFirings) {
  const std::vector<std::string> short_flight{"--set", "scan.orbit.speed=100"};
  ASSERT_EQ(run_skycap(scan("whole", short_flight)).exit_code, 0);
  const auto run = run_skycap(scan("part", with(short_flight, {"--pieces", "15"})));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  expect_same_results();
}

TEST_F(SplitScan, MeasuresSeveralPiecesPerTask) {
  ASSERT_EQ(run_skycap(scan("whole", {})).exit_code, 0);
  ASSERT_EQ(task(1, 5, {"--chunk", "3"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(own_shard_folder("3_of_5")));
  EXPECT_TRUE(fs::exists(own_shard_folder("4_of_5")));
  const auto beyond = task(2, 5, {"--chunk", "3"});
  EXPECT_EQ(beyond.exit_code, 0);
  EXPECT_THAT(beyond.err, HasSubstr("task 2 has no runs; the total number of runs is 5"));
  const auto early = collect(5);
  EXPECT_EQ(early.exit_code, 1);
  EXPECT_THAT(early.err, HasSubstr("2 of 5 pieces are complete; missing 0, 1, 2"));
  EXPECT_FALSE(fs::exists(folder_ / "part/scan.las"));
  ASSERT_EQ(task(0, 5, {"--chunk", "3"}).exit_code, 0);
  ASSERT_EQ(collect(5).exit_code, 0);
  expect_same_results();
  const auto again = collect(5);
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_THAT(again.err, HasSubstr("contains no pieces; its results are complete"));
}

TEST_F(SplitScan, SkipsCompletePiecesAndRepeatsPiecesOfOtherScans) {
  ASSERT_EQ(task(1, 2).exit_code, 0);
  const fs::path cloud = own_shard_folder("1_of_2") / "scan.las";
  const auto written = fs::last_write_time(cloud);
  ASSERT_EQ(task(1, 2).exit_code, 0);
  EXPECT_EQ(fs::last_write_time(cloud), written);
  const std::string before = read_content(cloud);
  ASSERT_EQ(task(1, 2, {"--seed", "2"}).exit_code, 0);
  EXPECT_NE(read_content(cloud), before);
  EXPECT_EQ(collect(2).exit_code, 1);  // one shard has a different seed
}

TEST_F(SplitScan, ResumesInterruptedPiece) {
  ASSERT_EQ(run_skycap(scan("whole", clouds_)).exit_code, 0);
  tests::CtrlC keys("% flown");
  std::ostringstream out;
  std::ostream err(&keys);
  const auto second = with(clouds_, {"--pieces", "2", "--index", "1", "--threads", "1"});
  ASSERT_EQ(cli::run_command_line(scan("part", second), {out, err, true, keys.token()}), 1);
  EXPECT_FALSE(fs::exists(own_shard_folder("1_of_2") / "piece.json"));
  // State after a kill: a file is longer than recorded in the journal.
  const fs::path grown = own_shard_folder("1_of_2") / "unfinished" / "scan.las";
  ASSERT_TRUE(fs::exists(grown));
  std::ofstream(grown, std::ios::binary | std::ios::app) << std::string(1000, 'x');
  const auto run = run_skycap(scan("part", second));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("resuming an interrupted scan"));
  ASSERT_EQ(task(0, 2, clouds_).exit_code, 0);
  ASSERT_EQ(collect(2, clouds_).exit_code, 0);
  expect_same_results();
}

TEST_F(SplitScan, TreatsDamagedPieceAsIncomplete) {
  ASSERT_EQ(run_skycap(scan("part", {"--pieces", "1", "--index", "0"})).exit_code, 0);
  std::ofstream(own_shard_folder("0_of_1") / "piece.json") << "{";
  EXPECT_THAT(collect(1).err, HasSubstr("0 of 1 pieces are complete; missing 0"));
  ASSERT_EQ(task(0, 1).exit_code, 0);
  EXPECT_EQ(collect(1).exit_code, 0);
}

TEST_F(SplitScan, RejectsUnsupportedInput) {
  const auto rejection = [&](const std::vector<std::string>& options) {
    const auto run = run_skycap(scan("part", options));
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
    return run.err;
  };
  EXPECT_THAT(rejection({"--index", "1"}), HasSubstr("require --pieces"));
  EXPECT_THAT(rejection({"--pieces", "2", "--index", "one"}),
              HasSubstr("--index is 'one'; it must be an integer of at least 0"));
  EXPECT_THAT(rejection({"--pieces", "2", "--sensor", folder_ / "camera.yaml"}),
              HasSubstr("Test camera is a camera; only scans of laser scanners can be split"));
  EXPECT_THAT(rejection({"--pieces", "2", "--resume"}), HasSubstr("--resume excludes --pieces"));
}

}  // namespace
}  // namespace skycap::missions
