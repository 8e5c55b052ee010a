// End-to-end tests of skycap campaign, as started by a user and by a scheduler.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "missions/support/external_program.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using tests::ProgramRun;
using tests::read_content;
using tests::run_skycap;
using Json = nlohmann::json;
using Clock = std::chrono::steady_clock;

/// Returns a mission with few views in a scene that loads quickly.
std::string small_mission(const std::string& more = "") {
  std::string mission = tests::quick_mission(more);
  return mission.replace(mission.find("longest_side"), 0, "detail: coarse, ");
}

class CampaignCommand : public testing::Test {
 protected:
  ProgramRun run(const std::string& out, const std::vector<std::string>& more = {}) const {
    return run_skycap(words(out, more));
  }
  std::vector<std::string> words(const std::string& out,
                                 const std::vector<std::string>& more) const {
    std::vector<std::string> all{"campaign", campaign_, "--out", folder_ / out, "--no-report"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Starts the program in a separate process.
  pid_t started(const std::string& out, const std::vector<std::string>& more) const {
    std::vector<std::string> all = words(out, more);
    all.insert(all.begin(), SKYCAP_PROGRAM);
    std::vector<char*> arguments;
    for (std::string& word : all) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_t process = 0;
    EXPECT_EQ(::posix_spawn(&process, SKYCAP_PROGRAM, nullptr, nullptr, arguments.data(), environ),
              0);
    return process;
  }
  static int wait_for_status(pid_t process) {
    int status = 0;
    ::waitpid(process, &status, 0);
    return status;
  }
  /// Returns all results that must not depend on the distribution of the runs.
  std::map<std::string, std::string> tables(const std::string& out) const {
    std::map<std::string, std::string> contents;
    for (const char* name : {"manifest.jsonl", "trials.csv", "table1.csv", "report.md"}) {
      contents[name] = read_content(folder_.path() / out / name);
    }
    return contents;
  }
  /// Returns the run records by path. They contain durations, so they differ between executions.
  std::map<std::string, std::string> records(const std::string& out) const {
    std::map<std::string, std::string> contents;
    const fs::path items = folder_.path() / out / "items";
    if (!fs::exists(items)) return contents;
    for (const auto& entry : fs::recursive_directory_iterator(items)) {
      if (entry.path().filename() != "item.json") continue;
      contents[fs::relative(entry.path(), items)] = read_content(entry.path());
    }
    return contents;
  }

  static constexpr int item_count = 8;  // 1 mission, 2 variants, 2 planners, 2 seeds
  tests::TestFolder folder_;
  std::string mission_ = folder_.write("quick.yaml", small_mission());
  std::string campaign_ = folder_.write("small.yaml",
                                        "missions: [quick.yaml]\n"
                                        "planners: [see++, oa]\n"
                                        "seeds: 2\n"
                                        "set: {limits.max_views: 4}\n"
                                        "variants: {plain: {}, short: {limits.max_views: 2}}\n");
};

TEST_F(CampaignCommand, WritesTablesOfAllRuns) {
  const ProgramRun result = run("out");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, HasSubstr("8 of 8 runs\n"));
  const Json json = Json::parse(read_content(folder_.path() / "out" / "results.json"));
  ASSERT_EQ(json["results"].size(), 4U);
  std::set<std::string> missions;
  for (const Json& cell : json["results"]) {
    EXPECT_EQ(cell["trials"], 2);
    const bool is_short = cell["mission"] == "quick/short";
    EXPECT_EQ(cell["each_trial"][0]["views"], is_short ? 2 : 4);
    missions.insert(cell["mission"]);
  }
  EXPECT_THAT(missions, ElementsAre("quick/plain", "quick/short"));
  EXPECT_EQ(run_skycap({"report", folder_ / "out"}).exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_.path() / "out" / "benchmark.html"));
}

TEST_F(CampaignCommand, WritesSameTablesByThreadsAndByIndex) {
  ASSERT_EQ(run("one", {"--threads", "1"}).exit_code, 0);
  ASSERT_EQ(run("two", {"--threads", "2"}).exit_code, 0);
  for (int i = item_count - 1; i >= 0; --i) {
    const ProgramRun task = run("by_index", {"--index", std::to_string(i)});
    ASSERT_EQ(task.exit_code, 0) << task.err;
    EXPECT_EQ(records("by_index").size(), static_cast<std::size_t>(item_count - i));
  }
  for (const char* task : {"0", "1", "2"}) {
    ASSERT_EQ(run("by_chunk", {"--index", task, "--chunk", "3"}).exit_code, 0);
  }
  for (const char* out : {"by_index", "by_chunk"}) {
    ASSERT_EQ(run(out, {"--collect"}).exit_code, 0);
    EXPECT_EQ(tables(out), tables("one"));
  }
  EXPECT_EQ(tables("two"), tables("one"));
}

TEST_F(CampaignCommand, ReadsIndexFromScheduler) {
  ::setenv("PARALLEL_SEQ", "8", 1);
  const ProgramRun last = run("out", {"--index", "parallel"});
  ::setenv("PARALLEL_SEQ", "9", 1);
  const ProgramRun beyond = run("out", {"--index", "auto"});
  ::unsetenv("PARALLEL_SEQ");
  EXPECT_EQ(last.exit_code, 0) << last.err;
  EXPECT_EQ(records("out").count("quick/short/oa/seed_2/item.json"), 1U);
  EXPECT_EQ(beyond.exit_code, 0);
  EXPECT_THAT(beyond.err, HasSubstr("task 8 has no runs; the total number of runs is 8"));
  EXPECT_EQ(records("out").size(), 1U);
}

TEST_F(CampaignCommand, SkipsCompleteRunsAndRepeatsStaleRuns) {
  ASSERT_EQ(run("out").exit_code, 0);
  const auto before = records("out");
  ASSERT_EQ(run("out").exit_code, 0);
  EXPECT_EQ(records("out"), before);
  // One damaged record and one record with other settings.
  const fs::path damaged = folder_.path() / "out/items/quick/plain/oa/seed_1/item.json";
  std::ofstream(damaged) << read_content(damaged).substr(0, 70);
  std::ofstream(campaign_, std::ios::app) << "results: figures\n";  // does not change a run
  ASSERT_EQ(run("out").exit_code, 0);
  for (const auto& [path, text] : records("out")) {
    EXPECT_EQ(text != before.at(path), path == "quick/plain/oa/seed_1/item.json") << path;
  }
  const auto whole = records("out");
  folder_.write(
      "quick.yaml",
      small_mission("site: {latitude_deg: 51.7, longitude_deg: -1.25, geoid_undulation: 46}\n"));
  ASSERT_EQ(run("out").exit_code, 0);
  for (const auto& [path, text] : records("out")) EXPECT_NE(text, whole.at(path)) << path;
}

// Damaged scene caches are recomputed.
TEST_F(CampaignCommand, RecomputesDamagedSceneCache) {
  ASSERT_EQ(run("whole").exit_code, 0);
  for (const char* damage : {"", "-\n", "2\n0101", "0.5"}) {
    ASSERT_EQ(run("out", {"--index", "0"}).exit_code, 0);
    ASSERT_FALSE(fs::is_empty(folder_.path() / "out" / "scenes"));
    for (const auto& entry : fs::directory_iterator(folder_.path() / "out" / "scenes")) {
      std::ofstream(entry.path()) << damage;
    }
    fs::remove_all(folder_.path() / "out" / "items");
  }
  ASSERT_EQ(run("out").exit_code, 0);
  EXPECT_EQ(tables("out"), tables("whole"));
}

// The content of the model matters, not its name.
TEST_F(CampaignCommand, RepeatsRunsWhenModelContentChanges) {
  ASSERT_EQ(run_skycap({"model", "teapot", "--out", folder_ / "m.ply"}).exit_code, 0);
  const std::string mission = tests::quick_mission();
  folder_.write("quick.yaml",
                std::string(mission).replace(mission.find("builtin:teapot"), 14, "m.ply"));
  ASSERT_EQ(run("out", {"--index", "0"}).exit_code, 0);
  const auto before = records("out");
  ASSERT_EQ(run("out", {"--index", "0"}).exit_code, 0);
  EXPECT_EQ(records("out"), before);
  std::ofstream(folder_ / "m.ply", std::ios::app) << "\n";
  ASSERT_EQ(run("out", {"--index", "0"}).exit_code, 0);
  EXPECT_NE(records("out"), before);
}

TEST_F(CampaignCommand, WritesSameTablesAfterKills) {
  ASSERT_EQ(run("whole").exit_code, 0);
  std::mt19937 random(1);
  std::map<std::string, std::string> complete;
  int kills = 0;
  for (int attempt = 0; attempt < 60; ++attempt) {
    const pid_t process = started("part", {"--quiet", "--threads", "2"});
    std::this_thread::sleep_for(std::chrono::milliseconds(30 + random() % 250));
    ::kill(process, SIGKILL);
    const int status = wait_for_status(process);
    // Records that were complete before have not been recomputed.
    const auto now = records("part");
    for (const auto& [path, text] : complete) EXPECT_EQ(now.at(path), text) << path;
    complete = now;
    if (WIFEXITED(status)) break;
    ++kills;
  }
  EXPECT_GE(kills, 2);
  ASSERT_EQ(run("part").exit_code, 0);
  EXPECT_EQ(tables("part"), tables("whole"));
  for (const auto& [path, text] : records("part")) {
    EXPECT_TRUE(!complete.contains(path) || complete.at(path) == text) << path;
  }
}

TEST_F(CampaignCommand, EndsPromptlyWithCompleteFilesOnSignal) {
  std::ofstream(campaign_) << "missions: [quick.yaml]\nplanners: [rse]\nseeds: 500\n"
                              "set: {limits.max_views: 40}\n";
  const pid_t process = started("out", {"--quiet", "--threads", "2"});
  while (records("out").empty()) std::this_thread::sleep_for(20ms);
  const auto reported = Clock::now();
  ::kill(process, SIGTERM);
  const int status = wait_for_status(process);
  EXPECT_LT(Clock::now() - reported, 2s);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 143);
  for (const auto& entry : fs::recursive_directory_iterator(folder_.path() / "out")) {
    const std::string name = entry.path().filename();
    const bool is_truth = entry.path().parent_path().filename() == "scenes";
    EXPECT_TRUE(entry.is_directory() || name == "item.json" || (is_truth && name.front() != '.'))
        << entry.path();
  }
  EXPECT_FALSE(fs::exists(folder_.path() / "out" / "report.md"));
}

TEST_F(CampaignCommand, SkipsRunsThatFail) {
  folder_.write("broken.yaml", "scene: {model: nothing.ply}\n");
  folder_.write(
      "lost.yaml",
      std::string(small_mission()).replace(small_mission().find("builtin:teapot"), 14, "lost.ply"));
  std::ofstream(campaign_) << "missions: [broken.yaml, lost.yaml, quick.yaml]\nplanners: [oa]\n"
                              "seeds: 1\nset: {limits.max_views: 3}\n";
  const ProgramRun result = run("out");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.err, HasSubstr("broken.yaml:1: key evaluation.coverage_distance is miss"));
  EXPECT_THAT(result.err, HasSubstr("lost.ply"));
  EXPECT_THAT(result.out, HasSubstr("1 of 3 runs"));
  const ProgramRun alone = run("out", {"--index", "0"});
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_THAT(alone.err, HasSubstr("skycap: error: "));
}

TEST_F(CampaignCommand, WritesPackagesWhenRequested) {
  std::ofstream(campaign_) << "missions: [quick.yaml]\nplanners: [see++]\nseeds: 1\n"
                              "first_seed: 3\nset: {limits.max_views: 3}\nresults: package\n";
  ASSERT_EQ(run("out").exit_code, 0);
  const fs::path item = folder_.path() / "out/items/quick/see++/seed_3";
  ASSERT_EQ(run_skycap({"plan", mission_, "--planner", "see++", "--seed", "3", "--max-views", "3",
                        "--no-report", "--quiet", "--out", folder_ / "plan"})
                .exit_code,
            0);
  for (const char* name : {"views.csv", "cloud.ply", "trajectory.tum"}) {
    EXPECT_TRUE(read_content(item / name) == read_content(folder_.path() / "plan" / name)) << name;
  }
  EXPECT_EQ(Json::parse(read_content(item / "summary.json"))["seed"], 3);
  // Without packages, the run has another checksum, and the files of the old run are removed.
  std::string figures = read_content(campaign_);
  figures = figures.substr(0, figures.find("results:"));
  std::ofstream(campaign_) << figures;
  ASSERT_EQ(run("out").exit_code, 0);
  EXPECT_TRUE(fs::exists(item / "item.json"));
  EXPECT_FALSE(fs::exists(item / "summary.json"));
}

TEST_F(CampaignCommand, PrintsManifestWithoutRunning) {
  const ProgramRun result = run("out", {"--list"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(std::ranges::count(result.out, '\n'), item_count);
  EXPECT_FALSE(fs::exists(folder_.path() / "out"));
}

// Two tasks for one run: the second reports the lock, or finds the run complete.
TEST_F(CampaignCommand, LocksRunFolderAgainstSecondTask) {
  const pid_t first = started("out", {"--quiet", "--index", "0"});
  const pid_t second = started("out", {"--quiet", "--index", "0"});
  const int statuses[] = {wait_for_status(first), wait_for_status(second)};
  EXPECT_TRUE(statuses[0] == 0 || statuses[1] == 0);
  for (const int status : statuses) {
    EXPECT_TRUE(WIFEXITED(status) && (WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 2));
  }
  EXPECT_EQ(records("out").size(), 1U);
}

/// Writes a program that logs its arguments and prints `program_output`.
void write_program(const fs::path& file, const std::string& program_output) {
  std::ofstream(file) << "#!/bin/sh\necho \"$@\" >> \"$0.words\"\necho '" << program_output
                      << "'\n";
  fs::permissions(file, fs::perms::owner_all);
}

// The script for Slurm is run by a shell that sets Slurm's variable.
TEST_F(CampaignCommand, WritesRunnableSlurmScripts) {
  ASSERT_EQ(run("here").exit_code, 0);
  fs::create_directory(folder_.path() / "bin");
  write_program(folder_.path() / "bin" / "sbatch", "42;cluster");
  const std::string path = "PATH=" + folder_ / "bin" + ":" + std::getenv("PATH");
  std::vector<std::string> submit{"env", path, SKYCAP_PROGRAM};
  for (const std::string& word : words("out", {"--submit", "slurm", "--chunk", "3"})) {
    submit.push_back(word);
  }
  const auto result = support::run_external_program(submit, folder_.path());
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(result.output, HasSubstr("Slurm job 42: 3 tasks, up to 3 runs per task"));
  EXPECT_THAT(read_content(folder_.path() / "bin" / "sbatch.words"),
              HasSubstr("--dependency=afterany:42 "));
  const fs::path out = folder_.path() / "out";
  EXPECT_THAT(read_content(out / "slurm.sh"), HasSubstr("#SBATCH --array=0-2\n"));
  for (const char* task : {"2", "0", "1"}) {
    const auto done = support::run_external_program(
        {"env", std::string("SLURM_ARRAY_TASK_ID=") + task, "sh", (out / "slurm.sh").string()},
        "/");
    ASSERT_EQ(done.exit_code, 0) << done.output;
  }
  ASSERT_EQ(
      support::run_external_program({"sh", (out / "slurm_collect.sh").string()}, "/").exit_code, 0);
  EXPECT_EQ(tables("out"), tables("here"));
}

TEST_F(CampaignCommand, ReportsMissingScheduler) {
  std::vector<std::string> submit{"/usr/bin/env", "PATH=" + folder_ / "bin", SKYCAP_PROGRAM};
  for (const std::string& word : words("out", {"--submit", "parallel"})) submit.push_back(word);
  const auto result = support::run_external_program(submit, folder_.path());
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.output, HasSubstr("unknown program parallel"));
}

}  // namespace
}  // namespace skycap::missions
