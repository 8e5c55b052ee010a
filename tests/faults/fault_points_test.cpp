// Every step that a verb takes on the disk fails once, and the program dies at each once; every
// start of a program fails, and allocations do: whatever happens, the folder then holds the whole
// old result or the whole new one, and nothing else but what an unfinished survey can go on from.
// Run again after it died, the verb gives the new result. Nothing but being killed, or having no
// memory to begin with, ends a program by a signal.
//
// With FAULT_POINTS=all in the environment all points on the disk are tried, not a sample (of
// memory it is always one): tests/faults/run does so.
#include <algorithm>
#include <array>
#include <csignal>
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
/// last, of reports the first line. Of folders, such as those of finished trials, the name.
using Content = std::map<std::string, std::string>;

std::string repeatable_part(const fs::path& file) {
  const std::string bytes = geometry::read_file(file), ending = file.extension();
  if (ending == ".md") return bytes.substr(0, bytes.find('\n'));
  if (ending == ".html") return bytes.substr(bytes.size() - 12);  // whole: it has its end
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

/// Of trials whose times differ: seeds, views, coverage.
std::string without_times(const std::string& name, const std::string& text) {
  if (name != "trials.csv" && name != "table1.csv" && name != "times.csv") return text;
  const std::size_t kept_length = name == "times.csv" ? 1 : 12;
  std::istringstream lines(text);
  std::string kept;
  for (std::string line; std::getline(lines, line);) kept += line.substr(0, kept_length) + "\n";
  return kept;
}

/// What an interrupted survey and an interrupted scan are gone on with.
constexpr std::array journals{"survey.journal", "unfinished"};

Content content_of(const fs::path& folder) {
  Content content;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (name == "interrupted" || name == "items") continue;
    if (std::ranges::find(journals, name) != journals.end()) continue;
    content[name] = entry.is_directory() ? "" : without_times(name, repeatable_part(entry.path()));
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
    if (std::freopen("/dev/null", "w", stdout) && std::freopen("/dev/null", "w", stderr)) {
      ::execv(words[0], words.data());
    }
    ::_exit(127);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// A verb whose result depends on the seed: 1 gives the old one, 2 the new one.
using Verb = std::function<std::vector<std::string>(const std::string& seed, const fs::path& out)>;

/// Tries about `sample` faults of each kind, evenly spread, or all with FAULT_POINTS=all.
void try_faults(const Verb& verb, const std::vector<std::string>& kinds, long sample) {
  const testing_support::TemporaryFolder scratch;
  const fs::path old_folder = scratch.path() / "old", new_folder = scratch.path() / "new";
  const fs::path count = scratch.path() / "count", out = scratch.path() / "out";
  ASSERT_EQ(run(verb("1", old_folder), {}), 0);
  fs::copy(old_folder, new_folder, fs::copy_options::recursive);
  ASSERT_EQ(run(verb("2", new_folder), {}), 0);
  const Content before = content_of(old_folder), after = content_of(new_folder);
  ASSERT_NE(before, after);
  const bool tries_all = std::getenv("FAULT_POINTS") != nullptr;
  for (const std::string& kind : kinds) {
    fs::remove_all(out);
    fs::copy(old_folder, out, fs::copy_options::recursive);
    ASSERT_EQ(run(verb("2", out), {kind, 0, count}), 0);
    const long steps = std::stol(geometry::read_file(count));
    ASSERT_GT(steps, 0) << kind;
    const long stride = tries_all && kind != "memory" ? 1 : std::max(1L, steps / sample);
    long tried = 0;
    for (long at = 1; at <= steps; at += stride, ++tried) {
      fs::remove_all(out);
      fs::copy(old_folder, out, fs::copy_options::recursive);
      const int exit_code = run(verb("2", out), {kind, at, {}});
      { const geometry::OutputFolder next(out); }  // whoever comes next
      const Content found = content_of(out);
      EXPECT_TRUE(found == before || found == after) << kind << " at step " << at;
      EXPECT_TRUE(exit_code != 0 || found == after) << kind << " at step " << at << ", exit 0";
      // Without memory before main() begins, the runtime aborts.
      const bool is_killed = kind == "kill" || (kind == "memory" && exit_code == 128 + SIGABRT);
      EXPECT_TRUE(is_killed || exit_code < 4) << kind << " at step " << at << ": " << exit_code;
      if (kind != "kill") continue;
      EXPECT_EQ(run(verb("2", out), {}), 0);
      EXPECT_TRUE(content_of(out) == after) << "run again after it died at step " << at;
      for (const char* journal : journals) EXPECT_FALSE(fs::exists(out / journal)) << journal;
    }
    std::cout << kind << ": " << tried << " of " << steps << " points tried" << std::endl;
  }
}

constexpr const char* quick =
    "scene: {model: 'builtin:teapot', longest_side: 1.0}\n"
    "sensor: {width: 160, height: 100, noise: {sigma: 0.03}}\n"
    "planner: {density: 5200, resolution_radius: 0.0525, occluder_spacing: 0.03}\n"
    "evaluation: {registration_distance: 0.03, samples: 3000, visible_directions: 30,\n"
    "             ceiling_views: 0}\n"
    "limits: {max_views: 3}\n"
    "scan: {orbit: {radius: 2, circles: 1, speed: 100}}\n";

/// A house of 20 m that is flown round, with a route in every format.
constexpr const char* flown =
    "scene: {model: 'builtin:teapot', longest_side: 20.0, ground: true}\n"
    "sensor: {width: 80, height: 60, max_range: 60, horizontal_fov_deg: 70, vertical_fov_deg: 55}\n"
    "planner: {name: skycap, density: 20, resolution_radius: 1.0, occluder_spacing: 0.6,\n"
    "          scene_box: {min: [-15, -15, -1], max: [15, 15, 15]}}\n"
    "evaluation: {registration_distance: 0.6, samples: 3000, visible_directions: 30,\n"
    "             ceiling_views: 0}\n"
    "site: {latitude_deg: 51.7, longitude_deg: -1.25, geoid_undulation: 46}\n"
    "limits: {max_views: 3, ground_clearance: 3}\n"
    "flight: {vehicle: generic, unknown_box: {min: [-12, -12, 0], max: [12, 12, 12]},\n"
    "         takeoff: [25, 25, 0]}\n";

constexpr long all = 1'000'000;

TEST(FaultPoints, PlanLeavesAWholeResult) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", quick);
  const Verb verb = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"plan",   mission, "--quiet", "--resume",
                                    "--seed", seed,    "--out",   out};
  };
  try_faults(verb, {"full", "kill"}, all);
  try_faults(verb, {"memory"}, 60);
}

/// On a full disk the new survey may stand without its route: exit code and summary say so.
TEST(FaultPoints, PlanWithAFlightLeavesAWholeResult) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", flown);
  try_faults(
      [&](const std::string& seed, const fs::path& out) {
        return std::vector<std::string>{"plan",   mission, "--quiet", "--resume",
                                        "--seed", seed,    "--out",   out};
      },
      {"kill"}, 12);
}

TEST(FaultPoints, ExportLeavesAWholeResult) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", flown), package = folder.path() / "package";
  ASSERT_EQ(run({"plan", mission, "--quiet", "--out", package}, {}), 0);
  const Verb verb = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"export", package, "--format",
                                    "plan",   "--set", "flight.cruise_speed=" + seed,
                                    "--out",  out};
  };
  try_faults(verb, {"full", "kill", "memory"}, 25);
}

TEST(FaultPoints, ScanLeavesAWholeResult) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", quick);
  const Verb verb = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"scan",   mission, "--quiet",  "--resume", "--threads", "1",
                                    "--seed", seed,    "--format", "ply",      "--out",     out};
  };
  try_faults(verb, {"full", "kill"}, all);
  try_faults(verb, {"memory"}, 40);
}

TEST(FaultPoints, TrialsLeaveAWholeResult) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", quick);
  try_faults(
      [&](const std::string& seed, const fs::path& out) {
        return std::vector<std::string>{"plan",   mission, "--quiet", "--trials", "1",
                                        "--seed", seed,    "--out",   out};
      },
      {"full", "kill"}, 40);
}

TEST(FaultPoints, BenchmarkLeavesAWholeResult) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", quick);
  const Verb verb = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"benchmark", mission,   "--planners", "see++", "--trials",
                                    seed,        "--quiet", "--out",      out};
  };
  try_faults(verb, {"full", "kill"}, 15);
}

TEST(FaultPoints, CampaignLeavesAWholeResult) {
  const testing_support::TemporaryFolder folder;
  folder.file("m.yaml", quick);
  const std::string head = "missions: [m.yaml]\nplanners: [see++]\nname: c\nseeds: ";
  const fs::path files[] = {folder.file("one.yaml", head + "1\n"),
                            folder.file("two.yaml", head + "2\n")};
  const Verb verb = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{
        "campaign", files[seed == "1" ? 0 : 1], "--quiet", "--no-report", "--out", out};
  };
  try_faults(verb, {"kill"}, 15);
}

TEST(FaultPoints, ModelsAreWhole) {
  try_faults(
      [&](const std::string& seed, const fs::path& out) {
        return std::vector<std::string>{"model",    "teapot",
                                        "--detail", seed == "1" ? "coarse" : "standard",
                                        "--out",    out / "m.ply"};
      },
      {"full", "kill", "memory"}, 8);
}

/// A survey with a flight, planned once with each seed: what verbs below read.
class Surveys {
 public:
  Surveys() : mission_(folder_.file("m.yaml", flown)) {
    for (const char* seed : {"1", "2"}) {
      EXPECT_EQ(run({"plan", mission_, "--quiet", "--no-report", "--seed", seed, "--out",
                     folder_.path() / seed},
                    {}),
                0);
    }
  }

  fs::path operator[](const std::string& seed) const { return folder_.path() / seed; }
  const std::string& mission() const { return mission_; }

 private:
  testing_support::TemporaryFolder folder_;
  std::string mission_;
};

TEST(FaultPoints, PagesAreWhole) {
  const Surveys surveys;
  // Not named .html, so that all of it is compared.
  const Verb report = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"report", surveys[seed], "--out", out / "page"};
  };
  try_faults(report, {"full", "kill"}, all);
  try_faults(report, {"memory"}, 25);
}

TEST(FaultPoints, MeshesOfCloudsAreWhole) {
  const Surveys surveys;
  const Verb reconstruct = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{
        "reconstruct", surveys[seed] / "cloud.ply", "--depth", "4", "--threads", "1", "--out",
        out / "m.ply"};
  };
  try_faults(reconstruct, {"full", "kill"}, all);
}

TEST(FaultPoints, FlyTestLeavesAWholeResult) {
  const Surveys surveys;
  const Verb fly_test = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"fly-test", surveys["1"], "--flights", "2",  "--returns",
                                    "2",        "--quiet",    "--seed",    seed, "--threads",
                                    "1",        "--out",      out};
  };
  try_faults(fly_test, {"full", "kill"}, all);
}

TEST(FaultPoints, ProposedMissionsAreWhole) {
  const testing_support::TemporaryFolder folder;
  const std::string map = folder.file(
      "map.geojson",
      R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"house"},)"
      R"("geometry":{"type":"Polygon","coordinates":[[[-1.25,51.75],[-1.2498,51.75],)"
      R"([-1.2498,51.7502],[-1.25,51.7502],[-1.25,51.75]]]}}]})");
  const Verb site = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{
        "site",     map,          "--base", "100",   "--height",
        "1" + seed, "--vertical", "geoid",  "--out", out / ("site_" + seed + ".yaml")};
  };
  try_faults(site, {"full"}, all);  // an older file is never written over
}

/// A live survey lives in its folder: whatever happens while a scan is taken in, the same scan,
/// sent again, brings it to where it would have been.
TEST(FaultPoints, LiveSurveysGoOnWithTheScanThatFailed) {
  const Surveys surveys;
  const testing_support::TemporaryFolder scratch;
  const fs::path old_folder = scratch.path() / "old", out = scratch.path() / "out",
                 count = scratch.path() / "count";
  const auto next = [&](const std::string& seed, const fs::path& folder) {
    return std::vector<std::string>{"next",
                                    surveys.mission(),
                                    "--survey",
                                    folder,
                                    "--no-report",
                                    "--quiet",
                                    "--set",
                                    "live.pose_check=false",
                                    "--world",
                                    "--id",
                                    seed,
                                    "--scan",
                                    surveys[seed] / "cloud.ply",
                                    "--pose",
                                    "0 -30 12 -0.7071068 0 0 0.7071068"};
  };
  ASSERT_EQ(run(next("1", old_folder), {}), 0);
  fs::copy(old_folder, out, fs::copy_options::recursive);
  ASSERT_EQ(run(next("2", out), {}), 0);
  const Content after = content_of(out);
  for (const char* kind : {"full", "kill"}) {
    fs::remove_all(out);
    fs::copy(old_folder, out, fs::copy_options::recursive);
    ASSERT_EQ(run(next("2", out), {kind, 0, count}), 0);
    const long steps = std::stol(geometry::read_file(count));
    for (long at = 1; at <= steps; ++at) {
      fs::remove_all(out);
      fs::copy(old_folder, out, fs::copy_options::recursive);
      const int exit_code = run(next("2", out), {kind, at, {}});
      EXPECT_TRUE(exit_code != 0 || content_of(out) == after) << kind << " at step " << at;
      EXPECT_EQ(run(next("2", out), {}), 0) << kind << " at step " << at;
      EXPECT_TRUE(content_of(out) == after) << "run again after " << kind << " at step " << at;
    }
    std::cout << kind << ": " << steps << " of " << steps << " points tried" << std::endl;
  }
}

}  // namespace
}  // namespace skycap
