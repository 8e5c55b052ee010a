#include "flight/mavlink/vehicle_state.h"

#include <limits>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace skycap::flight::mavlink {
namespace {

constexpr Address vehicle{1, 1}, gimbal{1, 154}, other{2, 1};

template <class M>
Frame make_frame(const M& message, std::uint8_t sequence, Address sender = vehicle) {
  FrameReader reader(guided_extra_byte);
  reader.feed(encode(message, sender, sequence));
  return reader.next().value();
}

Heartbeat heartbeat(std::uint32_t mode) {
  Heartbeat message;
  message.autopilot = 3;
  message.custom_mode = mode;
  return message;
}

class HeardVehicle : public testing::Test {
 protected:
  HeardVehicle() { state_.hear(make_frame(heartbeat(4), 100), 1.0); }

  VehicleState state_;
};

TEST(VehicleState, IgnoresFramesBeforeAutopilotHeartbeat) {
  VehicleState state;
  state.hear(make_frame(GlobalPosition{}, 0), 1.0);
  Heartbeat gcs;
  gcs.autopilot = 8;
  state.hear(make_frame(gcs, 1, other), 1.0);
  EXPECT_FALSE(state.autopilot());
  EXPECT_FALSE(state.last_heard());
  state.hear(make_frame(heartbeat(4), 2), 2.0);
  EXPECT_EQ(state.autopilot(), vehicle);
  EXPECT_EQ(state.heartbeat()->mode, 4U);
}

TEST_F(HeardVehicle, IgnoresOtherVehicles) {
  state_.hear(make_frame(heartbeat(5), 101, other), 2.0);
  EXPECT_EQ(state_.heartbeat()->mode, 4U);
  EXPECT_EQ(state_.last_heard(), 1.0);
}

// Duplicate or late frames must not restore the previous mode.
TEST_F(HeardVehicle, IgnoresRepeatedAndLateFrames) {
  state_.hear(make_frame(heartbeat(9), 102), 2.0);
  state_.hear(make_frame(heartbeat(4), 101), 3.0);
  state_.hear(make_frame(heartbeat(4), 102), 3.0);
  EXPECT_EQ(state_.heartbeat()->mode, 9U);
  EXPECT_EQ(state_.heartbeat()->time, 2.0);
}

TEST_F(HeardVehicle, AcceptsFramesAfterSequenceOverflow) {
  for (int i = 101; i < 700; i += 50) {
    state_.hear(make_frame(heartbeat(static_cast<std::uint32_t>(i)), static_cast<std::uint8_t>(i)),
                i);
    EXPECT_EQ(state_.heartbeat()->mode, static_cast<std::uint32_t>(i));
  }
}

TEST_F(HeardVehicle, IgnoresInvalidValues) {
  GlobalPosition beyond;
  beyond.latitude = 900'000'001;
  state_.hear(make_frame(beyond, 101), 2.0);
  EXPECT_FALSE(state_.position());
  Attitude attitude;
  attitude.yaw = std::numeric_limits<float>::quiet_NaN();
  state_.hear(make_frame(attitude, 102), 2.0);
  EXPECT_FALSE(state_.yaw());
  SystemStatus status;
  status.battery_remaining = 101;
  state_.hear(make_frame(status, 103), 2.0);
  EXPECT_FALSE(state_.battery());
  GimbalAttitude broken;
  broken.turn = {std::numeric_limits<float>::infinity(), 0.0F, 0.0F, 0.0F};
  state_.hear(make_frame(broken, 0, gimbal), 2.0);
  EXPECT_FALSE(state_.gimbal_pitch());
  StatusText text;
  text.text.fill('\033');
  state_.hear(make_frame(text, 104), 2.0);
  EXPECT_EQ(state_.warning(), std::string(50, '?'));
}

TEST_F(HeardVehicle, KeepsTimeOfRepeatedPosition) {
  GlobalPosition position;
  position.time_boot_ms = 7;
  position.latitude = 470'000'000;
  position.height_above_home = 1500;
  position.north_speed = 100;
  position.down_speed = -50;
  state_.hear(make_frame(position, 101), 2.0);
  EXPECT_DOUBLE_EQ(state_.position()->latitude_deg, 47.0);
  EXPECT_DOUBLE_EQ(state_.position()->height_above_home, 1.5);
  EXPECT_EQ(state_.position()->velocity, Eigen::Vector3d(0.0, 1.0, 0.5));
  state_.hear(make_frame(position, 102), 3.0);
  EXPECT_EQ(state_.position()->time, 2.0);
}

TEST_F(HeardVehicle, ComputesGimbalPitch) {
  GimbalAttitude message;
  constexpr float half = 0.25F;  // pitch -0.5 rad, yaw 2 rad
  const Eigen::Quaternionf turn = Eigen::AngleAxisf(2.0F, Eigen::Vector3f::UnitZ()) *
                                  Eigen::AngleAxisf(-2.0F * half, Eigen::Vector3f::UnitY());
  message.turn = {turn.w(), turn.x(), turn.y(), turn.z()};
  state_.hear(make_frame(message, 0, gimbal), 2.0);
  EXPECT_NEAR(state_.gimbal_pitch().value(), -0.5, 1e-6);
}

}  // namespace
}  // namespace skycap::flight::mavlink
