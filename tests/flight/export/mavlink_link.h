/// The mission protocol of MAVLink 2, as far as it takes to upload a mission and fetch it back: a
/// codec of its five messages, an autopilot's side and a ground station's side.
///
/// Sources: MAVLink's serialization guide (frame, checksum, order of fields, truncation) and its
/// common message set (numbers and fields of the messages).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace skycap::flight::mavlink {

using Bytes = std::vector<std::uint8_t>;

/// A mission item as the wire carries it.
struct WireItem {
  float params[4] = {};
  std::int32_t x = 0, y = 0;  ///< 1e-7 degrees in frames with places, else parameters 5 and 6
  float z = 0.0F;
  std::uint16_t sequence = 0, command = 0;
  std::uint8_t frame = 0, current = 0, autocontinue = 0;
};

enum class Kind : std::uint32_t {
  request_list = 43,
  count = 44,
  ack = 47,
  request_int = 51,
  item_int = 73,
};

struct Message {
  Kind kind = Kind::ack;
  std::uint16_t number = 0;  ///< count of items, or index of the one requested
  std::uint8_t result = 0;   ///< of an ack: MAV_MISSION_RESULT, 0 is accepted
  WireItem item;
};

/// The checksum of MAVLink: CRC-16/MCRF4XX, continued from `crc`.
std::uint16_t checksum(const std::uint8_t* data, std::size_t size, std::uint16_t crc = 0xFFFF);

/// The byte that goes into the checksum of a message besides its bytes, computed from the names and
/// types of its fields, so that ends with different definitions do not understand each other.
std::uint8_t extra_byte(Kind kind);

Bytes encode(const Message& message, std::uint8_t sequence);
/// Nothing if the frame is broken, of another version or of a message not known here.
std::optional<Message> decode(const Bytes& frame);

/// An autopilot's mission store.
class Autopilot {
 public:
  /// Its answer to a frame; nothing if it does not understand it.
  std::optional<Bytes> receive(const Bytes& frame);
  const std::vector<WireItem>& mission() const { return mission_; }

 private:
  Bytes ask_or_accept();

  std::vector<WireItem> mission_, incoming_;
  std::size_t expected_ = 0;
  std::uint8_t sequence_ = 0;
};

/// Uploads a mission; true if it was accepted. `spoiled` frames, counted from 0, are damaged on
/// their way to the autopilot and sent again.
bool upload(Autopilot& autopilot, const std::vector<WireItem>& items, int spoiled = -1);
std::vector<WireItem> download(Autopilot& autopilot);

}  // namespace skycap::flight::mavlink
