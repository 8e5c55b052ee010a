/// How a message becomes bytes and back: from one list of its fields, which is its definition.
///
/// A message is a struct with an `id`, a `name` and
///
///     template <class Self, class Visit> static void fields(Self& self, Visit&& visit);
///
/// which visits its fields in the order of the wire, largest types first, by the names that MAVLink
/// gives them. Extensions are left out: they do not count for the extra byte, and zeros stand for
/// them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "flight/link/frame.h"

namespace skycap::flight::mavlink {

static_assert(std::endian::native == std::endian::little, "numbers are copied as MAVLink has them");

/// What MAVLink's definitions call a type.
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

/// The definition's text, from which the extra byte is computed.
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

/// Reads fields from a payload; what is missing at its end is zero.
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

/// The byte that goes into a frame's checksum besides its bytes, so that ends with different
/// definitions do not understand each other.
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

/// The message in a frame; nothing if it is another one.
template <class M>
std::optional<M> decode(const Frame& frame) {
  if (frame.id != M::id) return std::nullopt;
  M message;
  PayloadReader reader(frame.payload);
  M::fields(message, reader);
  return message;
}

/// For a FrameReader of these messages.
template <class... M>
std::optional<std::uint8_t> extra_byte_of(std::uint32_t id) {
  std::optional<std::uint8_t> byte;
  ((id == M::id ? void(byte = extra_byte<M>()) : void()), ...);
  return byte;
}

}  // namespace skycap::flight::mavlink
