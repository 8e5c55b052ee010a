#include "missions/session/own_planner_loader.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "missions/config/resolve.h"
#include "survey/planners/planner_options.h"
#include "tests/missions/run_skycap.h"
#include "tests/support/complaint.h"
#include "tests/support/temporary_folder.h"

namespace skycap::missions {
namespace {

using testing::HasSubstr;
using testing_support::thrown_message;

geometry::Scan two_points() {
  geometry::Scan scan;
  scan.world_from_sensor = geometry::camera_pose({{1.0, 2.0, 3.0}, Eigen::Vector3d::UnitX()});
  scan.points = {{4.0F, 5.0F, 6.0F}, {7.0F, 8.0F, 9.0F}};
  scan.pixels = {3, 9};
  return scan;
}

class PythonPlanner : public testing::Test {
 protected:
  survey::external::LoadedPlanner load(const std::string& text) const {
    return session::load_own_planner(folder_.file("mine.py", text).string(),
                                     {.seed = 7, .spacing = 0.5, .view_distance = 1.5});
  }

  testing_support::TemporaryFolder folder_;
};

TEST_F(PythonPlanner, ReceivesTaskAndScans) {
  const auto loaded = load(
      "class Mine:\n"
      "    def __init__(self, task):\n"
      "        self.task = task\n"
      "    def next_view(self, scan):\n"
      "        if scan.number == 1:\n"
      "            return None\n"
      "        print('printed lines do not disturb the answers')\n"
      "        sums = [scan.points[0, i] + scan.points[1, i] for i in range(3)]\n"
      "        position = [a + b + scan.pixels[1] for a, b in zip(sums, scan.position)]\n"
      "        axis = [row[2] * self.task.seed for row in scan.rotation]  # optical axis\n"
      "        assert list(scan.low) == [4, 5, 6] and list(scan.high) == [7, 8, 9]\n"
      "        return position, axis\n"
      "    def next_alternative_view(self):\n"
      "        return (self.task.view_distance, self.task.spacing, 0), (0, 0, 1)\n");
  geometry::PointCloud cloud;
  const geometry::Scan scan = two_points();
  cloud.positions = scan.points;
  const auto view = loaded.planner->next_view(scan, cloud);
  ASSERT_TRUE(view);
  EXPECT_EQ(view->position, Eigen::Vector3d(11 + 9 + 1, 13 + 9 + 2, 15 + 9 + 3));
  EXPECT_LT((view->direction - Eigen::Vector3d(7, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(loaded.planner->next_alternative_view()->position, Eigen::Vector3d(1.5, 0.5, 0.0));
  EXPECT_GE(loaded.processor_time_elsewhere(), 0.0);
  EXPECT_FALSE(loaded.planner->next_view(scan, cloud));
}

TEST_F(PythonPlanner, ReportsErrorWithLine) {
  const auto loaded = load(
      "class Mine:\n"
      "    def __init__(self, task): pass\n"
      "    def next_view(self, scan):\n"
      "        return 1 / 0\n");
  EXPECT_THAT(thrown_message([&] { loaded.planner->next_view(two_points(), {}); }),
              HasSubstr("ZeroDivisionError: division by zero (line 4 of mine.py)"));
}

TEST_F(PythonPlanner, RejectsWrongViewsAndFiles) {
  const auto loaded = load(
      "class Mine:\n"
      "    def __init__(self, task): pass\n"
      "    def next_view(self, scan): return (1, 2), (3, 4, 5)\n");
  EXPECT_THAT(thrown_message([&] { loaded.planner->next_view(two_points(), {}); }),
              HasSubstr("a position and a direction with 3 numbers each"));
  EXPECT_THAT(
      thrown_message([&] { load("x = 1\n"); }),
      HasSubstr("mine.py: TypeError: the file must have one class with a method next_view"));
  EXPECT_THAT(thrown_message([&] { load("class Mine\n"); }), HasSubstr("SyntaxError"));
  EXPECT_THAT(thrown_message([] { session::load_own_planner("no_such.py", {}); }),
              HasSubstr("no_such.py: cannot open the planner"));
  const std::string text = folder_.file("mine.txt", "").string();
  EXPECT_THAT(thrown_message([&] { session::load_own_planner(text, {}); }),
              HasSubstr("unsupported planner"));
  const std::string library = folder_.file("mine.so", "not a library").string();
  EXPECT_THAT(thrown_message([&] { session::load_own_planner(library, {}); }),
              HasSubstr("mine.so: cannot load the library"));
}

TEST_F(PythonPlanner, ReportsEndOfProcess) {
  const auto loaded = load(
      "import os\n"
      "class Mine:\n"
      "    def __init__(self, task): pass\n"
      "    def next_view(self, scan): os._exit(3)\n");
  EXPECT_THAT(thrown_message([&] { loaded.planner->next_view(two_points(), {}); }),
              HasSubstr("the Python process ended"));
}

// Code that a file names is not executed: the planner's file would create the marker.
TEST_F(PythonPlanner, IsExecutedOnlyIfUserNamesIt) {
  const std::filesystem::path marker = folder_.path() / "executed";
  const std::string file = folder_
                               .file("mine.py", "open('" + marker.string() +
                                                    "', 'w')\n"
                                                    "class Mine:\n"
                                                    "    def __init__(self, task): pass\n"
                                                    "    def next_view(self, scan): return None\n")
                               .string();
  const auto make = [](const std::string& text, const std::vector<config::KeyOverride>& overrides) {
    const config::MissionSetup mission = config::parse_mission(text, "m.yaml", overrides);
    survey::make_planner(mission.survey().planner, {.seed = 1});
  };
  const std::string plain = tests::quick_mission(), section = "planner: {";
  const std::string mission = std::string(plain).replace(
      plain.find(section), section.size(), "planner: {name: external, file: " + file + ", ");
  EXPECT_THAT(thrown_message([&] { make(mission, {}); }),
              AllOf(HasSubstr("planner.file (" + file + ") is code"),
                    HasSubstr("add --set planner.file=" + file)));
  // As from the file of a campaign.
  EXPECT_THAT(
      thrown_message([&] {
        make(plain, {{"c.yaml:3", "planner.name", "external"}, {"c.yaml:4", "planner.file", file}});
      }),
      HasSubstr("planner.file (" + file + ") is code"));
  EXPECT_FALSE(std::filesystem::exists(marker));
  make(mission, {{"--planner", "planner.file", file, true}});
  EXPECT_TRUE(std::filesystem::exists(marker));
}

TEST_F(PythonPlanner, IsExecutedByPlanIfCommandLineNamesIt) {
  const std::string file = folder_
                               .file("mine.py",
                                     "class Mine:\n"
                                     "    def __init__(self, task): pass\n"
                                     "    def next_view(self, scan): return None\n")
                               .string();
  const std::string mission = folder_.file("m.yaml", tests::quick_mission()).string();
  const auto plan = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"plan", mission, "--out", (folder_.path() / "out").string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return tests::run_skycap(arguments);
  };
  const auto named = plan({"--planner", file});
  EXPECT_EQ(named.exit_code, 0) << named.err;
  const auto missing = plan({"--planner", "external"});
  EXPECT_EQ(missing.exit_code, 2);
  EXPECT_THAT(missing.err, HasSubstr("key planner.file is missing; the planner external requires"));
}

}  // namespace
}  // namespace skycap::missions
