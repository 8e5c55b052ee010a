#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <future>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "clients/skycap_live.h"
#include "missions/online/live/live_status.h"
#include "missions/online/live/scan_input.h"
#include "missions/online/live/server.h"
#include "missions/online/live/session.h"
#include "tests/missions/online/live/rehearsal.h"
#include "tests/missions/run_skycap.h"
#include "tests/missions/simulated_mission.h"

namespace skycap::missions::online {
namespace {

using testing::HasSubstr;
using testing::Not;

skycap_live::Pose make_pose(const geometry::Scan& scan) {
  skycap_live::Pose pose{};
  for (int i = 0; i < 12; ++i) {
    pose[static_cast<std::size_t>(i)] = scan.world_from_sensor(i / 4, i % 4);
  }
  return pose;
}

std::vector<float> flatten_points(const geometry::Scan& scan) {
  const float* begin = scan.points.data()->data();
  return {begin, begin + 3 * scan.points.size()};
}

/// Returns a mission with a scanner that measures continuously, around a teapot of 20 m.
std::string scanner_mission() {
  return "scene: {model: builtin:teapot, longest_side: 20, ground: true}\n"
         "sensor: {lidar: velodyne_vlp16}\n"
         "planner: {density: 4, resolution_radius: 1.2, view_distance: 16,\n"
         "          scene_box: {min: [-14, -11, 0.3], max: [14, 11, 13]}}\n"
         "flight: {vehicle: generic, takeoff: [-75, 0, 0],\n"
         "         unknown_box: {min: [-14, -11, 0], max: [14, 11, 13]}}\n"
         "evaluation: {coverage_distance: 0.6, samples: 3000, visible_directions: 30,\n"
         "             attainable_views: 0}\n"
         "limits: {max_views: 6}\n";
}

/// Survey that is served from its own thread.
class Served {
 public:
  Served(
      const Rehearsal& rehearsal, ServerEndpoint endpoint,
      std::function<bool()> is_held = [] { return false; })
      : survey_(rehearsal.open(folder_.path() / "survey")),
        session_(
            rehearsal.setup().name, rehearsal.setup().flight(), rehearsal.setup().live, survey_,
            [this] {
              record_ = survey_.finish();
              return std::string("done");
            },
            [] {}, std::move(is_held)),
        server_(std::move(endpoint)),
        thread_([this](const std::stop_token& stop) {
          server_.run(
              session_, [this](const std::string& note) { notes_ += note + "\n"; }, stop);
        }) {}

  const std::string& address() const { return server_.address(); }

  /// Ends the server and returns the survey record.
  session::SurveyRecord record() {
    thread_.join();
    return std::move(record_).value();
  }
  std::string notes() {
    thread_.request_stop();
    thread_.join();
    return notes_;
  }

  LiveSurvey& survey() { return survey_; }

 private:
  tests::TestFolder folder_;
  LiveSurvey survey_;
  Session session_;
  Server server_;
  std::optional<session::SurveyRecord> record_;
  std::string notes_;
  std::jthread thread_;
};

/// Runs a survey with scans of the simulator through a socket.
session::SurveyRecord fed_by_simulator(const Rehearsal& rehearsal) {
  const tests::TestFolder folder;
  Served served(rehearsal, {.socket = folder / "socket", .port = {}});
  skycap_live::Survey client(served.address());
  Platform platform(rehearsal);
  while (client.next().find("\"state\":\"view\"") != std::string::npos) {
    // Between two messages no other thread uses the survey.
    LiveSurvey& survey = served.survey();
    if (!rehearsal.can_reach(survey)) {
      client.reject(survey.proposal().number, "walled in");
      continue;
    }
    const auto [scan, is_en_route] = platform.next(survey);
    const std::string answer =
        client.add_points(flatten_points(scan), make_pose(scan), scan.pixels, {},
                          is_en_route ? skycap_live::From::en_route : skycap_live::From::view);
    if (answer.find("\"warning\"") != std::string::npos) throw std::runtime_error(answer);
  }
  client.finish();
  return served.record();
}

TEST(Serve, MatchesPlanWithSimulatedScans) {
  for (const std::string& mission :
       {short_mission(tests::quick_mission(), "see++"), short_mission(tests::flight_mission()),
        moving_mission("live: {pose_check: false}\n"), scanner_mission()}) {
    const Rehearsal rehearsal(mission);
    expect_same(fed_by_simulator(rehearsal), rehearsal.planned());
  }
}

/// Runs the complete missions in SHIPPED_MISSIONS, such as "bunny city_block", or a quick one by
/// default. SHIPPED_VIEWS limits the number of views of missions without limits.
TEST(Serve, MatchesPlanForShippedMissions) {
  const std::filesystem::path missions = std::filesystem::path(SKYCAP_SOURCE_DIR) / "missions";
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets variables
  const char *given = std::getenv("SHIPPED_MISSIONS"), *views = std::getenv("SHIPPED_VIEWS");
  std::istringstream names(given == nullptr ? "teapot" : given);
  for (std::string name; names >> name;) {
    SCOPED_TRACE(name);
    std::string mission = tests::read_content(missions / (name + ".yaml"));
    if (views != nullptr) mission += std::string("limits: {max_views: ") + views + "}\n";
    const Rehearsal rehearsal(mission, missions, 0);
    const session::SurveyRecord planned = rehearsal.planned();
    const auto start = std::chrono::steady_clock::now();
    expect_same(fed_by_simulator(rehearsal), planned);
    const std::chrono::duration<double> length = std::chrono::steady_clock::now() - start;
    std::cout << name << ": " << planned.views.size() << " views, " << planned.cloud.size()
              << " points, " << length.count() << " s\n";
  }
}

TEST(Serve, ReleasesNoViewWhileHeld) {
  const Rehearsal rehearsal(tests::quick_mission());
  std::atomic<bool> is_held = false;
  std::atomic<int> asked = 0;  // how often the held server asks
  Served served(rehearsal, {.socket = {}, .port = 0}, [&] {
    if (is_held) ++asked;
    return is_held.load();
  });
  skycap_live::Survey client(served.address());
  is_held = true;
  std::future<std::string> answer = std::async(std::launch::async, [&] { return client.next(); });
  while (asked < 3) std::this_thread::yield();
  EXPECT_EQ(answer.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  EXPECT_THROW(skycap_live::Survey second(served.address()), std::runtime_error);  // still busy
  is_held = false;
  EXPECT_THAT(answer.get(), HasSubstr("\"state\":\"view\""));
  EXPECT_THAT(client.next(), HasSubstr("\"state\":\"view\""));
}

TEST(LiveStatus, WritesTheStateAndFollowsHoldRequests) {
  const Rehearsal rehearsal(tests::flight_mission());
  const tests::TestFolder folder;
  const LiveSurvey survey = rehearsal.open(folder.path() / "survey");
  const std::filesystem::path file = folder.path() / "survey" / status_name;
  {
    LiveStatus status(folder.path() / "survey", rehearsal.setup().flight());
    EXPECT_FALSE(status.is_held());
    status.set_survey(survey);
    status.set_vehicle({{1.0, 2.0, 3.0}, {0.0, 1.0, 0.0}}, 0.5);
    status.set_action("flying");
    folder.write("survey/live.hold", "");
    while (!status.is_held()) std::this_thread::yield();
    const auto text = [&] {  // the file is replaced atomically
      return std::filesystem::exists(file) ? tests::read_content(file) : std::string();
    };
    while (text().find("\"held\":true") == std::string::npos) std::this_thread::yield();
    EXPECT_THAT(text(), HasSubstr("\"action\":\"flying\""));
    EXPECT_THAT(text(), HasSubstr("\"position\":[1.0,2.0,3.0]"));
    EXPECT_THAT(text(), HasSubstr("\"battery\":0.5"));
    EXPECT_THAT(text(), HasSubstr("\"state\":\"view\""));
    std::filesystem::remove(folder.path() / "survey" / hold_name);
    while (status.is_held()) std::this_thread::yield();
  }
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(Serve, AnswersOneClientAtATime) {
  const Rehearsal rehearsal(tests::quick_mission());
  Served served(rehearsal, {.socket = {}, .port = 0});
  {
    skycap_live::Survey first(served.address());
    EXPECT_THROW(skycap_live::Survey second(served.address()), std::runtime_error);
    EXPECT_THAT(first.next(), HasSubstr("\"state\":\"view\""));
  }
  std::optional<std::string> answer;
  for (int attempt = 0; attempt < 100 && !answer; ++attempt) {
    try {  // wait until the server has noticed that the first client left
      answer = skycap_live::Survey(served.address()).next();
    } catch (const std::runtime_error&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  EXPECT_TRUE(answer);
  EXPECT_THAT(served.notes(), HasSubstr("a second client was rejected"));
}

class ServeSession : public testing::Test {
 protected:
  std::string ask(const nlohmann::ordered_json& header, const std::string& payload = {}) {
    return session_.answer({header, payload}).header.dump();
  }

  nlohmann::ordered_json scan_header(int number, const geometry::Scan& scan) const {
    return {{"type", "scan"},
            {"number", number},
            {"pose", make_pose(scan)},
            {"format", "points"},
            {"points", scan.points.size()}};
  }

  static std::string make_payload(const geometry::Scan& scan) {
    const std::vector<float> numbers = flatten_points(scan);
    return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float)};
  }

  tests::TestFolder folder_;
  Rehearsal rehearsal_{fine_mission()};
  LiveSurvey survey_ = rehearsal_.open(folder_.path());
  Session session_{rehearsal_.setup().name, rehearsal_.setup().flight(), rehearsal_.setup().live,
                   survey_, [] { return std::string(); }};
};

/// Each scan is accepted at its index among the frames of the leg, and the view only after them.
TEST(Serve, AcceptsEnRouteScansInOrderAndOnce) {
  const Rehearsal rehearsal(moving_mission());
  const tests::TestFolder folder;
  LiveSurvey survey = rehearsal.open(folder.path());
  Session session(rehearsal.setup().name, rehearsal.setup().flight(), rehearsal.setup().live,
                  survey, [] { return std::string(); });
  const auto ask = [&](const geometry::Scan& scan, int number, std::optional<int> en_route) {
    nlohmann::ordered_json header{{"type", "scan"},
                                  {"number", number},
                                  {"pose", make_pose(scan)},
                                  {"format", "points"},
                                  {"points", scan.points.size()},
                                  {"has_pixels", true}};
    if (en_route) header["en_route"] = *en_route;
    const std::vector<float> numbers = flatten_points(scan);
    std::string payload(reinterpret_cast<const char*>(numbers.data()),
                        numbers.size() * sizeof(float));
    payload.append(reinterpret_cast<const char*>(scan.pixels.data()),
                   scan.pixels.size() * sizeof scan.pixels[0]);
    return session.answer({header, payload}).header;
  };
  const geometry::Scan first = rehearsal.scan(survey);
  EXPECT_THAT(ask(first, 0, 0).dump(),
              HasSubstr("en-route scans require a scan from the first view"));
  nlohmann::ordered_json answer = ask(first, 0, {});
  ASSERT_GT(answer.at("frames").size(), 2U);
  EXPECT_EQ(answer.at("en_route"), 0);
  Platform platform(rehearsal);
  const geometry::Scan frame = platform.next(survey).scan;
  EXPECT_THAT(
      ask(frame, 1, 1).dump(),
      HasSubstr("scan 1 en-route frame 1 is out of order: the next one is 1, or en-route frame 0"));
  const std::size_t frames = answer.at("frames").size();
  answer = ask(frame, 1, 0);
  EXPECT_EQ(answer.at("is_new"), true);
  EXPECT_EQ(answer.at("en_route"), 1);
  EXPECT_EQ(answer.at("scans"), 1);
  EXPECT_EQ(answer.at("frames").size(), frames - 1);
  EXPECT_EQ(ask(frame, 1, 0).at("is_new"), false);
  EXPECT_THAT(ask(first, 1, 0).dump(), HasSubstr("scan 1 en-route frame 0 was a different scan"));
  // Frames may be skipped: the scan of the view may arrive at any time.
  answer = ask(rehearsal.scan(survey), 1, {});
  EXPECT_EQ(answer.at("scans"), 2);
  EXPECT_EQ(answer.at("en_route"), 0);
  EXPECT_EQ(ask(frame, 1, 0).at("is_new"), false);
}

TEST_F(ServeSession, RejectsScansOutOfOrderAndIgnoresRepeats) {
  const geometry::Scan scan = rehearsal_.scan(survey_);
  const std::string payload = make_payload(scan);
  EXPECT_THAT(ask(scan_header(1, scan), payload), HasSubstr("out of order: the next one is 0"));
  const std::string first = ask(scan_header(0, scan), payload);
  EXPECT_THAT(first, HasSubstr("\"is_new\":true"));
  EXPECT_THAT(ask(scan_header(0, scan), payload), HasSubstr("\"is_new\":false"));
  geometry::Scan other = scan;
  other.points[0].x() += 1.0F;
  EXPECT_THAT(ask(scan_header(0, other), make_payload(other)), HasSubstr("was a different scan"));
  EXPECT_EQ(survey_.views().size(), 1U);
}

/// As for files, each point is assigned to the pixel in which it is visible. The nearest point
/// wins.
TEST_F(ServeSession, AssignsPixelsToSensorFrameClouds) {
  const geometry::Scan scan = rehearsal_.scan(survey_);
  const Eigen::Isometry3d sensor_from_world = scan.world_from_sensor.inverse();
  std::vector<Eigen::Vector3f> positions;
  for (const Eigen::Vector3f& point : scan.points) {
    positions.push_back((sensor_from_world * point.cast<double>()).cast<float>());
  }
  const std::string payload(reinterpret_cast<const char*>(positions.data()),
                            positions.size() * sizeof positions[0]);
  std::vector<Eigen::Vector3d> points;
  points.reserve(positions.size());
  for (const Eigen::Vector3f& endpoint : positions) points.push_back(endpoint.cast<double>());
  nlohmann::ordered_json header = scan_header(0, scan);
  header["format"] = "cloud";
  EXPECT_THAT(ask(header, payload.substr(1)), HasSubstr("points require"));
  EXPECT_THAT(ask(header, payload), HasSubstr("\"is_new\":true"));
  const ScanFound same = make_scan(points, scan.world_from_sensor,
                                   rehearsal_.setup().flight().capture, rehearsal_.setup().live);
  EXPECT_FALSE(same.scan.pixels.empty());
  EXPECT_EQ(survey_.scan_number(scan_id(same.scan)), ScanNumber{0});
}

TEST_F(ServeSession, WarnsAboutWrongPoses) {
  const geometry::Scan first = rehearsal_.scan(survey_);
  ask(scan_header(0, first), make_payload(first));
  geometry::Scan scan = rehearsal_.scan(survey_);
  Eigen::Isometry3d jump = Eigen::Isometry3d::Identity();
  jump.translation() = 0.1 * scan.world_from_sensor.linear().col(0);
  const geometry::Scan wrong = corrected(scan, jump);
  const std::string answer = ask(scan_header(1, wrong), make_payload(wrong));
  EXPECT_THAT(answer, HasSubstr("\"warning\":\"pose\""));
  EXPECT_THAT(answer, HasSubstr("\"scans\":1"));
  EXPECT_THAT(ask(scan_header(1, wrong), make_payload(wrong)), HasSubstr("\"is_new\":false"));
  nlohmann::ordered_json header = scan_header(1, scan);
  header["pose_sigma"] = {0.01, "x"};
  EXPECT_THAT(ask(header, make_payload(scan)), HasSubstr("pose_sigma"));
  header["pose_sigma"] = {0.01, 0.1};
  header["pose_covariance"] = {1, 2, 3};
  EXPECT_THAT(ask(header, make_payload(scan)), HasSubstr("conflicts with"));
  header.erase("pose_sigma");
  EXPECT_THAT(ask(header, make_payload(scan)), HasSubstr("pose_covariance: has 3 numbers"));
  header["pose_covariance"] = PoseCovariance::of(0.01, 0.002).triangle();
  EXPECT_THAT(ask(header, make_payload(scan)), Not(HasSubstr("warning")));
  EXPECT_THAT(ask(scan_header(1, wrong), make_payload(wrong)), HasSubstr("\"is_new\":false"));
  EXPECT_EQ(survey_.views().size(), 2U);
}

/// A covariance that explains the pose jump prevents the warning. An invalid covariance is
/// rejected.
TEST(Serve, UsesPoseCovarianceOfClient) {
  const tests::TestFolder folder;
  const Rehearsal rehearsal(fine_mission());
  Served served(rehearsal, {.socket = folder / "socket", .port = {}});
  skycap_live::Survey client(served.address());
  const geometry::Scan first = rehearsal.scan(served.survey());
  client.add_points(flatten_points(first), make_pose(first));
  const geometry::Scan scan = rehearsal.scan(served.survey());
  Eigen::Isometry3d jump = Eigen::Isometry3d::Identity();
  jump.translation() = 0.1 * scan.world_from_sensor.linear().col(0);
  const geometry::Scan moved = corrected(scan, jump);
  const auto answer = [&](const skycap_live::PoseError& error) {
    return client.add_points(flatten_points(moved), make_pose(moved), {}, error);
  };
  skycap_live::PoseCovariance covariance{};
  EXPECT_THAT(answer(covariance), HasSubstr("\"warning\":\"pose\""));
  covariance[1] = 0.01;
  EXPECT_THROW(answer(covariance), skycap_live::Rejected);
  EXPECT_THAT(answer(skycap_live::PoseSigma{0.001, 0.01}), HasSubstr("\"warning\":\"pose\""));
  covariance[1] = 0.0;
  for (const std::size_t i : {0U, 7U, 14U}) covariance[i] = 0.01;
  EXPECT_THAT(answer(covariance), Not(HasSubstr("warning")));
}

TEST_F(ServeSession, CountsRepeatedRejectionOnce) {
  const geometry::Scan scan = rehearsal_.scan(survey_);
  ask(scan_header(0, scan), make_payload(scan));
  const std::string other = ask({{"type", "refuse"}, {"id", 1}});
  EXPECT_EQ(ask({{"type", "refuse"}, {"id", 1}}), other);
  EXPECT_THAT(ask({{"type", "refuse"}, {"id", 9}}), HasSubstr("unknown proposal 9"));
}

TEST_F(ServeSession, ReportsInvalidRequestsWithoutChanges) {
  const geometry::Scan scan = rehearsal_.scan(survey_);
  nlohmann::ordered_json header = scan_header(0, scan);
  EXPECT_THAT(ask(header, "short"), HasSubstr("the payload has 5 bytes"));
  header["points"] = -1;
  EXPECT_THAT(ask(header, make_payload(scan)), HasSubstr("error"));
  header["points"] = 4294967295U;
  EXPECT_THAT(ask(header, make_payload(scan)), HasSubstr("the payload has"));
  header = scan_header(0, scan);
  header["pose"] = {1, 2, 3};
  EXPECT_THAT(ask(header, make_payload(scan)), HasSubstr("pose"));
  header["pose"] = "here";
  EXPECT_THAT(ask(header, make_payload(scan)), HasSubstr("error"));
  header["format"] = "mp3";
  EXPECT_THAT(ask(header, make_payload(scan)), HasSubstr("expected points, cloud or depth"));
  EXPECT_THAT(ask({{"type", "dance"}}), HasSubstr("unknown type 'dance'"));
  EXPECT_THAT(ask({{"number", 1}}), HasSubstr("error"));
  EXPECT_THAT(ask({{"type", "finish"}}), HasSubstr("no scan has been accepted yet"));
  nlohmann::ordered_json depth{{"type", "scan"},    {"number", 0}, {"pose", make_pose(scan)},
                               {"format", "depth"}, {"width", 2},  {"height", 2},
                               {"unit", 0.001}};
  EXPECT_THAT(ask(depth, "12345"), HasSubstr("the image requires 8"));
  depth["width"] = 1 << 20;
  EXPECT_THAT(ask(depth, "12345678"), HasSubstr("from 1 to 32768"));
  EXPECT_TRUE(survey_.views().empty());
}

}  // namespace
}  // namespace skycap::missions::online
