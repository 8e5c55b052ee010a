#include "tests/faults/fault_run.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <sstream>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "geometry/io/file.h"
#include "geometry/io/output_folder.h"

namespace skycap::faults {
namespace {

namespace fs = std::filesystem;

std::string repeatable_part(const fs::path& file) {
  const std::string bytes = geometry::read_file(file), extension = file.extension();
  if (extension == ".md") return bytes.substr(0, bytes.find('\n'));
  // The end shows that the file is complete.
  if (extension == ".html") return bytes.substr(bytes.size() - 12);
  if (extension != ".json" && extension != ".csv") return bytes;
  std::istringstream lines(bytes);
  std::string kept;
  for (std::string line; std::getline(lines, line);) {
    const bool is_run_specific =
        line.find("seed\"") != std::string::npos || line.find("\"complete\"") != std::string::npos;
    if (extension == ".csv") kept += line.substr(0, line.rfind(',')) + "\n";
    if (extension == ".json" && is_run_specific) kept += line + "\n";
  }
  return kept;
}

/// Removes the times from the trial tables. Seeds, views and coverage remain.
std::string without_times(const std::string& name, const std::string& text) {
  if (name == "curves.svg") return text.substr(0, text.find('>'));  // The axes show times, too.
  if (name == "curves.csv") return text.substr(0, text.find(",planning_time_s,"));
  if (name != "trials.csv" && name != "table1.csv" && name != "times.csv") return text;
  const std::size_t kept_length = name == "times.csv" ? 1 : 12;
  std::istringstream lines(text);
  std::string kept;
  for (std::string line; std::getline(lines, line);) kept += line.substr(0, kept_length) + "\n";
  return kept;
}

/// Files from which an interrupted survey or scan resumes.
constexpr std::array journals{"survey.journal", "survey.points", "unfinished"};

/// Runs `change` in a copy of the old folder.
int changed(const Trial& trial, const fs::path& out, const Fault& fault) {
  fs::remove_all(out);
  fs::copy(trial.old_folder, out, fs::copy_options::recursive);
  return trial.change(out, fault);
}

/// Returns the number of steps of this kind in a run without faults.
long count_steps(const Trial& trial, const std::string& kind, const fs::path& scratch) {
  const fs::path count = scratch / "count";
  EXPECT_EQ(changed(trial, scratch / "out", {kind, 0, count}), 0);
  const long steps = std::stol(geometry::read_file(count));
  EXPECT_GT(steps, 0) << kind;
  return steps;
}

/// Checks that the command succeeds when it is repeated after the program died.
void expect_repeatable(const Trial& trial, const fs::path& out, const Content& found,
                       const Content& after) {
  if (trial.can_be_repeated || found != after) {
    EXPECT_EQ(trial.change(out, {}), 0);
  }
  EXPECT_TRUE(read_content(out) == after) << "run again after it died";
  for (const char* journal : journals) EXPECT_FALSE(fs::exists(out / journal)) << journal;
}

void try_fault(const Trial& trial, const Fault& fault, const fs::path& out, const Content& before,
               const Content& after) {
  const int exit_code = changed(trial, out, fault);
  // Removes leftovers when the next command opens the folder.
  { const geometry::OutputFolder next(out); }
  const Content found = read_content(out);
  const bool is_other = trial.may_also_be && exit_code != 0 && trial.may_also_be(found, after);
  EXPECT_TRUE(found == before || found == after || is_other) << "neither old nor new";
  EXPECT_TRUE(exit_code != 0 || found == after) << "exit 0";
  // If memory runs out before main(), the runtime aborts.
  const bool is_killed =
      fault.kind == "kill" || (fault.kind == "memory" && exit_code == 128 + SIGABRT);
  EXPECT_TRUE(is_killed || exit_code < 4) << "exit " << exit_code;
  if (fault.kind == "kill") expect_repeatable(trial, out, found, after);
}

/// Tries a sample of the fault points and prints the numbers of tried and existing points.
void try_points(const std::string& kind, long steps, long sample,
                const std::function<void(const Fault&)>& try_point) {
  const bool tries_all = std::getenv("FAULT_POINTS") != nullptr && kind != "memory";
  const long stride = tries_all ? 1 : std::max(1L, steps / sample);
  long tried = 0;
  for (long at = 1; at <= steps; at += stride, ++tried) {
    SCOPED_TRACE(kind + " at step " + std::to_string(at));
    try_point({kind, at, {}});
  }
  std::cout << kind << ": " << tried << " of " << steps << " points tried" << std::endl;
}

}  // namespace

Content read_content(const fs::path& folder) {
  Content content;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    if (name == "interrupted" || name == "items") continue;
    if (std::ranges::find(journals, name) != journals.end()) continue;
    content[name] = entry.is_directory() ? "" : without_times(name, repeatable_part(entry.path()));
  }
  return content;
}

pid_t start(const std::vector<std::string>& arguments, const Fault& fault, int output) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  ::setenv("LD_PRELOAD", FAULT_INJECTOR, 1);
  ::setenv("FAULT_KIND", fault.kind.c_str(), 1);
  ::setenv("FAULT_AT", std::to_string(fault.at).c_str(), 1);
  if (!fault.count.empty()) ::setenv("FAULT_COUNT", fault.count.c_str(), 1);
  std::vector<char*> words{const_cast<char*>(SKYCAP_PROGRAM)};
  for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  const int nowhere = ::open("/dev/null", O_WRONLY);
  if (::dup2(output < 0 ? nowhere : output, STDOUT_FILENO) >= 0 &&
      ::dup2(nowhere, STDERR_FILENO) >= 0) {
    ::execv(words[0], words.data());
  }
  ::_exit(127);
}

int wait_for_exit_code(pid_t program) {
  int status = 0;
  ::waitpid(program, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int run(const std::vector<std::string>& arguments, const Fault& fault) {
  return wait_for_exit_code(start(arguments, fault));
}

bool is_survey_without_route(const Content& found, const Content& after) {
  constexpr std::array survey{"cloud.ply", "views.csv", "summary.json"};
  return std::ranges::all_of(survey, [&](const char* name) { return found.contains(name); }) &&
         std::ranges::includes(after, found);
}

void try_faults(const Trial& trial, const std::vector<std::string>& kinds, long sample) {
  const testing_support::TemporaryFolder scratch;
  const fs::path out = scratch.path() / "out";
  const Content before = read_content(trial.old_folder);
  ASSERT_EQ(changed(trial, out, {}), 0);
  const Content after = read_content(out);
  ASSERT_NE(before, after);
  for (const std::string& kind : kinds) {
    try_points(kind, count_steps(trial, kind, scratch.path()), sample,
               [&](const Fault& fault) { try_fault(trial, fault, out, before, after); });
  }
}

void try_faults(const Command& command, const std::vector<std::string>& kinds, long sample) {
  const testing_support::TemporaryFolder scratch;
  const fs::path old_folder = scratch.path() / "old";
  fs::create_directories(old_folder);
  ASSERT_EQ(run(command("1", old_folder), {}), 0);
  const Change change = [&](const fs::path& out, const Fault& fault) {
    return run(command("2", out), fault);
  };
  try_faults({.old_folder = old_folder, .change = change, .may_also_be = {}}, kinds, sample);
}

void try_going_on(const Trial& trial, long sample) {
  const testing_support::TemporaryFolder scratch;
  const fs::path out = scratch.path() / "out";
  ASSERT_EQ(changed(trial, out, {}), 0);
  const Content after = read_content(out);
  for (const char* kind : {"full", "kill"}) {
    try_points(kind, count_steps(trial, kind, scratch.path()), sample, [&](const Fault& fault) {
      const int exit_code = changed(trial, out, fault);
      EXPECT_TRUE(exit_code != 0 || read_content(out) == after) << "exit 0";
      EXPECT_EQ(trial.change(out, {}), 0);
      EXPECT_TRUE(read_content(out) == after) << "run again";
    });
  }
}

const char* const quick =
    "scene: {model: 'builtin:teapot', longest_side: 1.0}\n"
    "sensor: {width: 160, height: 100, noise: {sigma: 0.03}}\n"
    "planner: {density: 5200, resolution_radius: 0.0525, occluder_spacing: 0.03}\n"
    "evaluation: {coverage_distance: 0.03, samples: 3000, visible_directions: 30,\n"
    "             attainable_views: 0}\n"
    "limits: {max_views: 3}\n"
    "scan: {orbit: {radius: 2, circles: 1, speed: 100}}\n";

const char* const flight_mission_text =
    "scene: {model: 'builtin:teapot', longest_side: 20.0, ground: true}\n"
    "sensor: {width: 80, height: 60, max_range: 60, horizontal_fov_deg: 70, vertical_fov_deg: 55}\n"
    "planner: {name: skycap, density: 20, resolution_radius: 1.0, occluder_spacing: 0.6,\n"
    "          scene_box: {min: [-15, -15, -1], max: [15, 15, 15]}}\n"
    "evaluation: {coverage_distance: 0.6, samples: 3000, visible_directions: 30,\n"
    "             attainable_views: 0}\n"
    "site: {latitude_deg: 51.7, longitude_deg: -1.25, geoid_undulation: 46}\n"
    "limits: {max_views: 3, ground_clearance: 3}\n"
    "flight: {vehicle: generic, unknown_box: {min: [-12, -12, 0], max: [12, 12, 12]},\n"
    "         takeoff: [25, 25, 0]}\n";

Surveys::Surveys() : mission_(folder_.file("m.yaml", flight_mission_text)) {
  for (const char* seed : {"1", "2"}) {
    EXPECT_EQ(run({"plan", mission_, "--quiet", "--no-report", "--seed", seed, "--out",
                   folder_.path() / seed},
                  {}),
              0);
  }
}

}  // namespace skycap::faults
