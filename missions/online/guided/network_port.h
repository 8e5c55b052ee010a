/// A link over the network: datagrams or a connection, by the clock on the wall.
#pragma once

#include <cstdint>
#include <string>

#include "flight/link/port.h"

namespace skycap::missions::online {

/// Where an autopilot is met.
struct NetworkAddress {
  enum class Kind {
    udp_wait,  ///< udp: its datagrams come to an address of this machine
    udp_send,  ///< udpout: it waits for datagrams at its own address
    tcp,       ///< tcp: it waits for a connection at its own address
  };
  Kind kind = Kind::udp_wait;
  std::uint32_t host = 0;  ///< IPv4, of this machine's byte order
  std::uint16_t port = 0;

  bool is_of_this_machine() const { return (host >> 24) == 127; }
};

/// Reads udp:HOST:PORT, udpout:HOST:PORT or tcp:HOST:PORT, HOST being an IPv4 address. Throws
/// Error{bad_usage}.
NetworkAddress parse_address(const std::string& text);

/// Of those who send datagrams to us only the first is heard: MAVLink does not say who speaks.
class NetworkPort : public flight::mavlink::Port {
 public:
  /// `pace` seconds of now() pass in one on the wall: for tests with an autopilot that is as fast.
  /// Throws Error{bad_usage} if the address cannot be had.
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
