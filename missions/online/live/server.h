/// Serves a live survey on a socket, to one client at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "missions/online/live/session.h"

namespace skycap::missions::online {

/// Where clients come in: a Unix socket that only its owner may open, or a port of this machine.
struct ServerPlace {
  std::filesystem::path socket;       ///< either this
  std::optional<std::uint16_t> port;  ///< or this, of 127.0.0.1 alone; 0: any that is free
};

/// A socket that waits for clients. Removes its file when it goes out of scope.
class Server {
 public:
  /// Throws Error{bad_usage} if the place is taken or cannot be had.
  explicit Server(ServerPlace place);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  ~Server();

  /// What a client has to be told: "unix:PATH" or "tcp:127.0.0.1:PORT".
  const std::string& address() const { return address_; }

  /// Answers clients, one after the other, until the survey is finished or a stop is requested. A
  /// second client at the same time is told so and sent away; one that sends what is no message, or
  /// no more than a part of one for half a minute, is told so and let go. `note` is told what
  /// happened, in a line. Throws nothing that a client does.
  void run(Session& session, const std::function<void(const std::string&)>& note,
           const std::stop_token& stop);

 private:
  ServerPlace place_;
  std::string address_;
  int listener_ = -1;
};

}  // namespace skycap::missions::online
