#include "missions/online/live/wire.h"

#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/support/complaint.h"

namespace skycap::missions::online {
namespace {

using testing::HasSubstr;

const Message sample{{{"type", "scan"}, {"number", 3}}, std::string("\0\x01payload\n", 10)};

std::string rejection(const std::string& bytes) {
  FrameReader reader;
  reader.feed(bytes);
  return testing_support::thrown_message([&] { reader.next(); });
}

TEST(Wire, DecodesMessagesFromAnyChunkSize) {
  const std::string two = encode_frame(sample) + encode_frame({{{"type", "next"}}, {}});
  for (std::size_t chunk = 1; chunk <= two.size(); ++chunk) {
    FrameReader reader;
    std::vector<Message> messages;
    for (std::size_t at = 0; at < two.size(); at += chunk) {
      reader.feed(std::string_view(two).substr(at, chunk));
      while (auto message = reader.next()) messages.push_back(std::move(*message));
    }
    ASSERT_EQ(messages.size(), 2U) << chunk;
    EXPECT_EQ(messages[0].header, sample.header);
    EXPECT_EQ(messages[0].payload, sample.payload);
    EXPECT_EQ(messages[1].header["type"], "next");
    EXPECT_FALSE(reader.is_within_message());
  }
}

/// Written by hand from docs/reference/live-protocol.md. The checksum is Python's
/// zlib.crc32(b'{"type":"next"}').
TEST(Wire, MatchesDocumentedFormat) {
  const std::string frame("\x0f\0\0\0\0\0\0\0\x1c\xab\x42\xde{\"type\":\"next\"}", 27);
  EXPECT_EQ(encode_frame({{{"type", "next"}}, {}}), frame);
}

TEST(Wire, WaitsForIncompleteMessages) {
  const std::string frame = encode_frame(sample);
  ASSERT_FALSE(frame.empty());
  for (std::size_t size = 0; size < frame.size(); ++size) {
    FrameReader reader;
    reader.feed(frame.substr(0, size));
    EXPECT_FALSE(reader.next()) << size;
    EXPECT_EQ(reader.is_within_message(), size > 0);
  }
}

TEST(Wire, RejectsInvalidMessages) {
  EXPECT_THAT(rejection(std::string(12, '\xff')), HasSubstr("too large"));
  const std::string large = "\xff\xff\xff\x7f", small(4, '\1');
  EXPECT_THAT(rejection(large + small + small), HasSubstr("too large"));  // the header
  EXPECT_THAT(rejection(small + large + small), HasSubstr("too large"));  // the payload
  std::string damaged = encode_frame(sample);
  damaged.back() ^= 1;
  EXPECT_THAT(rejection(damaged), HasSubstr("checksum"));
  EXPECT_THAT(rejection(encode_frame({"text", {}})), HasSubstr("not a JSON object"));
  EXPECT_THAT(rejection(encode_frame({nlohmann::ordered_json::array(), {}})),
              HasSubstr("JSON object"));
}

/// Random bytes are rejected or treated as incomplete. A frame with one changed bit is never
/// accepted.
TEST(Wire, RejectsCorruptedBytes) {
  std::mt19937_64 random(1);
  const std::string frame = encode_frame(sample);
  for (int i = 0; i < 20'000; ++i) {
    std::string bytes = frame;
    bytes[random() % bytes.size()] ^= static_cast<char>(1 << random() % 8);
    if (i % 2 == 1) bytes.resize(random() % bytes.size());
    FrameReader reader;
    reader.feed(bytes);
    try {
      EXPECT_FALSE(reader.next()) << i;
    } catch (const Error&) {
    }
  }
}

}  // namespace
}  // namespace skycap::missions::online
