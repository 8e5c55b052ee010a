#include "tests/flight/export/mavlink_link.h"

#include <algorithm>
#include <cstring>
#include <iterator>
#include <span>
#include <stdexcept>

namespace skycap::flight::mavlink {
namespace {

constexpr std::uint8_t start_of_frame = 0xFD;
constexpr std::size_t header_size = 10;
constexpr std::uint8_t accepted = 0, invalid_sequence = 13;

/// A message's fields on the wire: the largest types first, as they come otherwise. Extensions
/// follow, without a say in the extra byte.
struct Layout {
  const char* name;
  struct Field {
    const char *type, *name;
  };
  std::vector<Field> fields;
};

const Layout& layout(Kind kind) {
  static const Layout list{"MISSION_REQUEST_LIST",
                           {{"uint8_t", "target_system"}, {"uint8_t", "target_component"}}};
  static const Layout count{
      "MISSION_COUNT",
      {{"uint16_t", "count"}, {"uint8_t", "target_system"}, {"uint8_t", "target_component"}}};
  static const Layout ack{
      "MISSION_ACK",
      {{"uint8_t", "target_system"}, {"uint8_t", "target_component"}, {"uint8_t", "type"}}};
  static const Layout request{
      "MISSION_REQUEST_INT",
      {{"uint16_t", "seq"}, {"uint8_t", "target_system"}, {"uint8_t", "target_component"}}};
  static const Layout item{"MISSION_ITEM_INT",
                           {{"float", "param1"},
                            {"float", "param2"},
                            {"float", "param3"},
                            {"float", "param4"},
                            {"int32_t", "x"},
                            {"int32_t", "y"},
                            {"float", "z"},
                            {"uint16_t", "seq"},
                            {"uint16_t", "command"},
                            {"uint8_t", "target_system"},
                            {"uint8_t", "target_component"},
                            {"uint8_t", "frame"},
                            {"uint8_t", "current"},
                            {"uint8_t", "autocontinue"}}};
  switch (kind) {
    case Kind::request_list:
      return list;
    case Kind::count:
      return count;
    case Kind::ack:
      return ack;
    case Kind::request_int:
      return request;
    case Kind::item_int:
      return item;
  }
  throw std::logic_error("no such message");
}

bool is_known(std::uint32_t id) { return id == 43 || id == 44 || id == 47 || id == 51 || id == 73; }

template <class T>
void put(Bytes& bytes, T value) {
  std::uint8_t raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));  // the tests' machines are little-endian, as is MAVLink
  bytes.insert(bytes.end(), raw, raw + sizeof(T));
}

/// Reads a payload whose zeros at the end were left out.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> payload) : payload_(payload) {}

  template <class T>
  T take() {
    std::uint8_t raw[sizeof(T)] = {};
    for (std::size_t i = 0; i < sizeof(T); ++i, ++place_) {
      if (place_ < payload_.size()) raw[i] = payload_[place_];
    }
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }

 private:
  std::span<const std::uint8_t> payload_;
  std::size_t place_ = 0;
};

Bytes payload_of(const Message& message) {
  Bytes payload;
  const WireItem& item = message.item;
  if (message.kind == Kind::item_int) {
    for (const float param : item.params) put(payload, param);
    put(payload, item.x), put(payload, item.y), put(payload, item.z);
    put(payload, item.sequence), put(payload, item.command);
  } else if (message.kind == Kind::count || message.kind == Kind::request_int) {
    put(payload, message.number);
  }
  payload.push_back(1), payload.push_back(1);  // target system and component
  if (message.kind == Kind::ack) payload.push_back(message.result);
  if (message.kind == Kind::item_int) {
    payload.insert(payload.end(), {item.frame, item.current, item.autocontinue});
  }
  payload.push_back(0);  // extension mission_type: flight plan
  while (payload.size() > 1 && payload.back() == 0) payload.pop_back();
  return payload;
}

std::uint16_t frame_checksum(const Bytes& frame, std::size_t payload_size, Kind kind) {
  const std::uint8_t extra = extra_byte(kind);
  return checksum(&extra, 1, checksum(frame.data() + 1, header_size - 1 + payload_size));
}

}  // namespace

std::uint16_t checksum(const std::uint8_t* data, std::size_t size, std::uint16_t crc) {
  for (std::size_t i = 0; i < size; ++i) {
    crc = static_cast<std::uint16_t>(crc ^ data[i]);
    for (int bit = 0; bit < 8; ++bit) {
      crc = static_cast<std::uint16_t>((crc & 1) != 0 ? (crc >> 1) ^ 0x8408 : crc >> 1);
    }
  }
  return crc;
}

std::uint8_t extra_byte(Kind kind) {
  const Layout& message = layout(kind);
  std::string text = std::string(message.name) + " ";
  for (const Layout::Field& field : message.fields) {
    text += std::string(field.type) + " " + field.name + " ";
  }
  const std::uint16_t crc =
      checksum(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  return static_cast<std::uint8_t>((crc & 0xFF) ^ (crc >> 8));
}

Bytes encode(const Message& message, std::uint8_t sequence) {
  const Bytes payload = payload_of(message);
  const auto id = static_cast<std::uint32_t>(message.kind);
  Bytes frame;
  frame.reserve(header_size + payload.size() + 2);
  frame.push_back(start_of_frame);
  frame.push_back(static_cast<std::uint8_t>(payload.size()));
  frame.push_back(0), frame.push_back(0);  // no incompatible, no compatible features
  frame.push_back(sequence);
  frame.push_back(255), frame.push_back(190);  // the sender: a ground station
  for (const int shift : {0, 8, 16}) frame.push_back(static_cast<std::uint8_t>(id >> shift));
  std::copy(payload.begin(), payload.end(), std::back_inserter(frame));
  put(frame, frame_checksum(frame, payload.size(), message.kind));
  return frame;
}

std::optional<Message> decode(const Bytes& frame) {
  if (frame.size() < header_size + 3 || frame[0] != start_of_frame || frame[2] != 0) return {};
  const std::size_t payload_size = frame[1];
  if (frame.size() != header_size + payload_size + 2) return {};
  const std::uint32_t id = frame[7] + 256U * frame[8] + 65536U * frame[9];
  if (!is_known(id)) return {};
  Message message;
  message.kind = static_cast<Kind>(id);
  const std::uint16_t crc = frame_checksum(frame, payload_size, message.kind);
  if (frame[frame.size() - 2] != (crc & 0xFF) || frame[frame.size() - 1] != crc >> 8) return {};

  Reader reader({frame.data() + header_size, payload_size});
  WireItem& item = message.item;
  if (message.kind == Kind::item_int) {
    for (float& param : item.params) param = reader.take<float>();
    item.x = reader.take<std::int32_t>(), item.y = reader.take<std::int32_t>();
    item.z = reader.take<float>();
    item.sequence = reader.take<std::uint16_t>(), item.command = reader.take<std::uint16_t>();
  } else if (message.kind == Kind::count || message.kind == Kind::request_int) {
    message.number = reader.take<std::uint16_t>();
  }
  reader.take<std::uint8_t>(), reader.take<std::uint8_t>();
  if (message.kind == Kind::ack) message.result = reader.take<std::uint8_t>();
  if (message.kind == Kind::item_int) {
    item.frame = reader.take<std::uint8_t>();
    item.current = reader.take<std::uint8_t>();
    item.autocontinue = reader.take<std::uint8_t>();
  }
  return message;
}

Bytes Autopilot::ask_or_accept() {
  Message answer;
  if (incoming_.size() < expected_) {
    answer.kind = Kind::request_int;
    answer.number = static_cast<std::uint16_t>(incoming_.size());
  } else {
    mission_ = incoming_;
    answer.kind = Kind::ack;
    answer.result = accepted;
  }
  return encode(answer, sequence_++);
}

std::optional<Bytes> Autopilot::receive(const Bytes& frame) {
  const std::optional<Message> message = decode(frame);
  if (!message) return {};
  Message answer;
  switch (message->kind) {
    case Kind::count:
      incoming_.clear();
      expected_ = message->number;
      return ask_or_accept();
    case Kind::item_int:
      if (message->item.sequence != incoming_.size()) {
        answer.kind = Kind::ack;
        answer.result = invalid_sequence;
        return encode(answer, sequence_++);
      }
      incoming_.push_back(message->item);
      return ask_or_accept();
    case Kind::request_list:
      answer.kind = Kind::count;
      answer.number = static_cast<std::uint16_t>(mission_.size());
      return encode(answer, sequence_++);
    case Kind::request_int:
      answer.kind = Kind::item_int;
      answer.item = mission_.at(message->number);
      return encode(answer, sequence_++);
    case Kind::ack:
      return {};
  }
  return {};
}

bool upload(Autopilot& autopilot, const std::vector<WireItem>& items, int spoiled) {
  std::uint8_t sequence = 0;
  int sent = 0;
  const auto send = [&](const Message& message) {
    Bytes frame = encode(message, sequence++);
    if (sent++ == spoiled) {
      frame[frame.size() / 2] ^= 0x10;
      if (autopilot.receive(frame)) throw std::logic_error("a damaged frame was understood");
      frame[frame.size() / 2] ^= 0x10;
    }
    return decode(autopilot.receive(frame).value()).value();
  };
  Message message;
  message.kind = Kind::count;
  message.number = static_cast<std::uint16_t>(items.size());
  Message answer = send(message);
  while (answer.kind == Kind::request_int) {
    message.kind = Kind::item_int;
    message.item = items.at(answer.number);
    answer = send(message);
  }
  return answer.kind == Kind::ack && answer.result == accepted;
}

std::vector<WireItem> download(Autopilot& autopilot) {
  Message message;
  message.kind = Kind::request_list;
  const std::size_t count = decode(autopilot.receive(encode(message, 0)).value()).value().number;
  std::vector<WireItem> items;
  message.kind = Kind::request_int;
  for (std::size_t i = 0; i < count; ++i) {
    message.number = static_cast<std::uint16_t>(i);
    items.push_back(decode(autopilot.receive(encode(message, 1)).value()).value().item);
  }
  return items;
}

}  // namespace skycap::flight::mavlink
