#include "tests/clients/ros2/spoiled_wire.h"

#include <array>
#include <cstring>
#include <mutex>
#include <optional>
#include <random>
#include <string>

#include <dlfcn.h>
#include <sys/socket.h>

namespace skycap::ros2 {
namespace {

std::mutex guard;
std::optional<std::mt19937> random_bits;  // empty: packets are sent unchanged
std::size_t corrupted = 0;

std::uint32_t below(std::size_t limit) {
  return static_cast<std::uint32_t>((*random_bits)() % std::max<std::size_t>(limit, 1));
}

template <typename Number>
Number number_at(const std::string& packet, std::size_t at) {
  Number number{};
  if (at + sizeof number <= packet.size()) std::memcpy(&number, &packet[at], sizeof number);
  return number;
}

/// Replaces random bytes, inserts extreme numbers where a length may be, or shortens the data and
/// appends a random number.
void corrupt(std::string& packet, std::size_t begin, std::size_t end) {
  constexpr std::array<std::uint32_t, 6> extremes{0, 1, 0x7fffffff, 0x80000000, 0xfffffffe, ~0U};
  if (end < begin + 8 || end > packet.size()) return;
  ++corrupted;
  const std::size_t count = 1 + below(4);
  for (std::size_t i = 0; i < count; ++i) {
    // The first four bytes are the encapsulation header, which decides how the rest is read.
    const std::size_t from = below(10) == 0 ? begin : begin + 4;
    const std::uint32_t extreme = below(2) == 0 ? extremes[below(extremes.size())] : below(4096);
    const std::size_t word = from + 4 * below((end - from) / 4);
    if (below(2) == 0 && word + 4 <= end) {
      std::memcpy(&packet[word], &extreme, sizeof extreme);
    } else {
      packet[from + below(end - from)] = static_cast<char>(below(256));
    }
  }
}

/// Corrupts the serialised data in an RTPS 2.x packet: DATA and DATA_FRAG submessages of user
/// writers, not of discovery writers. The last submessage may be incomplete.
void corrupt_data(std::string& packet) {
  constexpr std::size_t packet_header = 20, header = 4;
  constexpr unsigned char data = 0x15, data_frag = 0x16;
  if (packet.size() < packet_header || packet.compare(0, 4, "RTPS") != 0) return;
  for (std::size_t at = packet_header; at + header <= packet.size();) {
    const auto kind = static_cast<unsigned char>(packet[at]);
    const std::size_t size = number_at<std::uint16_t>(packet, at + 2);
    const std::size_t end = size == 0 ? packet.size() : at + header + size;
    const bool has_inline_qos = (packet[at + 1] & 2) != 0;
    const auto writer_kind = static_cast<unsigned char>(number_at<char>(packet, at + 15));
    const bool is_users = (writer_kind & 0xc0U) == 0;
    if ((kind == data || kind == data_frag) && is_users && !has_inline_qos) {
      const std::size_t payload = at + 8 + number_at<std::uint16_t>(packet, at + 6);
      corrupt(packet, payload, end);
      if (kind == data && end == packet.size() && payload + 8 < end && below(5) == 0) {
        packet.resize(payload + 4 + 4 * below((end - payload) / 4));
        const auto left = static_cast<std::uint16_t>(packet.size() - at - header);
        std::memcpy(&packet[at + 2], &left, sizeof left);
        return;
      }
    }
    at = end;
  }
}

}  // namespace

CorruptedWire::CorruptedWire(std::uint32_t seed) {
  const std::lock_guard lock(guard);
  random_bits.emplace(seed);
}

CorruptedWire::~CorruptedWire() {
  const std::lock_guard lock(guard);
  random_bits.reset();
}

std::size_t CorruptedWire::count() {
  const std::lock_guard lock(guard);
  return corrupted;
}

}  // namespace skycap::ros2

/// Overrides sendmsg() of the C library, which DDS calls.
extern "C" ssize_t sendmsg(int socket, const msghdr* message, int flags) {
  using skycap::ros2::guard, skycap::ros2::random_bits;
  using Send = ssize_t (*)(int, const msghdr*, int);
  static const Send send = reinterpret_cast<Send>(::dlsym(RTLD_NEXT, "sendmsg"));
  std::string packet;
  {
    const std::lock_guard lock(guard);
    if (!random_bits) return send(socket, message, flags);
    for (std::size_t i = 0; i < message->msg_iovlen; ++i) {
      const iovec& chunk = message->msg_iov[i];
      packet.append(static_cast<const char*>(chunk.iov_base), chunk.iov_len);
    }
    skycap::ros2::corrupt_data(packet);
  }
  std::size_t asked = 0;
  for (std::size_t i = 0; i < message->msg_iovlen; ++i) asked += message->msg_iov[i].iov_len;
  iovec whole{packet.data(), packet.size()};
  msghdr other = *message;
  other.msg_iov = &whole;
  other.msg_iovlen = 1;
  const ssize_t sent = send(socket, &other, flags);
  return sent < 0 ? sent : static_cast<ssize_t>(asked);
}
