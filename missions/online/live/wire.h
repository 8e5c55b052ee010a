/// Messages of live surveys on a socket: docs/reference/live-protocol.md describes them. A frame is
///
///     u32 bytes of the header    u32 bytes of the payload    u32 CRC-32 of both
///     header: a JSON object      payload: numbers
///
/// in little-endian byte order. Whatever arrives is either a whole, sound frame or an error.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace skycap::missions::online {

inline constexpr std::size_t largest_header = std::size_t{64} << 10;
inline constexpr std::size_t largest_payload = std::size_t{256} << 20;

struct Message {
  nlohmann::ordered_json header = nlohmann::ordered_json::object();
  std::string payload;
};

std::string frame_of(const Message& message);

/// {"type": "error", "what": what}
Message error_message(const std::string& what);

/// Puts frames together from the pieces that a socket gives.
class FrameReader {
 public:
  void feed(std::string_view bytes) { buffer_.append(bytes); }

  /// The next message; nothing before it is whole. Throws Error{bad_file} for lengths beyond the
  /// limits, a wrong checksum, or a header that is no JSON object: nothing that follows can be
  /// trusted then.
  std::optional<Message> next();

  bool is_within_message() const { return !buffer_.empty(); }

 private:
  std::string buffer_;
};

}  // namespace skycap::missions::online
