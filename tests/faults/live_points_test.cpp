// Live surveys are stored in their folders. Each disk operation of next, serve and finish fails
// once, and the program is killed once at each of them. Sending the same scan again brings the
// survey to the expected state.
#include <array>
#include <csignal>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "clients/skycap_live.h"
#include "geometry/io/cloud_io.h"
#include "tests/faults/fault_run.h"
#include "tests/support/temporary_folder.h"

namespace skycap::faults {
namespace {

namespace fs = std::filesystem;

/// A survey with one scan, and a second scan that is not yet part of it.
class LiveFaultPoints : public testing::Test {
 protected:
  LiveFaultPoints() { EXPECT_EQ(run(next("1", begun_), {}), 0); }

  std::vector<std::string> command(const std::string& name, const fs::path& folder,
                                   const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{
        name,    surveys_.mission(),     "--survey", folder, "--no-report",
        "--set", "live.pose_check=false"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  std::vector<std::string> next(const std::string& seed, const fs::path& folder) const {
    return command("next", folder,
                   {"--quiet", "--world", "--id", seed, "--scan", surveys_[seed] / "cloud.ply",
                    "--pose", "0 -30 12 -0.7071068 0 0 0.7071068"});
  }

  const Surveys surveys_;
  const testing_support::TemporaryFolder scratch_;
  const fs::path begun_ = scratch_.path() / "begun";
};

TEST_F(LiveFaultPoints, LetNextResumeWithFailedScan) {
  const auto take_next = [&](const fs::path& out, const Fault& fault) {
    return run(next("2", out), fault);
  };
  try_going_on({.old_folder = begun_, .change = take_next, .may_also_be = {}}, all);
}

TEST_F(LiveFaultPoints, LeaveFinishResultsComplete) {
  const auto finish = [&](const fs::path& out, const Fault& fault) {
    return run(command("finish", out), fault);
  };
  ASSERT_EQ(finish(begun_, {}), 0);
  ASSERT_EQ(run(next("2", begun_), {}), 0);
  try_faults({.old_folder = begun_, .change = finish, .may_also_be = is_survey_without_route},
             {"full", "kill"}, 15);
}

/// Returns the text written to `pipe` up to the end of the line or of the program.
std::string read_line(int pipe) {
  std::string line;
  for (char c = 0; ::read(pipe, &c, 1) == 1 && c != '\n';) line += c;
  return line;
}

constexpr skycap_live::Pose pose{1, 0, 0, 0, 0, 0, 1, -30, 0, -1, 0, 12};

/// Reads a cloud and converts it from the world frame to the sensor frame.
std::vector<float> read_points(const fs::path& cloud) {
  std::vector<float> numbers;
  geometry::read_positions(cloud, [&](std::span<const Eigen::Vector3f> chunk, double) {
    for (const Eigen::Vector3f& point : chunk) {
      numbers.insert(numbers.end(), {point.x(), 12.0F - point.z(), point.y() + 30.0F});
    }
  });
  return numbers;
}

/// A client sends a scan to the server and then finishes the survey.
TEST_F(LiveFaultPoints, LetServeResumeWithFailedScan) {
  const std::vector<float> points = read_points(surveys_["2"] / "cloud.ply");
  const auto serve = [&](const fs::path& out, const Fault& fault) {
    std::array<int, 2> pipe{};
    EXPECT_EQ(::pipe(pipe.data()), 0);
    const pid_t server = start(
        command("serve", out, {"--quiet", "--socket", scratch_.path() / "socket"}), fault, pipe[1]);
    ::close(pipe[1]);
    try {
      skycap_live::Survey client(read_line(pipe[0]));
      client.add_cloud(points, pose);
      client.finish();
    } catch (const std::exception&) {  // the server died or reported an error
      ::kill(server, SIGTERM);
    }
    ::close(pipe[0]);
    return wait_for_exit_code(server);
  };
  try_going_on({.old_folder = begun_, .change = serve, .may_also_be = {}}, 12);
}

}  // namespace
}  // namespace skycap::faults
