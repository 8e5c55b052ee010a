// Mission files are unchanged after upload to an autopilot and download.
#include <cmath>

#include <gtest/gtest.h>

#include "flight/export/mavlink_files.h"
#include "tests/flight/export/mavlink_link.h"
#include "tests/flight/export/sample_plan.h"

namespace skycap::flight {
namespace {

using mavlink::WireItem;

bool has_position(const MissionItem& item) { return item.frame != frame::mission; }

std::vector<WireItem> on_the_wire(const std::vector<MissionItem>& items) {
  std::vector<WireItem> wire;
  for (const MissionItem& item : items) {
    WireItem to;
    for (std::size_t i = 0; i < 4; ++i) to.params[i] = static_cast<float>(item.params[i]);
    const double scale = has_position(item) ? 1e7 : 1.0;
    to.x = static_cast<std::int32_t>(std::lround(item.params[4] * scale));
    to.y = static_cast<std::int32_t>(std::lround(item.params[5] * scale));
    to.z = static_cast<float>(item.params[6]);
    to.sequence = static_cast<std::uint16_t>(wire.size());
    to.command = static_cast<std::uint16_t>(item.command);
    to.frame = static_cast<std::uint8_t>(item.frame);
    to.current = wire.empty() ? 1 : 0;
    to.autocontinue = item.auto_continue ? 1 : 0;
    wire.push_back(to);
  }
  return wire;
}

void expect_same(const std::vector<MissionItem>& sent, const std::vector<WireItem>& back) {
  ASSERT_EQ(back.size(), sent.size());
  for (std::size_t i = 0; i < sent.size(); ++i) {
    EXPECT_EQ(back[i].sequence, i);
    EXPECT_EQ(back[i].command, sent[i].command);
    EXPECT_EQ(back[i].frame, sent[i].frame);
    EXPECT_EQ(back[i].autocontinue, 1);
    for (std::size_t p = 0; p < 4; ++p) {
      const auto expected = static_cast<float>(sent[i].params[p]);
      EXPECT_TRUE(back[i].params[p] == expected ||
                  (std::isnan(back[i].params[p]) && std::isnan(expected)))
          << "item " << i << ", parameter " << p + 1;
    }
    EXPECT_EQ(back[i].z, static_cast<float>(sent[i].params[6]));
    if (!has_position(sent[i])) continue;
    // Resolution of the protocol: 1e-7 degrees (11 mm).
    EXPECT_NEAR(1e-7 * back[i].x, sent[i].params[4], 1e-7);
    EXPECT_NEAR(1e-7 * back[i].y, sent[i].params[5], 1e-7);
  }
}

TEST(MavlinkUpload, RoundTripsPlan) {
  const auto items = read_plan(write_plan(sample_plan(vehicle_profile("generic")))).items;
  mavlink::Autopilot autopilot;
  ASSERT_TRUE(mavlink::upload(autopilot, on_the_wire(items)));
  expect_same(items, mavlink::download(autopilot));
}

TEST(MavlinkUpload, RoundTripsWaypointsFilesOfBothAutopilots) {
  for (const char* vehicle : {"generic", "generic_ardupilot"}) {
    const auto items = read_waypoints(write_waypoints(sample_plan(vehicle_profile(vehicle)))).items;
    mavlink::Autopilot autopilot;
    ASSERT_TRUE(mavlink::upload(autopilot, on_the_wire(items)));
    expect_same(items, mavlink::download(autopilot));
  }
}

TEST(MavlinkUpload, ResendsDamagedFrameAndRejectsPartialMission) {
  const auto items = read_plan(write_plan(sample_plan(vehicle_profile("generic")))).items;
  const std::vector<WireItem> wire = on_the_wire(items);
  mavlink::Autopilot autopilot;
  ASSERT_TRUE(mavlink::upload(autopilot, wire, 5));
  expect_same(items, mavlink::download(autopilot));

  std::vector<WireItem> shuffled = wire;
  std::swap(shuffled[2].sequence, shuffled[3].sequence);
  EXPECT_FALSE(mavlink::upload(autopilot, shuffled));
  expect_same(items, autopilot.mission());  // the previous mission is still stored
}

}  // namespace
}  // namespace skycap::flight
