// Each disk operation of a command fails once, and the program is killed once at each of them. Each
// start of a child process and a sample of allocations fail as well.
#include <cmath>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/io/file.h"
#include "tests/faults/fault_run.h"
#include "tests/support/temporary_folder.h"

namespace skycap::faults {
namespace {

namespace fs = std::filesystem;

TEST(FaultPoints, LeavePlanResultsComplete) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", quick);
  const Command command = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"plan",   mission, "--quiet", "--resume",
                                    "--seed", seed,    "--out",   out};
  };
  try_faults(command, {"full", "kill"}, all);
  try_faults(command, {"memory"}, 60);
}

/// On a full disk the new survey may be complete without its route. The exit code then reports the
/// failure.
TEST(FaultPoints, LeavePlanResultsWithFlightComplete) {
  const Surveys surveys;
  const Trial trial{.old_folder = surveys["1"],
                    .change =
                        [&](const fs::path& out, const Fault& fault) {
                          return run({"plan", surveys.mission(), "--quiet", "--no-report",
                                      "--resume", "--seed", "2", "--out", out},
                                     fault);
                        },
                    .may_also_be = is_survey_without_route};
  try_faults(trial, {"full", "kill"}, 12);
}

TEST(FaultPoints, LeaveExportResultsComplete) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", flight_mission_text),
                    package = folder.path() / "package";
  ASSERT_EQ(run({"plan", mission, "--quiet", "--out", package}, {}), 0);
  const Command command = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"export", package, "--format",
                                    "plan",   "--set", "flight.cruise_speed=" + seed,
                                    "--out",  out};
  };
  try_faults(command, {"full", "kill", "memory"}, 25);
}

TEST(FaultPoints, LeaveScanResultsComplete) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", quick);
  const Command command = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"scan",   mission, "--quiet",  "--resume", "--threads", "1",
                                    "--seed", seed,    "--format", "ply",      "--out",     out};
  };
  try_faults(command, {"full", "kill"}, all);
  try_faults(command, {"memory"}, 40);
}

TEST(FaultPoints, LeaveTrialResultsComplete) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", quick);
  try_faults(
      [&](const std::string& seed, const fs::path& out) {
        return std::vector<std::string>{"plan",   mission, "--quiet", "--trials", "1",
                                        "--seed", seed,    "--out",   out};
      },
      {"full", "kill"}, 40);
}

TEST(FaultPoints, LeaveBenchmarkResultsComplete) {
  const testing_support::TemporaryFolder folder;
  const std::string mission = folder.file("m.yaml", quick);
  const Command command = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"benchmark", mission,   "--planners", "see++", "--trials",
                                    seed,        "--quiet", "--out",      out};
  };
  try_faults(command, {"full", "kill"}, 15);
}

/// On a full disk the tables may contain only the runs that fitted. The exit code then reports the
/// failure, and the same command resumes the campaign.
TEST(FaultPoints, LeaveCampaignResultsComplete) {
  const testing_support::TemporaryFolder folder;
  folder.file("m.yaml", quick);
  const std::string head = "missions: [m.yaml]\nplanners: [see++]\nname: c\nseeds: ";
  const fs::path files[] = {folder.file("one.yaml", head + "1\n"),
                            folder.file("two.yaml", head + "2\n")};
  const auto campaign = [](const fs::path& file, const fs::path& out, const Fault& fault) {
    return run({"campaign", file, "--quiet", "--no-report", "--out", out}, fault);
  };
  const fs::path old_folder = folder.path() / "old";
  fs::create_directories(old_folder);
  ASSERT_EQ(campaign(files[0], old_folder, {}), 0);
  const Trial trial{.old_folder = old_folder,
                    .change = [&](const fs::path& out,
                                  const Fault& fault) { return campaign(files[1], out, fault); },
                    .may_also_be = {}};
  try_faults(trial, {"kill"}, 15);
  try_going_on(trial, 8);
}

TEST(FaultPoints, LeaveModelFilesComplete) {
  try_faults(
      [&](const std::string& seed, const fs::path& out) {
        return std::vector<std::string>{"model",    "teapot",
                                        "--detail", seed == "1" ? "coarse" : "standard",
                                        "--out",    out / "m.ply"};
      },
      {"full", "kill", "memory"}, 8);
}

TEST(FaultPoints, LeaveHtmlReportsComplete) {
  const Surveys surveys;
  // The suffix is not .html, so that the complete file is compared.
  const Command report = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"report", surveys[seed], "--out", out / "page"};
  };
  try_faults(report, {"full", "kill"}, all);
  try_faults(report, {"memory"}, 25);
}

TEST(FaultPoints, LeaveReconstructedMeshesComplete) {
  const Surveys surveys;
  const Command reconstruct = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{
        "reconstruct", surveys[seed] / "cloud.ply", "--depth", "4", "--threads", "1", "--out",
        out / "m.ply"};
  };
  try_faults(reconstruct, {"full", "kill"}, all);
}

TEST(FaultPoints, LeaveFlyTestResultsComplete) {
  const Surveys surveys;
  const Command fly_test = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"fly-test", surveys["1"], "--flights", "2",  "--returns",
                                    "2",        "--quiet",    "--seed",    seed, "--threads",
                                    "1",        "--out",      out};
  };
  try_faults(fly_test, {"full", "kill"}, all);
}

TEST(FaultPoints, LeaveProposedMissionsComplete) {
  const testing_support::TemporaryFolder folder;
  const std::string map = folder.file(
      "map.geojson",
      R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"name":"house"},)"
      R"("geometry":{"type":"Polygon","coordinates":[[[-1.25,51.75],[-1.2498,51.75],)"
      R"([-1.2498,51.7502],[-1.25,51.7502],[-1.25,51.75]]]}}]})");
  const auto site = [&](const std::string& height, const fs::path& out) {
    return std::vector<std::string>{
        "site", map,          "--base", "100",   "--height",
        height, "--vertical", "geoid",  "--out", out / ("site_" + height + ".yaml")};
  };
  const fs::path old_folder = folder.path() / "old";
  fs::create_directories(old_folder);
  ASSERT_EQ(run(site("11", old_folder), {}), 0);
  const Trial trial{.old_folder = old_folder,
                    .change = [&](const fs::path& out,
                                  const Fault& fault) { return run(site("12", out), fault); },
                    .can_be_repeated = false,  // existing files are never overwritten
                    .may_also_be = {}};
  try_faults(trial, {"full", "kill"}, all);
  try_faults(trial, {"memory"}, 15);
}

TEST(FaultPoints, LeaveViewerPagesComplete) {
  const Surveys surveys;
  // The suffix is not .html, so that the complete file is compared.
  const auto view = [&](const fs::path& what) {
    return [&, what](const std::string& seed, const fs::path& out) {
      return std::vector<std::string>{"view", surveys[seed] / what, "--out", out / "page"};
    };
  };
  try_faults(view("cloud.ply"), {"full", "kill"}, all);
  try_faults(view("cloud.ply"), {"memory"}, 15);
  try_faults(view(""), {"full", "kill"}, all);
}

/// Returns a log of eight minutes with hover, climbs, descents and legs in four directions.
std::string flight_log(double hover_power) {
  std::ostringstream log;
  log << "time_s,east_m_s,north_m_s,up_m_s,power_w\n";
  int count = 0;
  const auto fly = [&](double east, double north, double up, int seconds) {
    const double power = hover_power + 40.0 * up + 0.12 * std::pow(std::hypot(east, north), 3.0);
    for (int i = 0; i < 10 * seconds; ++i, ++count) {
      log << 0.1 * count << ',' << east << ',' << north << ',' << up << ',' << power << '\n';
    }
  };
  fly(0, 0, 0, 70);
  fly(0, 0, 2.5, 20);
  for (const double speed : {3.0, 6.0, 9.0}) {
    fly(speed, 0, 0, 25);
    fly(0, speed, 0, 25);
    fly(-speed, 0, 0, 25);
    fly(0, -speed, 0, 25);
  }
  fly(0, 0, -1.5, 33);
  fly(0, 0, 0, 70);
  return log.str();
}

TEST(FaultPoints, LeaveCalibratedVehicleFilesComplete) {
  const testing_support::TemporaryFolder folder;
  const std::string logs[] = {folder.file("1.csv", flight_log(300.0)),
                              folder.file("2.csv", flight_log(320.0))};
  const Command calibrate = [&](const std::string& seed, const fs::path& out) {
    return std::vector<std::string>{"calibrate", logs[seed == "1" ? 0 : 1],
                                    "--vehicle", "generic_ardupilot",
                                    "--out",     out / "v.yaml"};
  };
  try_faults(calibrate, {"full", "kill"}, all);
  try_faults(calibrate, {"memory"}, 25);
}

/// Returns the number of renames and appended records of a command that follow data which is not on
/// the disk yet.
long count_unflushed(const std::vector<std::string>& arguments, const fs::path& count) {
  EXPECT_EQ(run(arguments, {"unflushed", 0, count}), 0);
  return std::stol(geometry::read_file(count));
}

// Otherwise a power failure could leave an empty file with its final name, or a gap in a journal.
TEST(FlushedFiles, AreOnTheDiskBeforeTheNextStep) {
  const testing_support::TemporaryFolder folder;
  const fs::path count = folder.path() / "count", out = folder.path() / "package";
  const std::string mission = folder.file("m.yaml", flight_mission_text),
                    log = folder.file("1.csv", flight_log(300.0));
  EXPECT_EQ(count_unflushed({"plan", mission, "--quiet", "--resume", "--out", out}, count), 0);
  EXPECT_EQ(
      count_unflushed({"export", out, "--format", "plan", "--out", folder.path() / "plan"}, count),
      0);
  EXPECT_EQ(count_unflushed({"calibrate", log, "--vehicle", "generic_ardupilot", "--out",
                             folder.path() / "v.yaml"},
                            count),
            0);
}

}  // namespace
}  // namespace skycap::faults
