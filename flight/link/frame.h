/// The frames of MAVLink 2: bytes on a link, cut into messages.
///
/// Source: MAVLink's serialization guide (frame, checksum, truncation of zeros). What comes in is
/// hostile: a frame counts only if its checksum, which covers the definition of its message, is
/// right. Signed frames are not understood and passed over, as MAVLink asks of unknown features.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace skycap::flight::mavlink {

using Bytes = std::vector<std::uint8_t>;

/// The checksum of MAVLink: CRC-16/MCRF4XX, continued from `crc`.
std::uint16_t checksum(std::span<const std::uint8_t> data, std::uint16_t crc = 0xFFFF);

/// Who speaks: a vehicle or ground station, and which part of it.
struct Address {
  std::uint8_t system = 0, component = 0;

  bool operator==(const Address&) const = default;
};

struct Frame {
  std::uint32_t id = 0;  ///< of the message, below 2^24
  Address sender;
  std::uint8_t sequence = 0;  ///< counted by each sender
  Bytes payload;              ///< at most 255 bytes; zeros at its end may be missing
};

/// A frame as it is sent. `extra_byte` is that of its message (message.h).
Bytes wire_form(const Frame& frame, std::uint8_t extra_byte);

/// Finds frames in a stream of bytes that may hold anything.
class FrameReader {
 public:
  /// The extra byte of a message; nothing for one that is not known, which is passed over.
  using ExtraByteOf = std::function<std::optional<std::uint8_t>(std::uint32_t id)>;

  explicit FrameReader(ExtraByteOf extra_byte_of) : extra_byte_of_(std::move(extra_byte_of)) {}

  void feed(std::span<const std::uint8_t> bytes);

  /// The next frame that is whole and known; nothing until more is fed. What it waits for is never
  /// longer than one frame, 280 bytes.
  std::optional<Frame> next();

 private:
  void skip(std::size_t count);

  ExtraByteOf extra_byte_of_;
  Bytes bytes_;
  std::size_t begin_ = 0;  ///< of what was not looked at yet
};

}  // namespace skycap::flight::mavlink
