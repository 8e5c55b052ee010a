#include "flight/mavlink/frame.h"

#include <algorithm>

namespace skycap::flight::mavlink {
namespace {

constexpr std::uint8_t mavlink_stx = 0xFD;
constexpr std::size_t header_size = 10, checksum_size = 2;

std::uint16_t frame_checksum(std::span<const std::uint8_t> frame, std::uint8_t extra_byte) {
  // All bytes except the start byte and the checksum.
  const auto covered = frame.subspan(1, frame.size() - 1 - checksum_size);
  return checksum({&extra_byte, 1}, checksum(covered));
}

}  // namespace

std::uint16_t checksum(std::span<const std::uint8_t> data, std::uint16_t crc) {
  for (const std::uint8_t byte : data) {
    crc = static_cast<std::uint16_t>(crc ^ byte);
    for (int bit = 0; bit < 8; ++bit) {
      crc = static_cast<std::uint16_t>((crc & 1) != 0 ? (crc >> 1) ^ 0x8408 : crc >> 1);
    }
  }
  return crc;
}

Bytes wire_form(const Frame& frame, std::uint8_t extra_byte) {
  std::size_t size = frame.payload.size();
  while (size > 1 && frame.payload[size - 1] == 0) --size;
  Bytes bytes{mavlink_stx,         static_cast<std::uint8_t>(size), 0, 0, frame.sequence,
              frame.sender.system, frame.sender.component};
  bytes.reserve(header_size + size + checksum_size);
  for (const int shift : {0, 8, 16}) bytes.push_back(static_cast<std::uint8_t>(frame.id >> shift));
  bytes.insert(bytes.end(), frame.payload.begin(),
               frame.payload.begin() + static_cast<std::ptrdiff_t>(size));
  bytes.resize(bytes.size() + checksum_size);
  const std::uint16_t crc = frame_checksum(bytes, extra_byte);
  bytes[bytes.size() - 2] = static_cast<std::uint8_t>(crc & 0xFF);
  bytes[bytes.size() - 1] = static_cast<std::uint8_t>(crc >> 8);
  return bytes;
}

void FrameReader::feed(std::span<const std::uint8_t> bytes) {
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin_));
  begin_ = 0;
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

void FrameReader::skip(std::size_t count) { begin_ += count; }

std::optional<Frame> FrameReader::next() {
  while (true) {
    const auto start =
        std::find(bytes_.begin() + static_cast<std::ptrdiff_t>(begin_), bytes_.end(), mavlink_stx);
    begin_ = static_cast<std::size_t>(start - bytes_.begin());
    const std::span<const std::uint8_t> rest = std::span(bytes_).subspan(begin_);
    if (rest.size() < header_size) return std::nullopt;
    if (rest[2] != 0) {  // Incompatible feature flag.
      skip(1);
      continue;
    }
    const std::size_t size = header_size + rest[1] + checksum_size;
    if (rest.size() < size) return std::nullopt;
    const std::uint32_t id = rest[7] + 256U * rest[8] + 65536U * rest[9];
    const std::optional<std::uint8_t> extra_byte = find_crc_extra_(id);
    if (!extra_byte) {  // The frame cannot be validated.
      skip(size);
      continue;
    }
    const auto bytes = rest.first(size);
    const std::uint16_t crc = frame_checksum(bytes, *extra_byte);
    if (bytes[size - 2] != (crc & 0xFF) || bytes[size - 1] != crc >> 8) {
      skip(1);
      continue;
    }
    skip(size);
    const auto payload = bytes.subspan(header_size, rest[1]);
    return Frame{id, {bytes[5], bytes[6]}, bytes[4], Bytes(payload.begin(), payload.end())};
  }
}

}  // namespace skycap::flight::mavlink
