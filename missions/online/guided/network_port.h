/// MAVLink port over UDP or TCP in real time.
#pragma once

#include <cstdint>
#include <string>

#include "flight/mavlink/port.h"

namespace skycap::missions::online {

/// Network address of an autopilot.
struct NetworkAddress {
  enum class Kind {
    udp_wait,  ///< udp: receives datagrams at an address of this machine.
    udp_send,  ///< udpout: sends datagrams to the autopilot's address.
    tcp,       ///< tcp: connects to the autopilot's address.
  };
  Kind kind = Kind::udp_wait;
  std::uint32_t host = 0;  ///< IPv4 address in host byte order.
  std::uint16_t port = 0;

  bool is_loopback() const { return (host >> 24) == 127; }
};

/// Parses udp:HOST:PORT, udpout:HOST:PORT or tcp:HOST:PORT, where HOST is an IPv4 address. Throws
/// Error{bad_usage} for other input.
NetworkAddress parse_address(const std::string& text);

/// Port that accepts datagrams only from the first sender, because MAVLink does not authenticate
/// senders.
class NetworkPort : public flight::mavlink::Port {
 public:
  /// Opens the socket. now() advances `pace` seconds per second of real time, for tests with an
  /// accelerated autopilot. Throws Error{bad_usage} if the address is not available.
  explicit NetworkPort(const NetworkAddress& address, double pace = 1.0);
  NetworkPort(const NetworkPort&) = delete;
  NetworkPort& operator=(const NetworkPort&) = delete;
  ~NetworkPort() override;

  void send(std::span<const std::uint8_t> bytes) override;
  flight::mavlink::Bytes receive(double patience) override;
  double now() const override;

 private:
  void hear_only(const void* address, std::size_t size);

  NetworkAddress address_;
  double pace_;
  int handle_ = -1;
  bool has_peer_ = false;
};

}  // namespace skycap::missions::online
