#include "missions/online/guided/network_port.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <system_error>
#include <thread>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "geometry/error.h"

namespace skycap::missions::online {
namespace {

using Kind = NetworkAddress::Kind;

constexpr std::size_t largest_read = 1 << 16;  // Upper limit of the size of a datagram.

[[noreturn]] void reject(const std::string& text, const std::string& what) {
  throw Error(ErrorKind::bad_usage, "--connect " + text + ": " + what);
}

sockaddr_in socket_address(const NetworkAddress& address) {
  sockaddr_in result{};
  result.sin_family = AF_INET;
  result.sin_port = htons(address.port);
  result.sin_addr.s_addr = htonl(address.host);
  return result;
}

bool succeeds(int (*act)(int, const sockaddr*, socklen_t), int handle, const sockaddr_in& address) {
  return act(handle, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

}  // namespace

NetworkAddress parse_address(const std::string& text) {
  const std::string form =
      "must be udp:HOST:PORT, udpout:HOST:PORT or tcp:HOST:PORT, with an IPv4 "
      "address such as 127.0.0.1 for HOST, or simulated";
  const std::size_t first = text.find(':'), last = text.rfind(':');
  if (first == std::string::npos || first == last) reject(text, form);
  NetworkAddress address;
  const std::string kind = text.substr(0, first);
  if (kind == "udpout") address.kind = Kind::udp_send;
  if (kind == "tcp") address.kind = Kind::tcp;
  if (kind != "udp" && kind != "udpout" && kind != "tcp") reject(text, form);
  in_addr host{};
  if (::inet_pton(AF_INET, text.substr(first + 1, last - first - 1).c_str(), &host) != 1) {
    reject(text, form);
  }
  address.host = ntohl(host.s_addr);
  const char* const end = text.data() + text.size();
  const auto [stop, failure] = std::from_chars(text.data() + last + 1, end, address.port);
  if (failure != std::errc() || stop != end || address.port == 0) {
    reject(text, "the port must be a number from 1 to 65535");
  }
  return address;
}

NetworkPort::NetworkPort(const NetworkAddress& address, double pace)
    : address_(address), pace_(pace) {
  const bool is_stream = address.kind == Kind::tcp;
  handle_ = ::socket(AF_INET, (is_stream ? SOCK_STREAM : SOCK_DGRAM) | SOCK_CLOEXEC, 0);
  const bool waits = address.kind == Kind::udp_wait;
  if (handle_ >= 0 && succeeds(waits ? ::bind : ::connect, handle_, socket_address(address))) {
    has_peer_ = !waits;
    return;
  }
  const std::string reason = std::generic_category().message(errno);
  if (handle_ >= 0) ::close(handle_);
  throw Error(ErrorKind::bad_usage, "--connect: cannot resolve the address: " + reason);
}

NetworkPort::~NetworkPort() { ::close(handle_); }

double NetworkPort::now() const {
  const auto time = std::chrono::steady_clock::now().time_since_epoch();
  return pace_ * std::chrono::duration<double>(time).count();
}

void NetworkPort::send(std::span<const std::uint8_t> bytes) {
  if (!has_peer_) return;
  // Data that the network does not accept is dropped like other losses on a link.
  while (!bytes.empty()) {
    const ssize_t count = ::send(handle_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count <= 0) return;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void NetworkPort::hear_only(const void* address, std::size_t size) {
  has_peer_ =
      ::connect(handle_, static_cast<const sockaddr*>(address), static_cast<socklen_t>(size)) == 0;
}

flight::mavlink::Bytes NetworkPort::receive(double patience) {
  constexpr double milliseconds = 1e3;
  const int wait = static_cast<int>(std::ceil(std::max(0.0, patience) * milliseconds / pace_));
  pollfd poll_request{handle_, POLLIN, 0};
  flight::mavlink::Bytes bytes;
  if (::poll(&poll_request, 1, wait) <= 0) return bytes;
  bytes.resize(largest_read);
  sockaddr_in sender{};
  socklen_t size = sizeof sender;
  const ssize_t count = ::recvfrom(handle_, bytes.data(), bytes.size(), MSG_DONTWAIT,
                                   reinterpret_cast<sockaddr*>(&sender), &size);
  bytes.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  if (bytes.empty()) {  // Closed connection or empty datagram.
    std::this_thread::sleep_for(std::chrono::milliseconds(std::min(wait, 10)));
  } else if (!has_peer_) {
    hear_only(&sender, size);
  }
  return bytes;
}

}  // namespace skycap::missions::online
