/// Socket server for a live survey, with one client at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "missions/online/live/session.h"

namespace skycap::missions::online {

/// Address of the server: a Unix socket that only its owner can open, or a local TCP port.
struct ServerEndpoint {
  std::filesystem::path socket;       ///< Path of the Unix socket; empty if `port` is set.
  std::optional<std::uint16_t> port;  ///< TCP port at 127.0.0.1; 0 selects a free port.
};

/// Listening socket. The destructor removes the socket file.
class Server {
 public:
  /// Throws Error{bad_usage} if the address is in use or not available.
  explicit Server(ServerEndpoint endpoint);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server();

  /// Returns the address for clients: "unix:PATH" or "tcp:127.0.0.1:PORT".
  const std::string& address() const { return address_; }

  /// Serves one client after another until the survey is finished or a stop is requested. A second
  /// simultaneous client receives an error message and is disconnected. The same applies to clients
  /// that send invalid messages or an incomplete message for 30 s. `note` receives one-line log
  /// messages. Client errors do not cause exceptions.
  void run(Session& session, const std::function<void(const std::string&)>& note,
           const std::stop_token& stop);

 private:
  ServerEndpoint endpoint_;
  std::string address_;
  int listener_ = -1;
};

}  // namespace skycap::missions::online
