// The programs themselves: skycap serve, skycap_ros2, and here a robot that knows nothing but
// topics.

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "clients/ros2/frames.h"
#include "geometry/io/record_log.h"
#include "missions/live/live_journal.h"
#include "tests/clients/ros2/dds_domain.h"
#include "tests/clients/ros2/robot.h"
#include "tests/missions/flown_mission.h"
#include "tests/missions/live/rehearsal.h"
#include "tests/missions/run_skycap.h"

namespace skycap::ros2 {
namespace {

using missions::live::short_mission;
using testing::HasSubstr;
using tests::content_of;
using tests::TestFolder;
using namespace std::chrono_literals;

/// A program that runs beside us; what it says goes to a file.
class Program {
 public:
  Program(std::vector<std::string> words, std::string log) : log_(std::move(log)) {
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_addopen(&actions, 1, log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                       0600);
    ::posix_spawn_file_actions_adddup2(&actions, 1, 2);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    EXPECT_EQ(::posix_spawn(&process_, arguments[0], &actions, nullptr, arguments.data(), environ),
              0);
    ::posix_spawn_file_actions_destroy(&actions);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }

  void signal(int number) const { ::kill(process_, number); }

  /// Nothing if it has not ended after a minute; minus the signal that ended it.
  std::optional<int> exit_code() {
    for (int i = 0; i < 600; ++i) {
      int status = 0;
      if (::waitpid(process_, &status, WNOHANG) == process_) {
        process_ = 0;
        return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
      }
      std::this_thread::sleep_for(100ms);
    }
    return std::nullopt;
  }

  std::string said() const { return content_of(log_); }

 private:
  std::string log_;
  pid_t process_ = 0;
};

class LiveRobot : public testing::Test {
 protected:
  /// Half a minute for `serve` to come up.
  void serve(const std::string& mission) {
    folder_.write("m.yaml", mission);
    server_.emplace(
        std::vector<std::string>{SKYCAP_PROGRAM, "serve", folder_ / "m.yaml", "--survey",
                                 folder_ / "served", "--socket", folder_ / "s"},
        folder_ / "server.log");
    for (int i = 0; i < 300 && server_->said().find("unix:") == std::string::npos; ++i) {
      std::this_thread::sleep_for(100ms);
    }
  }
  void start_bridge(const std::vector<std::string>& more = {"--sensor", "0 0 0 0 0 0 1"}) {
    std::vector<std::string> words{
        SKYCAP_ROS2_PROGRAM, "unix:" + (folder_ / "s"), "--domain",   std::to_string(domain_),
        "--odometry",        topics_ + "/odom",         "--cloud",    topics_ + "/points",
        "--prefix",          topics_ + "/skycap",       "--settling", "0.2"};
    words.insert(words.end(), more.begin(), more.end());
    bridge_.emplace(words, folder_ / "bridge.log");
  }

  TestFolder folder_;
  const std::uint32_t domain_ = own_domain();
  const std::string topics_ = topics();
  std::optional<Program> server_, bridge_;
};

/// A PLY of floats.
std::string ply_of(const std::vector<Eigen::Vector3f>& points) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                     std::to_string(points.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  return text.append(reinterpret_cast<const char*>(points.data()),
                     points.size() * sizeof points[0]);
}

/// Through DDS, with nonsense between, comes what `skycap next` makes of the same scans and poses:
/// the journal has every scan's digest and pose and every view that was proposed.
TEST_F(LiveRobot, IsSurveyedAsByHandWithTheSameScans) {
  const std::string mission = short_mission(tests::flown_mission());
  serve(mission);
  start_bridge();
  Robot robot(mission, domain_, topics_);
  ASSERT_TRUE(robot.survey()) << bridge_->said() << server_->said();
  EXPECT_GE(robot.scans().size(), 3U);
  EXPECT_GE(robot.longest_path(), 2U);
  for (const SentScan& scan : robot.scans()) {
    const std::string file = folder_.write("scan.ply", ply_of(scan.points));
    const tests::ProgramRun run =
        tests::run_skycap({"next", folder_ / "m.yaml", "--survey", folder_ / "by_hand", "--scan",
                           file, "--pose", scan.pose, "--quiet", "--no-report"});
    EXPECT_THAT(run.exit_code, testing::AnyOf(0, 10, 11)) << run.err;
  }
  const std::string journal = content_of(folder_.path() / "by_hand" / "live.journal");
  EXPECT_GT(journal.size(), 1000U);
  EXPECT_TRUE(journal == content_of(folder_.path() / "served" / "live.journal"));
  robot.command("finish");
  EXPECT_EQ(bridge_->exit_code(), 0) << bridge_->said();
  EXPECT_TRUE(server_->exit_code());
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "served" / "views.csv"));
  EXPECT_THAT(bridge_->said(), HasSubstr("warning: odometry: there was another pose"));
  EXPECT_THAT(bridge_->said(), HasSubstr("warning: cloud: "));
}

/// The body never turns; the gimbal does, and measures on the way, too.
TEST_F(LiveRobot, TurnsItsCameraOnAGimbalThatTFTellsOf) {
  const std::string mission = short_mission(tests::quick_mission(), "see++");
  serve(mission);
  start_bridge({"--tf", topics_ + "/tf", "--tf-static", topics_ + "/tf_static"});
  Robot robot(mission, domain_, topics_, true);
  ASSERT_TRUE(robot.survey()) << bridge_->said() << server_->said();
  EXPECT_GE(robot.scans().size(), 3U);
  server_.reset();
  const geometry::RecordLog log(folder_.path() / "served" / "live.journal");
  const auto events = missions::live::events_of(log.records(), "the journal");
  ASSERT_EQ(events.size(), robot.scans().size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    const Eigen::Isometry3d wanted = parse_extrinsic(robot.scans()[i].pose, "");
    EXPECT_TRUE(events[i].scan->world_from_sensor.isApprox(wanted, 1e-9)) << i;
  }
}

TEST_F(LiveRobot, IsToldWhenItsBridgeIsStopped) {
  const std::string mission = short_mission(tests::quick_mission());
  serve(mission);
  for (const int signal : {SIGINT, SIGTERM}) {
    start_bridge();
    Robot robot(mission, domain_, topics_);
    ASSERT_TRUE(robot.wait_for_status("\"doing\":\"waiting for a scan\"")) << bridge_->said();
    bridge_->signal(signal);
    EXPECT_TRUE(robot.wait_for_status("stopped"));
    EXPECT_EQ(bridge_->exit_code(), 0) << bridge_->said();
    std::this_thread::sleep_for(1s);  // until the server has noticed
  }
}

TEST_F(LiveRobot, IsToldWhenTheSurveyIsLost) {
  const std::string mission = short_mission(tests::quick_mission());
  serve(mission);
  start_bridge();
  Robot robot(mission, domain_, topics_);
  ASSERT_TRUE(robot.wait_for_status("\"doing\":\"waiting for a scan\"")) << bridge_->said();
  server_.reset();
  EXPECT_TRUE(robot.wait_for_status("server is lost"));
  EXPECT_EQ(bridge_->exit_code(), 1);
  EXPECT_THAT(bridge_->said(), HasSubstr("error: the survey at unix:"));
}

TEST_F(LiveRobot, NeedsASurveyThatIsServedAndTopicsThatAreSome) {
  start_bridge();
  EXPECT_EQ(bridge_->exit_code(), 1);
  EXPECT_THAT(bridge_->said(), HasSubstr("nobody serves a survey there"));
  bridge_.emplace(std::vector<std::string>{SKYCAP_ROS2_PROGRAM, "unix:s", "--domain",
                                           std::to_string(domain_), "--cloud", "points"},
                  folder_ / "bridge.log");
  EXPECT_EQ(bridge_->exit_code(), 2);
  EXPECT_THAT(bridge_->said(), HasSubstr("the topic 'points' must begin with /"));
}

}  // namespace
}  // namespace skycap::ros2
