/// Mission protocol of MAVLink 2 for the upload and download of a mission: five messages, the
/// autopilot side and the ground station side.
///
/// Source: common message set of MAVLink (numbers and fields of the messages).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "flight/mavlink/message.h"

namespace skycap::flight::mavlink {

struct MissionRequestList {
  static constexpr std::uint32_t id = 43;
  static constexpr const char* name = "MISSION_REQUEST_LIST";
  Address target{1, 1};

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit_target(visit, self.target);
  }
};

struct MissionCount {
  static constexpr std::uint32_t id = 44;
  static constexpr const char* name = "MISSION_COUNT";
  std::uint16_t count = 0;
  Address target{1, 1};

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("count", self.count);
    visit_target(visit, self.target);
  }
};

struct MissionAnswer {
  static constexpr std::uint32_t id = 47;
  static constexpr const char* name = "MISSION_ACK";
  Address target{1, 1};
  std::uint8_t result = 0;  ///< MAV_MISSION_RESULT; 0: accepted

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit_target(visit, self.target);
    visit("type", self.result);
  }
};

struct MissionRequest {
  static constexpr std::uint32_t id = 51;
  static constexpr const char* name = "MISSION_REQUEST_INT";
  std::uint16_t sequence = 0;
  Address target{1, 1};

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("seq", self.sequence);
    visit_target(visit, self.target);
  }
};

/// Mission item in wire format.
struct WireItem {
  static constexpr std::uint32_t id = 73;
  static constexpr const char* name = "MISSION_ITEM_INT";
  std::array<float, 4> params{};
  /// 1e-7 degrees in frames with positions, otherwise parameters 5 and 6.
  std::int32_t x = 0, y = 0;
  float z = 0.0F;
  std::uint16_t sequence = 0, command = 0;
  Address target{1, 1};
  std::uint8_t frame = 0, current = 0, autocontinue = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit_each(visit, {"param1", "param2", "param3", "param4"}, self.params);
    visit("x", self.x);
    visit("y", self.y);
    visit("z", self.z);
    visit("seq", self.sequence);
    visit("command", self.command);
    visit_target(visit, self.target);
    visit("frame", self.frame);
    visit("current", self.current);
    visit("autocontinue", self.autocontinue);
  }
};

/// Mission storage of an autopilot.
class Autopilot {
 public:
  /// Returns the answer to a frame; empty if the frame is not understood.
  std::optional<Bytes> receive(const Bytes& bytes);
  const std::vector<WireItem>& mission() const { return mission_; }

 private:
  template <class M>
  Bytes send_message(const M& message) {
    return encode(message, {1, 1}, sequence_++);
  }
  Bytes ask_or_accept();
  Bytes take(const WireItem& item);

  std::vector<WireItem> mission_, incoming_;
  std::size_t expected_ = 0;
  std::uint8_t sequence_ = 0;
};

/// Uploads a mission and returns true if it was accepted. The frame with the index `corrupted` is
/// damaged on the way to the autopilot and sent again.
bool upload(Autopilot& autopilot, const std::vector<WireItem>& items, int corrupted = -1);
std::vector<WireItem> download(Autopilot& autopilot);

}  // namespace skycap::flight::mavlink
