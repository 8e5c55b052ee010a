// Frames with all kinds of valid and invalid bytes.
#include "flight/mavlink/frame.h"

#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "flight/mavlink/guided_messages.h"
#include "tests/flight/export/mavlink_link.h"

namespace skycap::flight::mavlink {
namespace {

constexpr Address somebody{1, 1};

std::vector<Frame> frames_in(const Bytes& bytes) {
  FrameReader reader(guided_extra_byte);
  reader.feed(bytes);
  std::vector<Frame> frames;
  while (const auto frame = reader.next()) frames.push_back(*frame);
  return frames;
}

Bytes heartbeat(std::uint32_t mode, std::uint8_t sequence = 0) {
  Heartbeat message;
  message.custom_mode = mode;
  return encode(message, somebody, sequence);
}

void append(Bytes& bytes, const Bytes& more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

// The CRC_EXTRA bytes equal the published constants of the message set, which confirms the message
// definitions.
TEST(Mavlink, ComputesPublishedCrcExtraBytes) {
  EXPECT_EQ(extra_byte<Heartbeat>(), 50);
  EXPECT_EQ(extra_byte<SystemStatus>(), 124);
  EXPECT_EQ(extra_byte<Attitude>(), 39);
  EXPECT_EQ(extra_byte<GlobalPosition>(), 104);
  EXPECT_EQ(extra_byte<CommandLong>(), 152);
  EXPECT_EQ(extra_byte<CommandAnswer>(), 143);
  EXPECT_EQ(extra_byte<PositionTarget>(), 5);
  EXPECT_EQ(extra_byte<EstimatorStatus>(), 71);
  EXPECT_EQ(extra_byte<StatusText>(), 83);
  EXPECT_EQ(extra_byte<GimbalAttitude>(), 137);
  EXPECT_EQ(extra_byte<MissionRequestList>(), 132);
  EXPECT_EQ(extra_byte<MissionCount>(), 221);
  EXPECT_EQ(extra_byte<MissionAnswer>(), 153);
  EXPECT_EQ(extra_byte<MissionRequest>(), 196);
  EXPECT_EQ(extra_byte<WireItem>(), 38);
}

// Check value of CRC-16/MCRF4XX in the catalogue of CRC algorithms.
TEST(Mavlink, ComputesChecksumCheckValue) {
  const Bytes digits{'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(checksum(digits), 0x6F91);
}

TEST(Mavlink, TruncatesFramesAndDetectsEveryBitError) {
  const Bytes frame = encode(CommandAnswer{}, somebody, 7);  // zeros are truncated, except one byte
  EXPECT_EQ(frame.size(), 10U + 1U + 2U);
  ASSERT_EQ(frames_in(frame).size(), 1U);
  EXPECT_EQ(decode<CommandAnswer>(frames_in(frame).front())->result, 0);
  EXPECT_FALSE(decode<Heartbeat>(frames_in(frame).front()));
  for (std::size_t i = 0; i < frame.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes damaged = frame;
      damaged[i] = static_cast<std::uint8_t>(damaged[i] ^ (1 << bit));
      EXPECT_TRUE(frames_in(damaged).empty()) << "byte " << i << ", bit " << bit;
    }
  }
}

TEST(Mavlink, FindsFramesInByteStream) {
  Bytes bytes;
  for (std::uint8_t i = 0; i < 20; ++i) append(bytes, heartbeat(i, i));
  FrameReader reader(guided_extra_byte);
  std::uint32_t found = 0;
  for (const std::uint8_t byte : bytes) {
    reader.feed({&byte, 1});
    while (const auto frame = reader.next())
      EXPECT_EQ(decode<Heartbeat>(*frame)->custom_mode, found++);
  }
  EXPECT_EQ(found, 20U);
}

TEST(Mavlink, SkipsUnknownMessages) {
  Bytes bytes = wire_form({4711, somebody, 0, Bytes(200, 0xFD)}, 0);
  Bytes marked = heartbeat(1);
  marked[2] = 1;  // signed frame
  append(bytes, marked);
  append(bytes, heartbeat(3));
  const std::vector<Frame> frames = frames_in(bytes);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(decode<Heartbeat>(frames.front())->custom_mode, 3U);
}

// After random bytes, a frame is found once further bytes of at most the maximum frame size have
// followed it.
TEST(Mavlink, FindsFramesAfterRandomBytes) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 2000; ++i) {
    Bytes bytes(random() % 400);
    for (std::uint8_t& byte : bytes)
      byte = static_cast<std::uint8_t>(random() % 4 == 0 ? 0xFD : random());
    for (std::uint8_t n = 0; n < 20; ++n) append(bytes, heartbeat(1234567, n));
    const std::vector<Frame> frames = frames_in(bytes);
    ASSERT_FALSE(frames.empty());
    EXPECT_LE(frames.size(), 20U);
    EXPECT_EQ(decode<Heartbeat>(frames.back())->custom_mode, 1234567U);
    EXPECT_EQ(frames.back().sequence, 19);
  }
}

}  // namespace
}  // namespace skycap::flight::mavlink
