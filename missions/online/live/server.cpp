#include "missions/online/live/server.h"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "geometry/error.h"

namespace skycap::missions::online {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto patience = std::chrono::seconds(30);
constexpr int poll_period = 100;  // Maximum delay in the detection of a stop request [ms].

[[noreturn]] void fail(const std::string& endpoint, const std::string& what) {
  throw Error(ErrorKind::bad_usage, endpoint + ": " + what);
}

std::string last_error() { return std::generic_category().message(errno); }

class Handle {
 public:
  explicit Handle(int handle = -1) : handle_(handle) {}
  Handle(Handle&& other) noexcept : handle_(std::exchange(other.handle_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Handle() {
    if (handle_ >= 0) ::close(handle_);
  }
  int get() const { return handle_; }
  bool is_open() const { return handle_ >= 0; }
  int release() { return std::exchange(handle_, -1); }

 private:
  int handle_;
};

/// Returns true if data is available within `milliseconds`.
bool is_readable(int handle, int milliseconds) {
  pollfd poll_request{handle, POLLIN, 0};
  return ::poll(&poll_request, 1, milliseconds) > 0;
}

/// Returns false if the client does not accept the message within the time limit.
bool send_all(int handle, const Message& message) {
  const std::string frame = encode_frame(message);
  std::string_view rest = frame;
  const Clock::time_point begun = Clock::now();
  while (!rest.empty() && Clock::now() - begun < patience) {
    const ssize_t count = ::send(handle, rest.data(), rest.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    if (count > 0) rest.remove_prefix(static_cast<std::size_t>(count));
    if (count < 0 && errno != EAGAIN && errno != EINTR) return false;
    if (count < 0) {
      pollfd poll_request{handle, POLLOUT, 0};
      ::poll(&poll_request, 1, poll_period);
    }
  }
  return rest.empty();
}

/// Sends a final message and waits briefly for the client to read it. Unread data of the client
/// would otherwise reset the connection before the message is delivered.
void dismiss(int handle, const Message& message) {
  send_all(handle, message);
  ::shutdown(handle, SHUT_WR);
  std::array<char, 4096> unread{};
  constexpr int max_reads = 16, moment = 50;  // [ms]
  for (int i = 0; i < max_reads && is_readable(handle, moment); ++i) {
    if (::recv(handle, unread.data(), unread.size(), MSG_DONTWAIT) <= 0) return;
  }
}

/// Connected client.
class Client {
 public:
  explicit Client(Handle handle) : handle_(std::move(handle)) {}

  /// Reads and answers messages. Returns false with a reason when the client is disconnected.
  bool serve(Session& session, std::string& reason) {
    try {
      if (!pending_) return receive(reason) && answer(session, reason);
      return release(session, reason) && (pending_ || answer(session, reason));
    } catch (const Error& failure) {  // Invalid message.
      reason = failure.what();
      dismiss(handle_.get(), error_message(reason));
      return false;
    }
  }

 private:
  bool receive(std::string& reason) {
    if (!is_readable(handle_.get(), poll_period)) {
      const bool is_late = reader_.is_within_message() && Clock::now() - heard_ > patience;
      if (!is_late) return true;
      reason = "timeout: message incomplete after 30 s";
      dismiss(handle_.get(), error_message(reason));
      return false;
    }
    const ssize_t count = ::recv(handle_.get(), chunk_.data(), chunk_.size(), MSG_DONTWAIT);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return true;
    if (count <= 0) {
      reason =
          reader_.is_within_message() ? "disconnected during a message; message discarded" : "left";
      return false;
    }
    heard_ = Clock::now();
    reader_.feed({chunk_.data(), static_cast<std::size_t>(count)});
    return true;
  }

  bool answer(Session& session, std::string& reason) {
    while (const std::optional<Message> message = reader_.next()) {
      pending_ = session.answer(*message);
      if (!release(session, reason)) return false;
      if (pending_) return true;
    }
    return true;
  }

  /// Sends the pending answer, unless the survey is held.
  bool release(Session& session, std::string& reason) {
    if (session.is_held_back(*pending_)) {
      session.settle();
      pollfd poll_request{handle_.get(), POLLRDHUP, 0};
      if (::poll(&poll_request, 1, poll_period) <= 0) return true;
      reason = "left while the survey was held";
      return false;
    }
    const bool is_sent = send_all(handle_.get(), *pending_);
    pending_.reset();
    if (!is_sent) {
      reason = "did not receive its answer";
      return false;
    }
    session.settle();
    if (session.is_finished()) reason = "finished the survey";
    return !session.is_finished();
  }

  Handle handle_;
  FrameReader reader_;
  std::optional<Message> pending_;  ///< Answer that has not been sent yet.
  std::vector<char> chunk_ = std::vector<char>(1 << 20);
  Clock::time_point heard_ = Clock::now();
};

template <typename Address>
bool is_bound(int handle, const Address& address) {
  return ::bind(handle, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0 &&
         ::listen(handle, 4) == 0;
}

Handle unix_listener(const std::filesystem::path& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::string name = path.string();
  if (name.size() >= sizeof address.sun_path) {
    fail(name, "is too long for a socket path; use at most 107 bytes");
  }
  std::memcpy(address.sun_path, name.data(), name.size());
  Handle probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  if (::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    fail(name, "is in use by another program; use another socket");
  }
  if (errno != ECONNREFUSED && errno != ENOENT) fail(name, "cannot be accessed: " + last_error());
  struct stat status {};
  if (::lstat(name.c_str(), &status) == 0) {
    if (!S_ISSOCK(status.st_mode)) fail(name, "exists and is not a socket; use another path");
    ::unlink(name.c_str());  // Left by a killed server.
  }
  Handle listener(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const mode_t mask = ::umask(0177);  // Only the owner may open the socket.
  const bool is_made = is_bound(listener.get(), address);
  const std::string reason = is_made ? "" : last_error();
  ::umask(mask);
  if (!is_made) fail(name, "cannot be created: " + reason);
  return listener;
}

Handle tcp_listener(std::uint16_t& port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  Handle listener(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  constexpr int yes = 1;
  ::setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (!is_bound(listener.get(), address)) {
    fail("port " + std::to_string(port), "cannot be opened: " + last_error());
  }
  socklen_t size = sizeof address;
  ::getsockname(listener.get(), reinterpret_cast<sockaddr*>(&address), &size);
  port = ntohs(address.sin_port);
  return listener;
}

}  // namespace

Server::Server(ServerEndpoint endpoint) : endpoint_(std::move(endpoint)) {
  if (endpoint_.port) {
    listener_ = tcp_listener(*endpoint_.port).release();
    address_ = "tcp:127.0.0.1:" + std::to_string(*endpoint_.port);
  } else {
    listener_ = unix_listener(endpoint_.socket).release();
    address_ = "unix:" + endpoint_.socket.string();
  }
}

Server::~Server() {
  ::close(listener_);
  if (!endpoint_.port) ::unlink(endpoint_.socket.c_str());
}

void Server::run(Session& session, const std::function<void(const std::string&)>& note,
                 const std::stop_token& stop) {
  std::optional<Client> client;
  while (!stop.stop_requested() && !session.is_finished()) {
    if (is_readable(listener_, client ? 0 : poll_period)) {
      Handle visitor(::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC));
      if (visitor.is_open() && client) {
        dismiss(visitor.get(), error_message("server busy: another client is connected"));
        note("a second client was rejected");
      } else if (visitor.is_open()) {
        client.emplace(std::move(visitor));
        note("client connected");
      }
    }
    std::string reason;
    if (!client || client->serve(session, reason)) continue;
    note("the client " + reason);
    client.reset();
  }
}

}  // namespace skycap::missions::online
