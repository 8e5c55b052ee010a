// Regression tests for inputs that crashed or blocked the program, or lost results. One test for
// each class.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "geometry/io/mesh_io.h"
#include "missions/cli/printable.h"
#include "missions/config/resolve.h"
#include "missions/evaluation/survey_scene.h"
#include "tests/missions/run_skycap.h"

namespace skycap::missions {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using tests::quick_mission;
using tests::read_content;
using tests::run_skycap;
using tests::TestFolder;

/// Returns the one-line error message for these arguments.
std::string rejection(const std::vector<std::string>& arguments) {
  const tests::ProgramRun run = run_skycap(arguments);
  EXPECT_EQ(run.exit_code, 2) << run.err << run.out;
  EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << run.err;
  return run.err;
}

std::string summary_with(const std::string& settings, const std::string& rest) {
  return "{\"settings\": {\"scene.model\": \"builtin:teapot\", "
         "\"evaluation.coverage_distance\": 0.03" +
         settings + "}, " + rest + "}";
}

TEST(HostileInput, RejectsDeeplyNestedJson) {
  const TestFolder folder;
  const std::string deep(200'000, '[');
  const std::string mission = folder.write("m.yaml", quick_mission());
  for (const char* name : {"deep.plan", "deep.geojson"}) {
    EXPECT_THAT(rejection({"check", mission, "--route", folder.write(name, deep)}),
                HasSubstr(name));
  }
  folder.write("summary.json", deep);
  EXPECT_THAT(rejection({"export", folder.path().string(), "--format", "csv"}),
              HasSubstr("summary.json: is not the summary of a package"));
}

TEST(HostileInput, RejectsPackagesWithPositionsOutOfRange) {
  const TestFolder folder;
  const auto message = [&](const std::string& summary) {
    folder.write("summary.json", summary);
    return rejection({"export", folder.path().string(), "--format", "csv"});
  };
  EXPECT_THAT(message(summary_with("", "\"flight\": {\"pad\": [1e300, 0, 0]}, \"per_view\": []")),
              HasSubstr("summary.json: flight.pad is (1e+300, 0, 0)"));
  EXPECT_THAT(message(summary_with("",
                                   "\"flight\": {\"pad\": [0, 0, 0]}, \"per_view\": "
                                   "[{\"position\": [0, 0, 2e7], \"direction\": [1, 0, 0]}]")),
              HasSubstr("per_view[0].position is (0, 0, 2e+07)"));
  EXPECT_THAT(message(summary_with("",
                                   "\"flight\": {\"pad\": [0, 0, 0]}, \"per_view\": "
                                   "[{\"position\": [0, 0, 2], \"direction\": [0, 0, 0]}]")),
              HasSubstr("per_view[0].direction is (0, 0, 0)"));
  EXPECT_THAT(message(summary_with(", \"zzz.4000000000\": 1", "\"flight\": {}")),
              HasSubstr("settings.zzz.4000000000 is unknown"));
}

TEST(HostileInput, RejectsScanRoutesOutOfRange) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  const std::string tum = folder.write("far.tum", "0 0 0 1e19 0 0 0 1\n1 0 0 1e19 0 0 0 1\n");
  EXPECT_THAT(rejection({"scan", mission, "--route", tum, "--out", folder / "out"}),
              HasSubstr("trajectory pose 0 is (0, 0, 1e+19)"));
}

TEST(HostileInput, RejectsSensorsWithUnrealisticValues) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  const auto message = [&](const std::string& more) {
    const std::string sensor = folder.write(
        "s.yaml",
        "name: S\nkind: spinning\nchannels: {count: 2, lowest_deg: -1, highest_deg: 1}\n"
        "range: {min: 0.1, max: 50}\n" +
            more);
    return rejection({"scan", mission, "--sensor", sensor, "--out", folder / "out"});
  };
  const std::string rate = "rotation_rate_hz: 10\n", columns = "columns_per_turn: 100\n";
  EXPECT_THAT(message(rate + columns + "radial_offset_mm: 1e300\n"), HasSubstr("radial_offset"));
  EXPECT_THAT(message(rate + "columns_per_turn: 1e300\n"), HasSubstr("firing_period"));
  EXPECT_THAT(message(rate + "firing_period_us: 1e-9\n"), HasSubstr("firing_period"));
  EXPECT_THAT(message(rate + columns + "errors: {angle_sigma_deg: 1e300}\n"),
              HasSubstr("errors.angle_sigma"));
  EXPECT_THAT(rejection({"scan", mission, "--sensor", "/dev/zero.yaml"}),
              HasSubstr("does not exist"));
  std::filesystem::create_directory(folder.path() / "folder.yaml");
  EXPECT_THAT(rejection({"scan", mission, "--sensor", folder / "folder.yaml"}),
              HasSubstr("folder.yaml: is a directory"));
}

TEST(HostileInput, RejectsMeshesBeyondSinglePrecision) {
  const TestFolder folder;
  const std::string mesh = folder.write("far.obj", "v 0 0 0\nv 1e39 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_THAT(rejection({"model", mesh}), HasSubstr("far.obj: face 0: vertex 1 is (1e+39, 0, 0)"));
  EXPECT_THAT(
      rejection({"evaluate", "--mesh", mesh, "--model", "builtin:teapot", "--distance", "0.1"}),
      HasSubstr("far.obj: face 0: vertex 1"));
  EXPECT_THAT(
      rejection({"evaluate", "--mesh", mesh, "--model", "builtin:teapot", "--distance", "nan"}),
      HasSubstr("nan is not a number"));
}

TEST(HostileInput, RejectsExcessiveWorkBeforeStart) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  const auto message = [&](const std::vector<std::string>& options) {
    std::vector<std::string> arguments{"scan", mission, "--out", folder / "out"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return rejection(arguments);
  };
  EXPECT_THAT(message({"--set", "scan.orbit.speed=1e-6"}), HasSubstr("scan.orbit.speed: "));
  EXPECT_THAT(message({"--sensor", "see_d435", "--set", "scan.frame_period=1e-6"}),
              HasSubstr("scan.frame_period: "));
  const std::string gap = folder.write("gap.tum", "0 0 0 1 0 0 0 1\n1e9 0 0 1 0 0 0 1\n");
  EXPECT_THAT(message({"--route", gap}), HasSubstr("firings"));
  EXPECT_THAT(rejection({"plan", mission, "--set", "evaluation.coverage_distance=1e-300"}),
              HasSubstr("coverage_distance"));
}

TEST(HostileInput, RemovesControlCharactersFromOutput) {
  const tests::ProgramRun run = run_skycap({"plan", "/nowhere/\x1b[2J\x07.yaml"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, AllOf(Not(HasSubstr("\x1b")), Not(HasSubstr("\x07"))));
  EXPECT_EQ(cli::printable_line("a\x1b[31m\tb\xC2\x9B\x7f\n"), "a [31m b\xC2  ");
  EXPECT_LT(cli::printable_line(std::string(100'000, 'x')).size(), 2000U);
  std::ostringstream text;
  cli::PrintableBuffer buffer(*text.rdbuf());
  std::ostream(&buffer) << "h\xC3\xA9\x1b\n";
  EXPECT_EQ(text.str(), "h\xC3\xA9 \n");
}

TEST(HostileInput, RejectsRouteFilesWithPositionsOutOfRange) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  const auto message = [&](const std::string& name, const std::string& content) {
    return rejection({"check", mission, "--route", folder.write(name, content)});
  };
  EXPECT_THAT(message("far.tum", "0 0 0 1e308 0 0 0 1\n1 0 0 -1e308 0 0 0 1\n"),
              HasSubstr("far.tum: place 1 is (0, 0, 1e+308)"));
  const std::string items = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t51.75\t-1.25\t100\t1\n";
  EXPECT_THAT(message("far.waypoints", items + "1\t0\t3\t16\t0\t0\t0\t0\t51.75\t-1.25\t1e300\t1\n"),
              HasSubstr("far.waypoints"));
}

TEST(HostileInput, ReportsUnknownModelNames) {
  const TestFolder folder;
  const std::string mission = folder.write(
      "m.yaml", "scene: {model: 'builtin:nope'}\nevaluation: {coverage_distance: 1}\n");
  EXPECT_THAT(rejection({"check", mission}),
              HasSubstr("m.yaml:1: key scene.model: unknown model builtin:nope; expected one of: "
                        "builtin:bridge, "));
  const std::string cloud = folder.write("c.xyz", "0 0 0\n");
  EXPECT_THAT(
      rejection({"evaluate", "--cloud", cloud, "--model", "builtin:nope", "--distance", "1"}),
      HasSubstr("--model: unknown builtin model 'nope'"));
}

TEST(HostileInput, RejectsTooManyModelCopies) {
  const TestFolder folder;
  std::string copies;
  for (int i = 0; i < 1000; ++i) copies += "[0, 0, 0], ";
  const std::string mission =
      folder.write("m.yaml", "scene: {model: 'builtin:teapot', copies: [" + copies +
                                 "[1, 1, 1]]}\nevaluation: {coverage_distance: 1}\n");
  EXPECT_THAT(
      rejection({"check", mission}),
      HasSubstr("m.yaml: scene.copies: 1002 times 16256 triangles exceed the limit of 1e+07"));
}

TEST(HostileInput, ReadsHundredThousandMaterials) {
  const TestFolder folder;
  std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (int i = 0; i < 100'000; ++i) mesh += "usemtl m" + std::to_string(i) + "\nf 1 2 3\n";
  const std::string path = folder.write("m.obj", mesh);
  EXPECT_EQ(geometry::read_mesh_by_material(path).size(), 100'000U);
}

TEST(HostileInput, RejectsReconstructionOfCollinearPoints) {
  const TestFolder folder;
  for (const double step : {0.0, 0.001}) {
    std::string line;
    for (int i = 0; i < 500; ++i) line += std::to_string(step * i) + " 1 2\n";
    EXPECT_THAT(
        rejection({"reconstruct", folder.write("line.xyz", line), "--out", folder / "m.ply"}),
        HasSubstr("line.xyz: all points are on one line"));
  }
}

/// Interrupts the program soon after its start and returns its exit code, or -1 if it does not end.
int exit_code_after_interruption(const std::vector<std::string>& arguments) {
  std::vector<char*> words{const_cast<char*>(SKYCAP_PROGRAM)};
  for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  pid_t process = 0;
  if (::posix_spawn(&process, words[0], nullptr, nullptr, words.data(), environ) != 0) return -1;
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  ::kill(process, SIGINT);
  for (int tenths = 0; tenths < 50; ++tenths) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    int status = 0;
    if (::waitpid(process, &status, WNOHANG) != process) continue;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  }
  ::kill(process, SIGKILL);
  ::waitpid(process, nullptr, 0);
  return -1;
}

TEST(HostileInput, StopsWaitingForPipeOnCtrlC) {
  const TestFolder folder;
  const std::string pipe = folder / "m.yaml";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(exit_code_after_interruption({"check", pipe}), 1);
  EXPECT_EQ(exit_code_after_interruption({"plan", pipe, "--out", folder / "out"}), 1);
}

TEST(HostileInput, StopsAttainableCoverageOnCtrlC) {
  const TestFolder folder;
  const std::string file = folder.write("m.yaml", quick_mission());
  const config::MissionSetup mission = config::read_mission(
      // Its attainable coverage is not in the cache.
      file, {{"--set", "evaluation.attainable_views", "7"}});
  const evaluation::SurveyScene scene(mission.simulation, folder.path(), 0);
  std::stop_source stopped;
  stopped.request_stop();
  EXPECT_THAT(scene.visible(1, stopped.get_token()), testing::Each(0));
  EXPECT_EQ(scene.attainable(std::vector<std::uint8_t>(scene.samples().points.size(), 1), 1,
                             stopped.get_token()),
            std::nullopt);
}

/// Stream buffer that behaves like a full disk.
class FullBuffer : public std::streambuf {};

TEST(HostileInput, FailsWhenResultsCannotBePrinted) {
  FullBuffer full;
  std::ostream out(&full);
  std::ostringstream err;
  EXPECT_EQ(cli::run_command_line({"check", "--keys"}, {out, err}), 3);
  EXPECT_THAT(err.str(), HasSubstr("cannot write to standard output"));
}

TEST(HostileInput, SkipsFinishedTrials) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  const auto trials = [&](const std::string& count, const std::string& seed,
                          const std::stop_token& stop = {}) {
    return run_skycap(
        {"plan", mission, "--trials", count, "--seed", seed, "--quiet", "--out", folder / "out"},
        false, stop);
  };
  ASSERT_EQ(trials("2", "1").exit_code, 0);
  const std::string before = read_content(folder / "out/trials.csv");  // including planning times
  ASSERT_EQ(trials("3", "1").exit_code, 0);
  EXPECT_TRUE(read_content(folder / "out/trials.csv").starts_with(before));
  std::stop_source stopped;
  stopped.request_stop();
  const std::string all = read_content(folder / "out/trials.csv");
  EXPECT_EQ(trials("3", "7", stopped.get_token()).exit_code, 1);
  EXPECT_EQ(read_content(folder / "out/trials.csv"), all);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/interrupted/trials.csv"));
}

TEST(HostileInput, KeepsCompleteSurveyWhenRepeatIsInterrupted) {
  const TestFolder folder;
  const std::string mission = folder.write("m.yaml", quick_mission());
  const std::vector<std::string> plan{"plan", mission, "--quiet", "--out", folder / "out"};
  ASSERT_EQ(run_skycap(plan).exit_code, 0);
  const std::string whole = read_content(folder / "out/summary.json");
  std::stop_source stopped;
  stopped.request_stop();
  EXPECT_EQ(run_skycap(plan, false, stopped.get_token()).exit_code, 1);
  ASSERT_THAT(whole, HasSubstr("\"complete\": true"));
  EXPECT_EQ(read_content(folder / "out/summary.json"), whole);
  EXPECT_TRUE(std::filesystem::exists(folder / "out/interrupted/summary.json"));
}

}  // namespace
}  // namespace skycap::missions
