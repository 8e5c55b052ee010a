// Every step that a verb takes on the disk fails once, and the program dies at each once: whatever
// happens, the folder then holds the whole old result or the whole new one, and nothing else but
// what an unfinished survey can be resumed from. Run again, the verb gives the new result.
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "geometry/io/file.h"
#include "geometry/io/output_folder.h"
#include "tests/support/temporary_folder.h"

namespace skycap {
namespace {

namespace fs = std::filesystem;

/// Names, and contents without what differs from run to run, which is durations: of JSON files the
/// lines that tell the seed and whether the run was complete, of CSV files all columns but the
/// last.
using Content = std::map<std::string, std::string>;

std::string repeatable_part(const fs::path& file) {
  const std::string bytes = geometry::read_file(file), ending = file.extension();
  if (ending != ".json" && ending != ".csv") return bytes;
  std::istringstream lines(bytes);
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    const bool tells =
        line.find("seed\"") != std::string::npos || line.find("\"complete\"") != std::string::npos;
    if (ending == ".csv") kept += line.substr(0, line.rfind(',')) + "\n";
    if (ending == ".json" && tells) kept += line + "\n";
  }
  return kept;
}

constexpr const char* journal = "survey.journal";

Content content_of(const fs::path& folder) {
  Content content;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (entry.is_directory() || entry.path().filename() == journal) continue;
    content[entry.path().filename()] = repeatable_part(entry.path());
  }
  return content;
}

struct Fault {
  std::string kind;
  long at = 0;
  fs::path count;  ///< where the number of steps goes
};

int run(const std::vector<std::string>& arguments, const Fault& fault) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::setenv("LD_PRELOAD", FAULT_INJECTOR, 1);
    ::setenv("FAULT_KIND", fault.kind.c_str(), 1);
    ::setenv("FAULT_AT", std::to_string(fault.at).c_str(), 1);
    if (!fault.count.empty()) ::setenv("FAULT_COUNT", fault.count.c_str(), 1);
    std::vector<char*> words{const_cast<char*>(SKYCAP_PROGRAM)};
    for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    std::freopen("/dev/null", "w", stdout);
    std::freopen("/dev/null", "w", stderr);
    ::execv(words[0], words.data());
    ::_exit(127);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// A verb whose result depends on the seed: 1 gives the old one, 2 the new one.
void try_every_fault(const std::function<std::vector<std::string>(const std::string& seed,
                                                                  const fs::path& out)>& verb) {
  const testing_support::TemporaryFolder scratch;
  const fs::path old_folder = scratch.path() / "old", new_folder = scratch.path() / "new";
  const fs::path count = scratch.path() / "count";
  ASSERT_EQ(run(verb("1", old_folder), {}), 0);
  fs::copy(old_folder, new_folder, fs::copy_options::recursive);
  ASSERT_EQ(run(verb("2", new_folder), {"none", 0, count}), 0);
  const Content before = content_of(old_folder), after = content_of(new_folder);
  ASSERT_NE(before, after);
  const long steps = std::stol(geometry::read_file(count));
  ASSERT_GT(steps, 10);
  for (const char* kind : {"full", "kill"}) {
    for (long at = 1; at <= steps; ++at) {
      const fs::path out = scratch.path() / "out";
      fs::remove_all(out);
      fs::copy(old_folder, out, fs::copy_options::recursive);
      const int exit_code = run(verb("2", out), {kind, at, {}});
      { const geometry::OutputFolder next(out); }  // whoever comes next
      const Content found = content_of(out);
      EXPECT_TRUE(found == before || found == after) << kind << " at step " << at;
      if (exit_code == 0) {
        EXPECT_TRUE(found == after) << kind << " at step " << at << ", exit 0";
      }
      EXPECT_EQ(run(verb("2", out), {}), 0);
      EXPECT_TRUE(content_of(out) == after) << "run again after " << kind << " at step " << at;
      EXPECT_FALSE(fs::exists(out / journal));
    }
  }
  std::cout << 2 * steps << " faults tried\n";
}

constexpr const char* quick =
    "scene: {model: 'builtin:teapot', longest_side: 1.0}\n"
    "sensor: {width: 160, height: 100, noise: {sigma: 0.03}}\n"
    "planner: {density: 5200, resolution_radius: 0.0525, occluder_spacing: 0.03}\n"
    "evaluation: {registration_distance: 0.03, samples: 3000, visible_directions: 30,\n"
    "             ceiling_views: 0}\n"
    "limits: {max_views: 3}\n"
    "scan: {orbit: {radius: 2, circles: 1, speed: 100}}\n";

TEST(FaultPoints, PlanLeavesAWholeResult) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", quick);
  try_every_fault([&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"plan",   mission, "--quiet", "--resume",
                                    "--seed", seed,    "--out",   out};
  });
}

TEST(FaultPoints, ScanLeavesAWholeResult) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", quick);
  try_every_fault([&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"scan", mission,    "--quiet", "--threads", "1", "--seed",
                                    seed,   "--format", "ply",     "--out",     out};
  });
}

TEST(FaultPoints, TrialsLeaveAWholeResult) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", quick);
  try_every_fault([&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"plan",   mission, "--quiet", "--trials", "1",
                                    "--seed", seed,    "--out",   out};
  });
}

}  // namespace
}  // namespace skycap
