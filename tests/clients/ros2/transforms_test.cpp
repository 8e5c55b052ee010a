// TF frames: chains, interpolation and invalid transforms.
#include "clients/ros2/transforms.h"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/angle.h"
#include "tests/clients/ros2/sample_messages.h"
#include "tests/support/complaint.h"

namespace skycap::ros2 {
namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using testing::HasSubstr;
using testing_support::thrown_message;
using Frame = SampleTransforms::Frame;
using State = PoseMatch::State;

Quaterniond about_z(double degrees) {
  return Quaterniond(AngleAxisd(degrees * geometry::radians_per_degree, Vector3d::UnitZ()));
}

class TransformTree : public testing::Test {
 protected:
  void add(double time, const Frame& frame, bool is_static = false) {
    const SampleTransforms sample(seconds(time), {frame});
    tree_.add(sample.transforms.front(), is_static);
  }
  std::string error_message(double time, const Frame& frame, bool is_static = false) {
    return thrown_message([&] { add(time, frame, is_static); });
  }
  PoseMatch at(const std::string& target, const std::string& source, double time) const {
    return tree_.at(target, source, seconds(time));
  }

  Transforms tree_{HistoryConfig{}};
};

/// A static mast, a rotating gimbal on the mast, and a camera on the gimbal.
TEST_F(TransformTree, ChainsStaticAndMovingTransforms) {
  add(0.0, {"base_link", "mast", {0, 0, 2}, about_z(0)}, true);
  add(10.0, {"mast", "gimbal", {0, 0, 0}, about_z(0)});
  add(10.1, {"mast", "gimbal", {0, 0, 0.2}, about_z(10)});
  add(0.0, {"gimbal", "camera", {1, 0, 0}, about_z(90)}, true);
  const PoseMatch half = at("base_link", "camera", 10.05);
  ASSERT_EQ(half.state, State::known) << half.reason;
  const double angle = 5.0 * geometry::radians_per_degree;
  EXPECT_LT((half.pose.position - Vector3d(std::cos(angle), std::sin(angle), 2.1)).norm(), 1e-12);
  EXPECT_LT(half.pose.turn.angularDistance(about_z(95)), 1e-12);
  const PoseMatch back = at("camera", "base_link", 10.05);
  ASSERT_EQ(back.state, State::known);
  EXPECT_LT((half.pose.turn * back.pose.position + half.pose.position).norm(), 1e-12);
  // a later transform may still arrive.
  EXPECT_EQ(at("base_link", "camera", 10.3).state, State::open);
  EXPECT_EQ(at("base_link", "mast", 99.0).state, State::known);  // static transforms do not expire
}

/// Neither frame needs to be an ancestor of the other: base_footprint is often below base_link.
TEST_F(TransformTree, ConnectsSiblingBranches) {
  add(0.0, {"base_link", "base_footprint", {0, 0, -0.5}}, true);
  add(0.0, {"base_link", "camera", {1, 0, 0}, about_z(90)}, true);
  const PoseMatch match = at("base_footprint", "camera", 1.0);
  ASSERT_EQ(match.state, State::known);
  EXPECT_EQ(match.pose.position, Vector3d(1, 0, 0.5));
  EXPECT_EQ(at("map", "camera", 1.0).state, State::open);
  EXPECT_THAT(at("map", "camera", 1.0).reason,
              HasSubstr("no transforms lead from 'map' to 'camera'"));
  EXPECT_EQ(at("nobody", "nobody", 1.0).state, State::known);
}

TEST_F(TransformTree, RejectsInterpolationAcrossJumps) {
  add(10.0, {"map", "odom", {0, 0, 0}});
  add(10.1, {"map", "odom", {50, 0, 0}});
  EXPECT_EQ(at("map", "odom", 10.05).state, State::rejected);
  EXPECT_EQ(at("map", "odom", 10.1).state, State::known);
}

TEST_F(TransformTree, ReturnsLastReceivedTransformAsNewest) {
  EXPECT_FALSE(tree_.newest("base_link", "gimbal"));
  add(10.0, {"base_link", "gimbal", {1, 0, 0}});
  add(9.0, {"base_link", "gimbal", {2, 0, 0}});
  EXPECT_EQ(tree_.newest("base_link", "gimbal")->target_from_source.translation(),
            Vector3d(2, 0, 0));
}

TEST_F(TransformTree, RejectsCyclesAndTooLongChains) {
  add(0.0, {"a", "b"}, true);
  add(0.0, {"b", "c"}, true);
  add(0.0, {"c", "a"}, true);
  EXPECT_EQ(at("map", "a", 1.0).state, State::rejected);
  EXPECT_THAT(at("map", "a", 1.0).reason, HasSubstr("form a loop"));
  EXPECT_THAT(error_message(0.0, {"d", "d"}, true), HasSubstr("is its own parent"));
  for (int i = 0; i < 65; ++i) {
    add(0.0, {"f" + std::to_string(i), "f" + std::to_string(i + 1)}, true);
  }
  EXPECT_EQ(at("f1", "f65", 1.0).state, State::rejected);
  EXPECT_EQ(at("f0", "f60", 1.0).state, State::known);
}

TEST_F(TransformTree, RejectsInvalidTransforms) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  add(10.0, {"base_link", "gimbal"});
  EXPECT_THAT(error_message(10.0, {"base_link", "gimbal", {1, 0, 0}}),
              HasSubstr("the same timestamp"));
  EXPECT_THAT(error_message(10.1, {"mast", "gimbal"}), HasSubstr("it must remain 'base_link'"));
  EXPECT_THAT(error_message(10.1, {"base_link", "gimbal"}, true),
              HasSubstr("must not be both static and moving"));
  EXPECT_THAT(error_message(10.1, {"", "x"}), HasSubstr("parent frame of a transform has no name"));
  EXPECT_THAT(error_message(10.1, {"x", ""}), HasSubstr("child frame of a transform has no name"));
  EXPECT_THAT(error_message(10.1, {"x", std::string(101, 'y')}),
              HasSubstr("longer than 100 bytes"));
  EXPECT_THAT(error_message(0.0, {"x", "y"}), HasSubstr("timestamp is not set"));
  EXPECT_THAT(error_message(10.1, {"x", "y", {none, 0, 0}}), HasSubstr("is not finite"));
  EXPECT_THAT(error_message(10.1, {"x", "y", {1e200, 0, 0}}), HasSubstr("more than 10,000 km"));
  EXPECT_THAT(error_message(10.1, {"x", "y", {0, 0, 0}, {0, 0, 0, 0}}), HasSubstr("quaternion"));
  EXPECT_EQ(at("x", "y", 10.1).state, State::open);  // none of them was stored
  const SampleTransforms nameless(seconds(1.0), {{"x", "y"}});
  TransformStamped transform = nameless.transforms.front();
  transform.child_frame_id = nullptr;
  EXPECT_THAT(thrown_message([&] { tree_.add(transform, false); }), HasSubstr("has no name"));
}

TEST_F(TransformTree, LimitsNumberOfFramesAndPoses) {
  for (std::size_t i = 0; i < Transforms::max_frames; ++i) {
    add(1.0, {"map", "f" + std::to_string(i)});
  }
  EXPECT_THAT(error_message(1.0, {"map", "one more"}), HasSubstr("more than 256 frames"));
  for (std::size_t i = 0; i <= Transforms::max_poses; ++i) {
    add(2.0 + 0.01 * static_cast<double>(i), {"map", "f0"});
  }
  EXPECT_EQ(at("map", "f0", 1.0).state, State::open);  // discarded
  EXPECT_EQ(at("map", "f0", 2.01).state, State::known);
}

}  // namespace
}  // namespace skycap::ros2
