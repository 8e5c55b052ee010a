/// MAVLink 2 framing: conversion between byte streams and message frames.
///
/// Source: MAVLink's serialization guide (frame, checksum, truncation of zeros). Input is
/// untrusted: a frame is accepted only if its checksum, which covers the message definition, is
/// correct. Signed frames are unsupported and skipped, as MAVLink requires for unknown features.
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

/// Returns the MAVLink checksum CRC-16/MCRF4XX of `data`, continued from `crc`.
std::uint16_t checksum(std::span<const std::uint8_t> data, std::uint16_t crc = 0xFFFF);

/// Sender address: system (vehicle or ground station) and component.
struct Address {
  std::uint8_t system = 0, component = 0;

  bool operator==(const Address&) const = default;
};

struct Frame {
  std::uint32_t id = 0;  ///< Message ID, below 2^24.
  Address sender;
  std::uint8_t sequence = 0;  ///< Sequence number, counted per sender.
  Bytes payload;              ///< At most 255 bytes. Trailing zeros may be missing.
};

/// Returns the serialised frame. `extra_byte` is the CRC extra byte of the message (message.h).
Bytes wire_form(const Frame& frame, std::uint8_t extra_byte);

/// Extracts frames from an arbitrary byte stream.
class FrameReader {
 public:
  /// Returns the CRC extra byte of a message, or std::nullopt for unknown messages, which are
  /// skipped.
  using CrcExtraLookup = std::function<std::optional<std::uint8_t>(std::uint32_t id)>;

  explicit FrameReader(CrcExtraLookup find_crc_extra)
      : find_crc_extra_(std::move(find_crc_extra)) {}

  void feed(std::span<const std::uint8_t> bytes);

  /// Returns the next complete frame of a known message, or std::nullopt until more bytes are fed.
  /// At most one incomplete frame (280 bytes) is buffered.
  std::optional<Frame> next();

 private:
  void skip(std::size_t count);

  CrcExtraLookup find_crc_extra_;
  Bytes bytes_;
  std::size_t begin_ = 0;  ///< Start of the unprocessed bytes.
};

}  // namespace skycap::flight::mavlink
