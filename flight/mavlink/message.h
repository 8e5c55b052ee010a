/// Serialisation of messages from a single definition: the list of their fields.
///
/// A message is a struct with an `id`, a `name` and
///
///     template <class Self, class Visit> static void fields(Self& self, Visit&& visit);
///
/// which visits its fields with their MAVLink names in wire order, largest types first. Extension
/// fields are omitted: they do not count for the CRC extra byte, and missing bytes mean zero.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>

#include "flight/mavlink/frame.h"

namespace skycap::flight::mavlink {

static_assert(std::endian::native == std::endian::little, "numbers are copied as MAVLink has them");

/// Returns the type name of MAVLink's definitions.
template <class T>
constexpr const char* type_name() {
  if constexpr (std::is_same_v<T, char>) return "char";
  if constexpr (std::is_same_v<T, float>) return "float";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "uint8_t";
  if constexpr (std::is_same_v<T, std::int8_t>) return "int8_t";
  if constexpr (std::is_same_v<T, std::uint16_t>) return "uint16_t";
  if constexpr (std::is_same_v<T, std::int16_t>) return "int16_t";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "uint32_t";
  if constexpr (std::is_same_v<T, std::int32_t>) return "int32_t";
}

/// Visits the elements of an array as individual fields.
template <class Visit, std::size_t N, class Array>
void visit_each(Visit& visit, const char* const (&names)[N], Array& values) {
  static_assert(N == std::tuple_size_v<std::remove_const_t<Array>>);
  for (std::size_t i = 0; i < N; ++i) visit(names[i], values[i]);
}

/// Visits the two fields of a message's target address.
template <class Visit, class Target>
void visit_target(Visit& visit, Target& target) {
  visit("target_system", target.system);
  visit("target_component", target.component);
}

/// Text of a message definition, from which the CRC extra byte is computed.
class DefinitionText {
 public:
  explicit DefinitionText(const char* name) { add(name); }

  template <class T>
  void operator()(const char* name, const T&) {
    add(type_name<T>()), add(name);
  }
  template <class T, std::size_t N>
  void operator()(const char* name, const std::array<T, N>&) {
    add(type_name<T>()), add(name);
    text_.push_back(static_cast<char>(N));
  }

  const std::string& text() const { return text_; }

 private:
  void add(const char* word) { text_ += std::string(word) + " "; }

  std::string text_;
};

/// Appends fields to a payload.
class PayloadWriter {
 public:
  template <class T>
  void operator()(const char*, const T& value) {
    const std::size_t end = bytes_.size();
    bytes_.resize(end + sizeof(T));
    std::memcpy(bytes_.data() + end, &value, sizeof(T));
  }

  Bytes& bytes() { return bytes_; }

 private:
  Bytes bytes_;
};

/// Reads fields from a payload. Missing trailing bytes are zero.
class PayloadReader {
 public:
  explicit PayloadReader(std::span<const std::uint8_t> rest) : rest_(rest) {}

  template <class T>
  void operator()(const char*, T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::array<std::uint8_t, sizeof(T)> raw{};
    const std::size_t count = std::min(sizeof(T), rest_.size());
    std::copy_n(rest_.begin(), count, raw.begin());
    rest_ = rest_.subspan(count);
    std::memcpy(&value, raw.data(), sizeof(T));
  }

 private:
  std::span<const std::uint8_t> rest_;
};

/// Returns the CRC extra byte. It extends a frame's checksum so that peers with different
/// definitions reject each other's messages.
template <class M>
std::uint8_t extra_byte() {
  static const std::uint8_t byte = [] {
    DefinitionText definition(M::name);
    const M message{};
    M::fields(message, definition);
    const std::string& text = definition.text();
    const std::uint16_t crc =
        checksum({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    return static_cast<std::uint8_t>((crc & 0xFF) ^ (crc >> 8));
  }();
  return byte;
}

template <class M>
Bytes encode(const M& message, Address sender, std::uint8_t sequence) {
  PayloadWriter writer;
  M::fields(message, writer);
  return wire_form({M::id, sender, sequence, std::move(writer.bytes())}, extra_byte<M>());
}

/// Returns the message of a frame, or std::nullopt if the frame has a different ID.
template <class M>
std::optional<M> decode(const Frame& frame) {
  if (frame.id != M::id) return std::nullopt;
  M message;
  PayloadReader reader(frame.payload);
  M::fields(message, reader);
  return message;
}

/// Returns the CRC extra byte of one of the messages `M`, for FrameReader.
template <class... M>
std::optional<std::uint8_t> find_crc_extra(std::uint32_t id) {
  std::optional<std::uint8_t> byte;
  ((id == M::id ? void(byte = extra_byte<M>()) : void()), ...);
  return byte;
}

}  // namespace skycap::flight::mavlink
