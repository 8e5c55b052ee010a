#include "tests/flight/export/mavlink_link.h"

#include <stdexcept>

namespace skycap::flight::mavlink {
namespace {

constexpr std::uint8_t accepted = 0, invalid_sequence = 13;
constexpr Address gcs{255, 190};

/// Returns the frame in these bytes if it contains a known message.
std::optional<Frame> frame_in(const Bytes& bytes) {
  FrameReader reader(
      find_crc_extra<MissionRequestList, MissionCount, MissionAnswer, MissionRequest, WireItem>);
  reader.feed(bytes);
  return reader.next();
}

}  // namespace

Bytes Autopilot::ask_or_accept() {
  if (incoming_.size() < expected_) {
    MissionRequest request;
    request.sequence = static_cast<std::uint16_t>(incoming_.size());
    return send_message(request);
  }
  mission_ = incoming_;
  return send_message(MissionAnswer{});
}

Bytes Autopilot::take(const WireItem& item) {
  if (item.sequence != incoming_.size()) {
    MissionAnswer answer;
    answer.result = invalid_sequence;
    return send_message(answer);
  }
  incoming_.push_back(item);
  return ask_or_accept();
}

std::optional<Bytes> Autopilot::receive(const Bytes& bytes) {
  const std::optional<Frame> frame = frame_in(bytes);
  if (!frame) return {};
  if (const auto count = decode<MissionCount>(*frame)) {
    incoming_.clear();
    expected_ = count->count;
    return ask_or_accept();
  }
  if (const auto item = decode<WireItem>(*frame)) return take(*item);
  if (const auto request = decode<MissionRequest>(*frame)) {
    return send_message(mission_.at(request->sequence));
  }
  if (!decode<MissionRequestList>(*frame)) return {};
  MissionCount count;
  count.count = static_cast<std::uint16_t>(mission_.size());
  return send_message(count);
}

bool upload(Autopilot& autopilot, const std::vector<WireItem>& items, int corrupted) {
  std::uint8_t sequence = 0;
  int sent = 0;
  const auto send = [&](const auto& message) {
    Bytes bytes = encode(message, gcs, sequence++);
    if (sent++ == corrupted) {
      bytes[bytes.size() / 2] ^= 0x10;
      if (autopilot.receive(bytes)) throw std::logic_error("a damaged frame was understood");
      bytes[bytes.size() / 2] ^= 0x10;
    }
    return frame_in(autopilot.receive(bytes).value()).value();
  };
  MissionCount count;
  count.count = static_cast<std::uint16_t>(items.size());
  Frame answer = send(count);
  while (const auto request = decode<MissionRequest>(answer)) {
    answer = send(items.at(request->sequence));
  }
  const auto end = decode<MissionAnswer>(answer);
  return end && end->result == accepted;
}

std::vector<WireItem> download(Autopilot& autopilot) {
  const auto ask = [&](const auto& message) {
    return frame_in(autopilot.receive(encode(message, gcs, 0)).value()).value();
  };
  const std::size_t count = decode<MissionCount>(ask(MissionRequestList{})).value().count;
  std::vector<WireItem> items;
  for (std::size_t i = 0; i < count; ++i) {
    MissionRequest request;
    request.sequence = static_cast<std::uint16_t>(i);
    items.push_back(decode<WireItem>(ask(request)).value());
  }
  return items;
}

}  // namespace skycap::flight::mavlink
