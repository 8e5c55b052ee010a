#include "missions/online/live/wire.h"

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "geometry/error.h"
#include "geometry/io/json.h"
#include "geometry/io/record_log.h"
#include "missions/support/journal_text.h"

namespace skycap::missions::online {
namespace {

static_assert(std::endian::native == std::endian::little, "frames are made by copying numbers");

using Lengths = std::array<std::uint32_t, 3>;  // Header, payload, checksum.

void require(bool is_right, const std::string& what) {
  if (!is_right) throw Error(ErrorKind::bad_file, "the message " + what);
}

}  // namespace

Message error_message(const std::string& what) { return {{{"type", "error"}, {"what", what}}, {}}; }

std::string encode_frame(const Message& message) {
  const std::string body = support::journal_line(message.header) + message.payload;
  const Lengths lengths{static_cast<std::uint32_t>(body.size() - message.payload.size()),
                        static_cast<std::uint32_t>(message.payload.size()),
                        geometry::compute_crc32(body)};
  std::string frame(sizeof lengths, '\0');
  std::memcpy(frame.data(), lengths.data(), sizeof lengths);
  return frame + body;
}

std::optional<Message> FrameReader::next() {
  Lengths lengths{};
  if (buffer_.size() < sizeof lengths) return std::nullopt;
  std::memcpy(lengths.data(), buffer_.data(), sizeof lengths);
  const auto [header_size, payload_size, checksum] = lengths;
  require(header_size <= largest_header && payload_size <= largest_payload,
          "is too large (maximum: 64 KiB of header, 256 MiB of payload)");
  const std::size_t size = std::size_t{header_size} + payload_size;
  if (buffer_.size() - sizeof lengths < size) return std::nullopt;
  const std::string_view body = std::string_view(buffer_).substr(sizeof lengths, size);
  require(geometry::compute_crc32(body) == checksum, "is damaged (checksum)");
  Message message{geometry::parse_json<nlohmann::ordered_json>(body.substr(0, header_size)),
                  std::string(body.substr(header_size))};
  require(message.header.is_object(), "header is not a JSON object");
  buffer_.erase(0, sizeof lengths + size);
  return message;
}

}  // namespace skycap::missions::online
