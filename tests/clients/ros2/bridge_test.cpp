// Selection of the scans that the bridge forwards to the survey, and of their poses, for valid and
// invalid messages of a robot.
#include "clients/ros2/bridge.h"

#include <functional>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/clients/ros2/bridged_robot.h"

namespace skycap::ros2 {
namespace {

using Eigen::Quaterniond;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

TEST_F(Ros2Bridge, PublishesViewAndPathInOdometryFrame) {
  begin();
  EXPECT_THAT(goals_, IsEmpty());
  odometry(9.0, {0, 0, 0});
  ASSERT_THAT(goals_, SizeIs(1));
  EXPECT_EQ(goals_[0].frame, "odom");
  EXPECT_EQ(goals_[0].stamp, seconds(9.0));
  EXPECT_EQ(goals_[0].view.value().translation(), Vector3d(5, 0, 0));
  EXPECT_THAT(goals_[0].path, ElementsAre(Vector3d(0, 0, 0), Vector3d(5, 0, 0)));
  EXPECT_THAT(status_, AllOf(HasSubstr(R"("id":3)"), HasSubstr(R"("state":"view")"),
                             HasSubstr(R"("hold":false)")));
}

TEST_F(Ros2Bridge, SendsScanWhenRobotIsSettledAtView) {
  begin();
  odometry(8.0, {0, 0, 0});
  odometry(8.05, {0, 0, 0});
  cloud(8.02);  // too far from the view
  proceed();
  arrive();
  cloud(9.2);  // at the view, but only for 0.2 s
  odometry(9.0 - 0.04, {3, 0, 0});
  proceed();
  EXPECT_THAT(scans_, IsEmpty());
  cloud(10.02);
  proceed();
  ASSERT_THAT(scans_, SizeIs(1));
  EXPECT_THAT(std::get<CloudScan>(scans_[0]).xyz, ElementsAre(1, 2, 3));
  EXPECT_THAT(poses_[0], ElementsAre(1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0));
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(Ros2Bridge, SendsEnRouteScansWhenMissionCapturesEnRoute) {
  const std::string begun = R"({"en_route": 0, "frame_period_s": 1.0, )";
  answer_ = begun + std::string(first_view).substr(1);
  begin();
  for (int step = 0; step <= 40; ++step) odometry(8.0 + 0.05 * step, {2.5 * 0.05 * step, 0, 0});
  for (const double time : {8.5, 9.02, 9.4, 9.6}) {  // within tolerance since 9.88 s
    cloud(time);
    proceed();
  }
  using skycap_live::From;
  EXPECT_THAT(origins_, ElementsAre(From::en_route, From::en_route));  // at least 1 s apart
  EXPECT_NEAR(poses_.back()[3], 2.5 * 1.6, 1e-9);
  EXPECT_THAT(goals_, SizeIs(1));  // the goal has not changed
  cloud(9.95);                     // at the view, but moving
  proceed();
  EXPECT_THAT(origins_, SizeIs(2));
  for (int step = 1; step <= 20; ++step) odometry(10.0 + 0.05 * step, {5, 0, 0});
  cloud(10.9);
  proceed();
  ASSERT_THAT(origins_, SizeIs(3));
  EXPECT_EQ(origins_.back(), From::view);
  EXPECT_THAT(goals_, SizeIs(2));
  EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(Ros2Bridge, ComputesPosesAndMountFromTransforms) {
  begin_with_transforms();
  cloud(8.0);  // provides the camera frame, without a pose at that time
  proceed(1.0);
  warnings_.clear();
  localised([](double) { return Vector3d(4, 0, -0.5); });
  cloud(10.02);
  proceed();
  ASSERT_THAT(scans_, SizeIs(1));
  EXPECT_THAT(poses_[0], ElementsAre(1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0));
  EXPECT_THAT(warnings_, IsEmpty());
  ASSERT_FALSE(goals_.empty());
  EXPECT_EQ(goals_.back().frame, "map");
  EXPECT_EQ(goals_.back().mount.value().world_from_optical({}).translation(), Vector3d(0, 0, 0.5));
}

TEST_F(Ros2Bridge, WaitsWhileTransformsStillMove) {
  begin_with_transforms();
  cloud(8.0);
  proceed(1.0);
  localised([](double time) { return Vector3d(time < 9.8 ? 2 + (time - 9.0) : 4, 0, -0.5); });
  cloud(10.02);  // at the view for 0.2 s
  proceed();
  EXPECT_THAT(scans_, IsEmpty());
  cloud(10.5);
  proceed();
  EXPECT_THAT(scans_, SizeIs(1));
}

/// The poses before and after the gap are at the view; the pose during the gap is unknown.
TEST_F(Ros2Bridge, WarnsAboutPoseGapsDuringSettling) {
  const std::vector<double> times = {9.0, 9.05, 9.1, 9.6, 9.65, 9.7, 9.75};
  begin();
  for (const double time : times) odometry(time, {5, 0, 0});
  cloud(9.72);
  proceed();
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("ignored: sensor position unknown")));
  begin_with_transforms();
  for (const double time : times) transforms(time, {{"map", "base_link", {5, 0, -0.5}}});
  cloud(9.72);
  proceed();
  EXPECT_THAT(warnings_.back(), HasSubstr("frame 'base_link': no pose within 0.1 s"));
  EXPECT_THAT(scans_, IsEmpty());
}

/// A moving arm must not refresh the timestamp of the body transform.
TEST_F(Ros2Bridge, StampsGoalsWithTimeOfBodyTransforms) {
  begin_with_transforms();
  cloud(8.0);
  transforms(9.0, {{"map", "base_link", {0, 0, 0}}});
  transforms(12.0, {{"base_link", "arm", {0, 0, 1}}, {"map", "another_robot", {0, 0, 1}}});
  command("refuse behind the fence");  // published again
  EXPECT_EQ(goals_.back().stamp, seconds(9.0));
  transforms(9.5, {{"map", "base_link", {0, 0, 0}}});
  command("refuse behind the fence");
  EXPECT_EQ(goals_.back().stamp, seconds(9.5));
}

TEST_F(Ros2Bridge, NamesMissingTransformFrame) {
  begin({.uses_transforms = true, .world = "map", .taking = Taking::every});
  cloud(10.0);
  proceed(1.0);
  EXPECT_THAT(scans_, IsEmpty());
  EXPECT_THAT(warnings_, testing::Contains(HasSubstr("map")));
}

TEST_F(Ros2Bridge, IgnoresScanWithOrientationOutsideTolerance) {
  begin();
  for (int step = 0; step <= 40; ++step) {
    const SampleOdometry sample(
        seconds(9.0 + 0.05 * step), {5, 0, 0},
        Quaterniond(Eigen::AngleAxisd(0.12, Vector3d::UnitX())));  // tolerance: 0.1
    bridge_->receive(sample.message, now_);
  }
  cloud(10.0);
  proceed();
  EXPECT_THAT(scans_, IsEmpty());
}

TEST_F(Ros2Bridge, HoldsScansForOdometryUntilTimeout) {
  begin({.taking = Taking::every});
  cloud(10.0);
  proceed(0.4);
  EXPECT_THAT(warnings_, IsEmpty());
  odometry(9.98, {1, 0, 0});
  odometry(10.02, {2, 0, 0});
  bridge_->receive(SampleOdometry(seconds(10.01), {1.75, 0, 0}).message, now_);
  proceed();
  ASSERT_THAT(poses_, SizeIs(1));
  EXPECT_NEAR(poses_[0][3], 1.0 + 0.75 * 2 / 3, 1e-9);
  cloud(11.0);
  proceed(0.6);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("its pose is unknown: no pose within 0.1 s")));
  EXPECT_THAT(poses_, SizeIs(1));
}

/// Lost, late, duplicate, future and malformed messages cause no scan with a wrong pose and no
/// crash, but one warning each.
TEST_F(Ros2Bridge, KeepsInvalidMessagesOutOfSurvey) {
  begin({.taking = Taking::every});
  const double none = std::numeric_limits<double>::quiet_NaN();
  odometry(9.95, {none, 0, 0});
  EXPECT_THAT(warnings_.back(), HasSubstr("odometry: its position"));
  now_ += 10.0;
  arrive();
  odometry(2e9, {700, 0, 0});  // from the future
  odometry(10.0, {9, 9, 9});   // a different pose with the timestamp 10.0
  EXPECT_THAT(warnings_.back(), HasSubstr("two different poses have the same timestamp"));
  now_ += 10.0;
  {
    SampleOdometry other(seconds(10.01), {8, 8, 8});
    other.frame = "map";
    other.message.header.frame_id = other.frame.data();
    bridge_->receive(other.message, now_);
    EXPECT_THAT(warnings_.back(), HasSubstr("its frame is 'map'; it must remain 'odom'"));
  }
  cloud(10.0);
  proceed();
  ASSERT_THAT(poses_, SizeIs(1));
  EXPECT_EQ(poses_[0][3], 5.0);
  for (const double time : {10.0, 9.0}) {  // duplicate and late
    now_ += 10.0;
    cloud(time);
    proceed();
    EXPECT_THAT(warnings_.back(), HasSubstr("must be later than that of the last accepted scan"));
  }
  now_ += 10.0;
  cloud(1.5e9);  // from the future
  proceed(1.0);
  EXPECT_THAT(warnings_.back(), HasSubstr("its pose is unknown"));
  now_ += 10.0;
  SampleCloud corrupted(seconds(10.5), {{1, 2, 3}});
  corrupted.message.row_step = 1;
  bridge_->receive(corrupted.message, now_);
  EXPECT_THAT(warnings_.back(), HasSubstr("cloud: its rows have 1 bytes"));
  SampleCloud stampless(0, {{1, 2, 3}});
  now_ += 10.0;
  bridge_->receive(stampless.message, now_);
  EXPECT_THAT(warnings_.back(), HasSubstr("its timestamp is not set"));
  EXPECT_THAT(poses_, SizeIs(1));
  cloud(10.5);  // valid again
  proceed();
  EXPECT_THAT(poses_, SizeIs(2));
}

TEST_F(Ros2Bridge, LimitsEachWarningToOncePerFiveSeconds) {
  begin();
  for (int i = 0; i < 100; ++i) {
    odometry(-1.0, {0, 0, 0});
    now_ += 0.06;
  }
  ASSERT_THAT(warnings_, SizeIs(2));
  EXPECT_THAT(warnings_[1], HasSubstr("more)"));
}

TEST_F(Ros2Bridge, HoldsAfterPoseWarningUntilTakeCommand) {
  begin();
  arrive();
  answer_ = std::string(first_view);
  answer_.insert(1, R"("warning": "pose", )");
  cloud(10.0);
  proceed();
  EXPECT_THAT(scans_, SizeIs(1));
  EXPECT_THAT(status_, HasSubstr(R"("hold":true)"));
  EXPECT_FALSE(goals_.back().view);
  EXPECT_THAT(goals_.back().path, IsEmpty());
  cloud(10.1);
  proceed();
  EXPECT_THAT(scans_, SizeIs(1));
  answer_ = first_view;
  command("take");
  cloud(10.2);
  proceed();
  EXPECT_THAT(scans_, SizeIs(2));
  EXPECT_THAT(status_, HasSubstr(R"("hold":false)"));
  EXPECT_TRUE(goals_.back().view);
}

TEST_F(Ros2Bridge, RetriesAfterSurveyRejectsScan) {
  begin({.taking = Taking::every});
  arrive();
  rejection_ = R"({"type":"error","what":"the scan has no pixels"})";
  cloud(10.0);
  proceed();
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("the scan has no pixels")));
  rejection_.clear();
  cloud(10.1);
  proceed(1.1);
  EXPECT_THAT(scans_, IsEmpty());
  cloud(10.2);
  proceed();
  EXPECT_THAT(scans_, SizeIs(1));
}

TEST_F(Ros2Bridge, SendsOdometryCovarianceWhenEnabled) {
  for (const bool is_used : {true, false}) {
    begin({.taking = Taking::every, .uses_covariance = is_used});
    SampleOdometry sample(seconds(10.0), {0, 0, 0});
    for (const int i : {0, 7, 14}) sample.message.pose.covariance[i] = 0.25;
    bridge_->receive(sample.message, now_);
    cloud(10.0);
    proceed();
    const auto* covariance = std::get_if<skycap_live::PoseCovariance>(&errors_.back());
    ASSERT_EQ(covariance != nullptr, is_used);
    if (is_used) {
      EXPECT_EQ((*covariance)[7], 0.25);
    }
  }
}

TEST_F(Ros2Bridge, SendsDepthImagesWithCameraIntrinsics) {
  begin({.taking = Taking::every});
  odometry(10.0, {0, 0, 0});
  const SampleImage image(seconds(10.0), 4, std::vector<std::uint16_t>(8, 2000), "16UC1");
  bridge_->receive(image.message, now_);
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("no CameraInfo")));
  bridge_->receive(SampleInfo().message, now_);
  bridge_->receive(image.message, now_);
  proceed();
  ASSERT_THAT(scans_, SizeIs(1));
  EXPECT_THAT(std::get<DepthScan>(scans_[0]).intrinsics, ElementsAre(2, 4, 1.5, 0.5));
}

TEST_F(Ros2Bridge, ObeysTextCommands) {
  begin({.taking = Taking::command});
  arrive();
  cloud(10.0);
  proceed();
  EXPECT_THAT(scans_, IsEmpty());
  command("refuse behind the \"fence\"\n");
  EXPECT_THAT(rejected_, ElementsAre(R"(3 behind the \"fence\"?)"));
  command("dance");
  EXPECT_THAT(warnings_, ElementsAre(HasSubstr("unknown command 'dance'")));
  command("finish");
  EXPECT_EQ(finished_, 1);
  EXPECT_TRUE(bridge_->is_finished());
}

TEST_F(Ros2Bridge, ThrowsWhenPeriodicRequestFindsServerClosed) {
  int asked = 0;
  Bridge lost({},
              {.next = [&]() -> std::string {
                 if (++asked > 1) throw std::runtime_error("connection closed by the server");
                 return first_view;
               },
               .finish = {},
               .add = {},
               .reject = {}},
              {.goal = [](const Goal&) {},
               .status = [](const std::string&) {},
               .warning = [](const std::string&) {}});
  lost.begin();
  EXPECT_THROW(lost.proceed(now_ + 3.0), std::runtime_error);
}

}  // namespace
}  // namespace skycap::ros2
