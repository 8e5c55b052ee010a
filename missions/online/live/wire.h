/// Messages of live surveys on a socket (docs/reference/live-protocol.md). A frame consists of
///
///     u32 bytes of the header    u32 bytes of the payload    u32 CRC-32 of both
///     header: a JSON object      payload: numbers
///
/// in little-endian byte order. Received data is either a complete, valid frame or an error.
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

std::string encode_frame(const Message& message);

/// Returns the message {"type": "error", "what": what}.
Message error_message(const std::string& what);

/// Assembles frames from the chunks of bytes received on a socket.
class FrameReader {
 public:
  void feed(std::string_view bytes) { buffer_.append(bytes); }

  /// Returns the next message, or an empty value until it is complete. Throws Error{bad_file} for
  /// lengths above the limits, a wrong checksum, or a header that is not a JSON object. The data
  /// after such an error is unusable.
  std::optional<Message> next();

  bool is_within_message() const { return !buffer_.empty(); }

 private:
  std::string buffer_;
};

}  // namespace skycap::missions::online
