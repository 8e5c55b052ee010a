// End-to-end test of skycap serve and skycap_ros2 with a simulated robot that uses only topics.

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>
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
#include "missions/online/live/live_journal.h"
#include "tests/clients/ros2/dds_domain.h"
#include "tests/clients/ros2/robot.h"
#include "tests/clients/ros2/sample_messages.h"
#include "tests/clients/ros2/spoiled_wire.h"
#include "tests/missions/online/live/rehearsal.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"

namespace skycap::ros2 {
namespace {

using missions::online::short_mission;
using testing::HasSubstr;
using tests::read_content;
using tests::TestFolder;
using namespace std::chrono_literals;

/// Child process whose output is redirected to a file.
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

  /// Returns the exit code, or the negative signal number. Empty if the process is still running
  /// after a minute.
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

  std::string log_text() const { return read_content(log_); }

 private:
  std::string log_;
  pid_t process_ = 0;
};

class Ros2LiveSurvey : public testing::Test {
 protected:
  /// Starts `serve` and waits up to 30 s for it.
  void serve(const std::string& mission) {
    folder_.write("m.yaml", mission);
    server_.emplace(
        std::vector<std::string>{SKYCAP_PROGRAM, "serve", folder_ / "m.yaml", "--survey",
                                 folder_ / "served", "--socket", folder_ / "s"},
        folder_ / "server.log");
    for (int i = 0; i < 300 && server_->log_text().find("unix:") == std::string::npos; ++i) {
      std::this_thread::sleep_for(100ms);
    }
  }
  void start_bridge(const std::vector<std::string>& more = {"--sensor-pose", "0 0 0 0 0 0 1"}) {
    std::vector<std::string> words{
        SKYCAP_ROS2_PROGRAM, "unix:" + (folder_ / "s"), "--domain",        std::to_string(domain_),
        "--odometry",        topics_ + "/odom",         "--cloud",         topics_ + "/points",
        "--prefix",          topics_ + "/skycap",       "--settling-time", "0.2"};
    words.insert(words.end(), more.begin(), more.end());
    bridge_.emplace(words, folder_ / "bridge.log");
  }

  TestFolder folder_;
  const std::uint32_t domain_ = own_domain();
  const std::string topics_ = topics();
  std::optional<Program> server_, bridge_;
};

/// Returns a binary PLY file with float coordinates.
std::string make_ply(const std::vector<Eigen::Vector3f>& points) {
  std::string text = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                     std::to_string(points.size()) +
                     "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  return text.append(reinterpret_cast<const char*>(points.data()),
                     points.size() * sizeof points[0]);
}

/// A survey through DDS with invalid messages in between equals `skycap next` with the same scans
/// and poses. The journal contains the digest and pose of each scan and each proposed view.
TEST_F(Ros2LiveSurvey, MatchesNextCommandWithSameScans) {
  const std::string mission = short_mission(tests::flight_mission());
  serve(mission);
  start_bridge();
  Robot robot(mission, domain_, topics_);
  ASSERT_TRUE(robot.survey()) << bridge_->log_text() << server_->log_text();
  EXPECT_GE(robot.scans().size(), 3U);
  EXPECT_GE(robot.longest_path(), 2U);
  for (const SentScan& scan : robot.scans()) {
    const std::string file = folder_.write("scan.ply", make_ply(scan.points));
    const tests::ProgramRun run =
        tests::run_skycap({"next", folder_ / "m.yaml", "--survey", folder_ / "by_hand", "--scan",
                           file, "--pose", scan.pose, "--quiet", "--no-report"});
    EXPECT_THAT(run.exit_code, testing::AnyOf(0, 10, 11)) << run.err;
  }
  const std::string journal = read_content(folder_.path() / "by_hand" / "live.journal");
  EXPECT_GT(journal.size(), 1000U);
  EXPECT_TRUE(journal == read_content(folder_.path() / "served" / "live.journal"));
  robot.command("finish");
  EXPECT_EQ(bridge_->exit_code(), 0) << bridge_->log_text();
  EXPECT_TRUE(server_->exit_code());
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "served" / "views.csv"));
  EXPECT_THAT(bridge_->log_text(), HasSubstr("warning: odometry: two different poses"));
  EXPECT_THAT(bridge_->log_text(), HasSubstr("warning: cloud: "));
}

/// The body never turns. The gimbal turns, and the camera also measures while it moves.
TEST_F(Ros2LiveSurvey, AimsGimbalCameraByTransforms) {
  const std::string mission = short_mission(tests::quick_mission(), "see++");
  serve(mission);
  start_bridge({"--tf", topics_ + "/tf", "--tf-static", topics_ + "/tf_static"});
  Robot robot(mission, domain_, topics_, true);
  ASSERT_TRUE(robot.survey()) << bridge_->log_text() << server_->log_text();
  EXPECT_GE(robot.scans().size(), 3U);
  server_.reset();
  const geometry::RecordLog log(folder_.path() / "served" / "live.journal");
  const auto events = missions::online::parse_events(log.records(), "the journal");
  ASSERT_EQ(events.size(), robot.scans().size());
  for (std::size_t i = 0; i < events.size(); ++i) {
    const Eigen::Isometry3d expected = parse_extrinsic(robot.scans()[i].pose, "");
    EXPECT_TRUE(events[i].scan->world_from_sensor.isApprox(expected, 1e-9)) << i;
  }
}

TEST_F(Ros2LiveSurvey, ReportsStoppedStatusOnSignal) {
  const std::string mission = short_mission(tests::quick_mission());
  serve(mission);
  for (const int signal : {SIGINT, SIGTERM}) {
    start_bridge();
    Robot robot(mission, domain_, topics_);
    ASSERT_TRUE(robot.wait_for_status("\"doing\":\"waiting for a scan\"")) << bridge_->log_text();
    bridge_->signal(signal);
    EXPECT_TRUE(robot.wait_for_status("stopped"));
    EXPECT_EQ(bridge_->exit_code(), 0) << bridge_->log_text();
    std::this_thread::sleep_for(1s);  // wait until the server has noticed
  }
}

TEST_F(Ros2LiveSurvey, ReportsLostServer) {
  const std::string mission = short_mission(tests::quick_mission());
  serve(mission);
  start_bridge();
  Robot robot(mission, domain_, topics_);
  ASSERT_TRUE(robot.wait_for_status("\"doing\":\"waiting for a scan\"")) << bridge_->log_text();
  server_.reset();
  EXPECT_TRUE(robot.wait_for_status("lost the connection"));
  EXPECT_EQ(bridge_->exit_code(), 1);
  EXPECT_THAT(bridge_->log_text(), HasSubstr("error: survey at unix:"));
}

TEST_F(Ros2LiveSurvey, RejectsMissingServerAndInvalidTopics) {
  start_bridge();
  EXPECT_EQ(bridge_->exit_code(), 1);
  EXPECT_THAT(bridge_->log_text(), HasSubstr("cannot connect to a server at this address"));
  bridge_.emplace(std::vector<std::string>{SKYCAP_ROS2_PROGRAM, "unix:s", "--domain",
                                           std::to_string(domain_), "--cloud", "points"},
                  folder_ / "bridge.log");
  EXPECT_EQ(bridge_->exit_code(), 2);
  EXPECT_THAT(bridge_->log_text(), HasSubstr("the topic 'points' must begin with '/'"));
}

/// Publishes all kinds of driver messages repeatedly.
void send_all_kinds(const Participant& participant, const std::string& topics, int rounds) {
  const Writer<Odometry> odometry(participant, topics + "/odom", Writing::sensor);
  const Writer<TFMessage> transforms(participant, topics + "/tf", Writing::sensor);
  const Writer<TFMessage> fixed(participant, topics + "/tf_static", Writing::latched);
  const Writer<PointCloud2> clouds(participant, topics + "/points", Writing::sensor);
  const Writer<Image> images(participant, topics + "/depth", Writing::sensor);
  const Writer<CameraInfo> infos(participant, topics + "/camera_info", Writing::sensor);
  const Writer<String> commands(participant, topics + "/skycap/command", Writing::command);
  std::this_thread::sleep_for(1s);  // wait until the readers are matched
  const CorruptedWire wire(7);
  std::string take = "take";
  std::vector<Eigen::Vector3f> points(40, {0.1F, 0.2F, 2.0F});
  for (int i = 0; i < rounds; ++i) {
    const Stamp now = seconds(1000.0 + 0.01 * i);
    const std::vector<SampleTransforms::Frame> frames = {{"odom", "base_link"},
                                                         {"base_link", "camera_optical"}};
    odometry.write(SampleOdometry(now, {0, -2, 0.5}).message);
    transforms.write(SampleTransforms(now, frames).message);
    fixed.write(SampleTransforms(now, {{"base_link", "mast"}}).message);
    clouds.write(SampleCloud(now, points).message);
    images.write(SampleImage(now, 4, std::vector<std::uint16_t>(8, 2000), "16UC1").message);
    infos.write(SampleInfo({0, 0, 0, 0, 0}).message);
    if (i % 50 == 0) commands.write({take.data()});
    std::this_thread::sleep_for(2ms);
  }
}

/// Valid RTPS packets with corrupted data. SPOILED_ROUNDS sets the number of messages for each
/// topic. ROS2_UNDER sets a command that runs the bridge, such as valgrind with its options.
TEST_F(Ros2LiveSurvey, SurvivesCorruptedMessages) {
  const char* rounds = std::getenv("SPOILED_ROUNDS");
  serve(short_mission(tests::quick_mission()));
  for (const bool has_images : {false, true}) {
    std::vector<std::string> words;
    std::istringstream under(std::getenv("ROS2_UNDER") ? std::getenv("ROS2_UNDER") : "");
    for (std::string word; under >> word;) words.push_back(word);
    words.insert(
        words.end(),
        {SKYCAP_ROS2_PROGRAM, "unix:" + (folder_ / "s"), "--domain", std::to_string(domain_),
         "--odometry", topics_ + "/odom", "--tf", topics_ + "/tf", "--tf-static",
         topics_ + "/tf_static", "--prefix", topics_ + "/skycap", "--trigger", "always",
         has_images ? "--image" : "--cloud", topics_ + (has_images ? "/depth" : "/points")});
    bridge_.emplace(words, folder_ / "bridge.log");
    const Participant participant(domain_);
    Reader<String> statuses(participant, topics_ + "/skycap/status", ReaderQos::latched, 1);
    std::string status;
    const auto listen = [&] { statuses.take([&](const String& m) { status = m.data; }); };
    for (int i = 0; i < 300 && status.empty(); ++i, listen()) std::this_thread::sleep_for(100ms);
    ASSERT_THAT(status, HasSubstr("waiting for odometry")) << bridge_->log_text();
    const std::size_t before = CorruptedWire::count();
    send_all_kinds(participant, topics_, rounds == nullptr ? 200 : std::stoi(rounds));
    std::cout << CorruptedWire::count() - before << " pieces of data were spoiled\n";
    std::this_thread::sleep_for(1s);
    bridge_->signal(SIGTERM);
    EXPECT_EQ(bridge_->exit_code(), 0) << bridge_->log_text();
    EXPECT_THAT(bridge_->log_text(), HasSubstr("warning: "));
    listen();
    EXPECT_THAT(status, HasSubstr("stopped"));
    std::this_thread::sleep_for(1s);  // wait until the server has noticed
  }
}

TEST_F(Ros2LiveSurvey, RejectsOptionsWithoutEffect) {
  const std::vector<std::vector<std::string>> idle = {
      {"--base-frame", "base"},
      {"--rectified"},
      {"--camera-info", "/info"},
      {"--odometry", "/odom", "--fixed-frame", "map"},
      {"--ignore-covariance", "--fixed-frame", "map"},
      {"--cloud", "/points", "--image", "/depth"},
      {"--tf", "/tf", "--sensor-pose", "0 0 0 0 0 0 1"},
      {"--settling-time", "1", "--trigger", "always"}};
  for (const std::vector<std::string>& options : idle) {
    std::vector<std::string> words{SKYCAP_ROS2_PROGRAM, "unix:s"};
    words.insert(words.end(), options.begin(), options.end());
    bridge_.emplace(words, folder_ / "bridge.log");
    EXPECT_EQ(bridge_->exit_code(), 2);
    EXPECT_THAT(bridge_->log_text(),
                HasSubstr("error: " + options.front() + " has no effect with"));
  }
}

}  // namespace
}  // namespace skycap::ros2
